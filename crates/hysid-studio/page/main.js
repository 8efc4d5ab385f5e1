// Starts the page: connects with the server, shows the step of the address, and says when the server is gone.

import { button, element } from "./elements.js";
import { project } from "./project.js";
import { connection, Gone, isStranger, listenToEvents } from "./server.js";
import { CompareStep } from "./steps/compare.js";
import { DataStep } from "./steps/data.js";
import { IdentifyStep } from "./steps/identify.js";
import { InvertStep } from "./steps/invert.js";
import { JudgeStep } from "./steps/judge.js";
import { PlanStep } from "./steps/plan.js";
import { RestoringForceStep } from "./steps/restoring-force.js";
import { TakeAwayStep } from "./steps/take-away.js";
import { CyclesStep, DiagnoseStep } from "./steps/training-page.js";
import { TryStep } from "./steps/try.js";
import { listenToDrops, sendFiles } from "./uploads.js";

const KINDS = { data: DataStep, diagnose: DiagnoseStep, figures: CyclesStep, identify: IdentifyStep, judge: JudgeStep, compare: CompareStep, invert: InvertStep, plan: PlanStep, "restoring-force": RestoringForceStep, "take-away": TakeAwayStep, try: TryStep };
const steps = new Map();
const banner = document.getElementById("banner");

/** The step of the address; `#judge/3` is the step `judge` of model 3. */
function shownStep() {
  const [name, model] = location.hash.slice(1).split("/");
  return { name: KINDS[name] ? name : "data", model: model ? Number(model) : null };
}

function show(event) {
  if (!project.state) return;
  const { name, model } = shownStep();
  for (const section of document.querySelectorAll("main > section")) section.hidden = section.id !== name;
  for (const link of document.querySelectorAll("header nav a")) {
    if (link.hash === `#${name}`) {
      link.setAttribute("aria-current", "page");
      // On a narrow screen the bar scrolls: the present step must be in sight.
      const bar = link.closest("nav");
      bar.scrollLeft = link.offsetLeft - bar.offsetLeft - (bar.clientWidth - link.offsetWidth) / 2;
    } else link.removeAttribute("aria-current");
  }
  if (!steps.has(name)) steps.set(name, new KINDS[name](document.querySelector(`#${name} > .body`)));
  const step = steps.get(name);
  if (model !== null) step.choose?.(model);
  document.title = `${document.querySelector(`header nav a[href="#${name}"]`).textContent} \u2013 ${project.state.name} \u2013 Hysid studio`;
  step.update();
  if (event?.type === "hashchange") {
    scrollTo(0, 0);
    document.querySelector(`#${name} h1`).focus({ preventScroll: true });
  }
}

function showProject() {
  document.getElementById("project").textContent = project.state.name;
  document.getElementById("project").title = project.state.folder;
  document.getElementById("program").textContent = project.choices.program;
  document.getElementById("reading").hidden = !project.state.is_reading;
  show();
}

/** Parts of a fit are said once each, not with every event. */
let said = "";
function showFit() {
  const { fit } = project.state;
  const ended = () => (fit.was_interrupted ? "The fit was interrupted." : fit.made ? "The fit is complete." : "The fit failed.");
  const words = fit?.is_running ? `Fit running: ${Math.floor(10 * fit.done) * 10} %` : fit ? ended() : "";
  if (words !== said) document.getElementById("live").textContent = words;
  said = words;
  document.getElementById("running").hidden = !fit?.is_running;
  document.getElementById("running").textContent = fit?.is_running ? `${Math.round(100 * fit.done)} %` : "";
  if (shownStep().name === "identify") steps.get("identify")?.update();
}

/** A file that is dropped on a step which takes one stays there; all others go to the data. */
listenToDrops(async (files) => {
  show();
  const { name } = shownStep();
  const step = steps.get(name);
  if (!step?.take || (project.models.length === 0 && !step.needsNoModel)) {
    location.hash = "data";
    await sendFiles(files);
    return;
  }
  const ids = await sendFiles(files, step.useOfDropped ?? "unseen");
  await project.load();
  if (ids.length > 0) step.take(ids.at(-1));
});

const load = () => project.load().catch((error) => {
  if (!(error instanceof Gone || isStranger())) showBanner(element("p", { text: error.message }), button("Try again", load));
});
function showBanner(...content) {
  banner.replaceChildren(...content);
  banner.hidden = false;
}
project.addEventListener("change", () => { banner.hidden = true; showProject(); showFit(); });
project.addEventListener("fit", showFit);
addEventListener("hashchange", show);
const connect = listenToEvents({ project: load, fit: (fit) => project.setFit(fit) });
connection.addEventListener("gone", () => {
  showBanner(element("p", {}, "The studio is not running. Start it again with: ", element("code", { text: `hysid studio --project "${project.state?.folder ?? "hysid-project"}"` })), button("Try again", connect));
});
connection.addEventListener("stranger", ({ detail }) => showBanner(element("p", { text: detail })));
connection.addEventListener("back", () => {
  banner.hidden = true;
  load();
});
load();
