// Shows the report of the model in the address, `#3`, in a frame that reaches nothing of this page.

import { getText } from "./server.js";

const frame = document.getElementById("report");

async function show() {
  try {
    const text = await getText(`/api/models/${Number(location.hash.slice(1))}/report`);
    document.title = new DOMParser().parseFromString(text, "text/html").title;
    frame.srcdoc = text;
  } catch (error) {
    const words = document.getElementById("problem");
    words.textContent = error.message;
    words.hidden = false;
    frame.hidden = true;
  }
}
addEventListener("hashchange", () => location.reload());
show();
