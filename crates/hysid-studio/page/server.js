// Talks with the studio's server: JSON, binary arrays, uploads and live events.

/** An error in the server's words. */
class ServerError extends Error {}
/** The server cannot be reached. */
export class Gone extends Error {}

/** Tells the page that the server is gone or back. */
export const connection = new EventTarget();
let isThere = true;
let isOfEarlierStart = false;
export const isStranger = () => isOfEarlierStart;
/** The cookie of this page is that of an earlier studio: no request will be answered. */
function estranged(words) {
  isOfEarlierStart = true;
  connection.dispatchEvent(new CustomEvent("stranger", { detail: words }));
}
function say(there) {
  if (there === isThere || isOfEarlierStart) return;
  isThere = there;
  connection.dispatchEvent(new CustomEvent(there ? "back" : "gone"));
}

async function request(address, options) {
  let response;
  try {
    response = await fetch(address, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    say(false);
    throw new Gone("The studio is not running.");
  }
  if (response.status !== 403) say(true);
  if (response.ok) return response;
  const words = await response.json().then((answer) => answer.error, () => `The server answered with status ${response.status}.`);
  if (response.status === 403) estranged(words);
  throw new ServerError(words);
}

export const getJson = async (address) => (await request(address)).json();
export const remove = (address) => request(address, { method: "DELETE" });
export async function post(address, value) {
  const response = await request(address, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(value) });
  const text = await response.text();
  return text ? JSON.parse(text) : null;
}

/**
 * Arrays of equal length, one after the other: all numbers, and a function that cuts them into so many arrays.
 * @returns {Promise<{numbers: Float64Array, cut: (count: number) => Float64Array[], headers: Headers}>}
 */
async function binary(address, options) {
  const response = await request(address, options);
  const numbers = new Float64Array(await response.arrayBuffer());
  const cut = (count) => Array.from({ length: count }, (_, k) => numbers.subarray(k * numbers.length / count, (k + 1) * numbers.length / count));
  return { numbers, cut, headers: response.headers };
}
export const getBinary = (address) => binary(address);

/** A file that the server makes, with its name. */
export async function getFile(address) {
  const response = await request(address);
  const [, name] = /filename\*=UTF-8''(.+)$/.exec(response.headers.get("content-disposition") ?? "") ?? [];
  return { name: name ? decodeURIComponent(name) : "file", content: await response.blob() };
}

/** Sends arrays one after the other, and gets arrays back. */
export function runBinary(address, arrays, signal) {
  const rows = arrays[0].length;
  const body = new Float64Array(rows * arrays.length);
  arrays.forEach((array, k) => body.set(array, k * rows));
  return binary(address, { method: "POST", headers: { "content-type": "application/octet-stream" }, body, signal });
}

/** Sends a file; `progress` gets the share that has arrived. */
export function upload(file, progress) {
  return new Promise((done, failed) => {
    const call = new XMLHttpRequest();
    call.open("POST", `/api/files?name=${encodeURIComponent(file.name)}`);
    call.upload.addEventListener("progress", (event) => { if (event.lengthComputable) progress(event.loaded / event.total); });
    call.addEventListener("load", () => {
      let answer = {};
      try { answer = JSON.parse(call.responseText); } catch { answer = { error: `The server answered with status ${call.status}.` }; }
      if (call.status < 400) done(answer);
      else failed(new ServerError(answer.error));
    });
    call.addEventListener("error", () => { say(false); failed(new Gone("The studio is not running.")); });
    call.setRequestHeader("content-type", "application/octet-stream");
    call.send(file);
  });
}

/** Server-sent events. The browser connects again by itself, except after some errors: then this does. */
export function listenToEvents(listeners) {
  let source;
  let again;
  const open = () => {
    clearTimeout(again);
    source?.close();
    source = new EventSource("/api/events");
    source.addEventListener("open", () => say(true));
    source.addEventListener("error", () => {
      say(false);
      // The browser does not tell why: a request does.
      if (source.readyState === EventSource.CLOSED) again = setTimeout(() => getJson("/api/choices").catch(() => {}).then(() => { if (!isOfEarlierStart) open(); }), 2000);
    });
    for (const [name, listener] of Object.entries(listeners)) source.addEventListener(name, (event) => listener(JSON.parse(event.data)));
  };
  open();
  return open;
}
