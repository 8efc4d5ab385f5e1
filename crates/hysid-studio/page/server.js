// Talks with the studio's server: JSON, binary arrays, uploads and live events.

const KEY = "hysid-studio-key";
/** The server gives the key once to the page that was opened with a token. It stays in this browser, for this address alone. */
const opened = fetch("/api/session", { method: "POST" })
  .then((answer) => answer.json())
  .then(({ key }) => { if (key) localStorage.setItem(KEY, key); }, () => {});
const keyHeader = () => ({ "x-hysid-key": localStorage.getItem(KEY) ?? "" });
if (location.search) history.replaceState(null, "", location.pathname + location.hash);

/** An error in the server's words: a text, or a list of texts and controls. */
class ServerError extends Error {
  constructor(words) {
    super([words].flat().map((part) => part.words ?? part).join(""));
    this.words = words;
  }
}
/** The server cannot be reached. */
export class Gone extends Error {}

/** Tells the page that the server is gone or back. */
export const connection = new EventTarget();
let isThere = true;
let isOfEarlierStart = false;
export const isStranger = () => isOfEarlierStart;
/** The key of this page is that of an earlier studio: no request will be answered until another page has the new one. */
function estranged(words) {
  isOfEarlierStart = true;
  connection.dispatchEvent(new CustomEvent("stranger", { detail: words }));
}
addEventListener("storage", (event) => { if (event.key === KEY && isOfEarlierStart) location.reload(); });
function say(there) {
  if (there === isThere || isOfEarlierStart) return;
  isThere = there;
  connection.dispatchEvent(new CustomEvent(there ? "back" : "gone"));
}

async function request(address, options) {
  await opened;
  let response;
  try {
    response = await fetch(address, { ...options, headers: { ...options?.headers, ...keyHeader() } });
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
export const getText = async (address) => (await request(address)).text();
/** Removes a file or a model from the project; gives a sentence if a file stays in the folder. */
export async function remove(address) {
  const { kept } = await (await request(address, { method: "DELETE" })).json();
  return kept.length ? `${kept.join(", ")} stays in its folder: somebody changed it, or Hysid did not write it.` : "";
}
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

/** Sends a file for a use, the usual one if none is given; `progress` gets the share that has arrived. */
export function upload(file, use, progress) {
  return new Promise((done, failed) => {
    const call = new XMLHttpRequest();
    call.open("POST", `/api/files?name=${encodeURIComponent(file.name)}${use ? `&use=${use}` : ""}`);
    call.upload.addEventListener("progress", (event) => { if (event.lengthComputable) progress(event.loaded / event.total); });
    call.addEventListener("load", () => {
      let answer = {};
      try { answer = JSON.parse(call.responseText); } catch { answer = { error: `The server answered with status ${call.status}.` }; }
      if (call.status < 400) done(answer);
      else failed(new ServerError(answer.error));
    });
    call.addEventListener("error", () => { say(false); failed(new Gone("The studio is not running.")); });
    call.setRequestHeader("content-type", "application/octet-stream");
    for (const [name, value] of Object.entries(keyHeader())) call.setRequestHeader(name, value);
    call.send(file);
  });
}

/** Server-sent events, with the key in a header, which the browser's own class for them cannot send. */
export function listenToEvents(listeners) {
  let stop;
  let again;
  async function open() {
    clearTimeout(again);
    stop?.abort();
    const own = new AbortController();
    stop = own;
    try {
      const response = await request("/api/events", { signal: own.signal });
      await eachEvent(response.body, (name, data) => listeners[name]?.(JSON.parse(data)));
    } catch {
      // The connection broke, or is refused: tried again below.
    }
    if (own.signal.aborted || isOfEarlierStart) return;
    say(false);
    again = setTimeout(open, 2000);
  }
  open();
  return open;
}

async function eachEvent(body, take) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    text += part.value;
    const events = text.split("\n\n");
    text = events.pop();
    for (const event of events) {
      const field = (name) => event.split("\n").find((line) => line.startsWith(`${name}: `))?.slice(name.length + 2);
      if (field("event")) take(field("event"), field("data"));
    }
  }
}
