// Files on their way to the studio: dropped anywhere on the page, or chosen.

import { element } from "./elements.js";
import { pageNotice } from "./notices.js";
import { bytes } from "./numbers.js";
import { project } from "./project.js";
import { upload } from "./server.js";

const lines = document.getElementById("uploads");

/** Sends files one after the other; gives the numbers of those that arrived. */
export async function sendFiles(files, use = null) {
  pageNotice.clear();
  const problems = [];
  const ids = [];
  for (const file of files) {
    if (file.size > project.choices.file_bytes_limit) {
      problems.push(`${file.name} has ${bytes(file.size)}; the studio takes at most ${bytes(project.choices.file_bytes_limit)}. Make it smaller on the command line, such as with hysid look FILE -o SMALLER.csv and every tenth row, or fit there.`);
      continue;
    }
    const bar = element("div");
    const progress = element("div", { class: "progress", role: "progressbar", "aria-label": `Upload of ${file.name}`, "aria-valuemin": "0", "aria-valuemax": "100" }, bar);
    const line = element("div", {}, `${file.name}, ${bytes(file.size)}`, progress);
    lines.append(line);
    try {
      const { id } = await upload(file, use, (share) => {
        bar.style.width = `${100 * share}%`;
        progress.setAttribute("aria-valuenow", String(Math.round(100 * share)));
      });
      ids.push(id);
    } catch (error) {
      problems.push(error);
    }
    line.remove();
  }
  pageNotice.all(problems);
  return ids;
}

/** Calls `dropped` with files that are dropped anywhere. */
export function listenToDrops(dropped) {
  const holdsFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  addEventListener("dragover", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
  addEventListener("drop", (event) => {
    document.body.classList.remove("dropping");
    if (!holdsFiles(event)) return;
    event.preventDefault();
    dropped([...event.dataTransfer.files]);
  });
}
