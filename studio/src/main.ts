import { type ByHand, intoText, saidByHand } from "./byhand";
import type { Sweep } from "./cases";
import { besides, type Models, models } from "./compare";
import { Connection } from "./connection";
import { type Doubt, listed } from "./doubts";
import { Drag } from "./drag";
import { Editor, type Problem } from "./editor";
import { links, OF_RUNS } from "./exports";
import { Film } from "./film";
import { Form } from "./form";
import { Lesson, type Step } from "./lesson";
import { element, numbersOf, Player } from "./player";
import { Plots } from "./plots";
import type { Schema } from "./schema";
import { Stage } from "./stage";
import { SweepTab } from "./sweep";
import "./style.css";

interface Template {
  name: string;
  title: string;
  text: string;
}

// -- What is on the page ----------------------------------------------------------------------------------------

const status = element("span", { class: "status", role: "status" }, "connecting");
const open = element("select", { "aria-label": "Open", title: "Open a scenario, a result or an example" });
const save = element("button", { type: "button", title: "Save to the file that was opened (Ctrl+S)" }, "Save");
const saveAs = element("button", { type: "button" }, "Save as…");
const run = element("button", { type: "button", class: "main", title: "Compute the scenario (Ctrl+Enter)" }, "Run");
const stop = element("button", { type: "button", disabled: "" }, "Stop");
const drag = element("button", { type: "button", title: "Drag the load; the rope answers" }, "Drag the load");
const keep = element("button", { type: "button", title: "Keep this run, faintly, beside the next one" }, "Keep beside");
const theme = element(
  "button",
  { type: "button", class: "icon", "aria-label": "Light or dark", title: "Light or dark" },
  "◐",
);
const canvas = element("canvas", {
  tabindex: "0",
  role: "img",
  "aria-label": "The structure; arrow keys move the load or step through time",
});
const plotted = element("div", { class: "plots" });
const numbers = element("dl", { class: "numbers", "aria-live": "off" });
const said = element("div");
const summary = element("pre", { class: "summary" });
const exports = element("div", { class: "row" });
const compared = element("div");
const compareModels = element(
  "button",
  { type: "button", title: "Runs simpler models of the scenario, from the linear theory upwards: is one good enough?" },
  "Compare with simpler models",
);
const written = element("div", { class: "editor" });
const problems = element("ul", { class: "problems", "aria-label": "Mistakes", "aria-live": "polite" });
const values = element("div", { class: "values" });
const lessons = element("div");
const filled = element("div");
const swept = element("div");
const computeSweep = element("button", { type: "button" }, "Compute the sweep");

const tabs = {
  values: element("div", { class: "tab" }, values),
  form: element("div", { class: "tab", hidden: "" }, filled),
  text: element("div", { class: "tab text", hidden: "" }, written, problems),
  result: element("div", { class: "tab", hidden: "" }, said, exports, summary, compareModels, compared),
  sweep: element("div", { class: "tab", hidden: "" }, swept),
  lesson: element("div", { class: "tab", hidden: "" }, lessons),
};
const measured = element("div", {}, element("h2", {}, "Numbers"), numbers); // in the tab that is shown: of a lesson, too
const names = { values: "Values", form: "Form", text: "Text", result: "Result", sweep: "Sweep", lesson: "Lesson" };
const bar = element("div", { class: "tabs", role: "tablist" });
const buttons = new Map<string, HTMLButtonElement>();
for (const [key, tab] of Object.entries(tabs)) {
  const button = element("button", { type: "button", role: "tab", id: `tab-${key}` }, names[key as keyof typeof names]);
  tab.setAttribute("role", "tabpanel");
  tab.setAttribute("aria-labelledby", `tab-${key}`);
  button.onclick = () => show(key);
  buttons.set(key, button);
  bar.append(button);
}

function show(key: string): void {
  for (const [name, tab] of Object.entries(tabs)) {
    tab.hidden = name !== key;
    buttons.get(name)?.setAttribute("aria-selected", `${name === key}`);
  }
  if (key === "values" || key === "lesson") tabs[key].append(measured);
  if (key === "form") form.show(editor.text);
}

const stage = new Stage(canvas);
const plots = new Plots(plotted, (path) => player.go(path));
const player = new Player(stage, plots);
document.body.append(
  element("header", {}, element("h1", {}, "ropewalk studio"), open, save, saveAs, drag, run, stop, keep, status, theme),
  element(
    "main",
    {},
    element("section", { class: "stage" }, canvas, player.bar, plotted),
    element("aside", {}, bar, ...Object.values(tabs)),
  ),
);
player.bar.hidden = true;
show("values");

// -- State ------------------------------------------------------------------------------------------------------

let file = { name: "", stamp: "" };
let clean = ""; // the text as it is in the file
let film: Film | undefined;
let beside: Film | undefined;
let running = false;
let checking = 0;
let templates: Template[] = [];
let mistakes: Problem[] = [];
let doubtful: Doubt[] = [];
let toldOf = ""; // the doubts and notes that are shown

const server = new Connection(`${location.href.replace(/^http/, "ws").replace(/[#?].*$/, "")}socket`, (connected) => {
  tell(connected ? "" : "the server has gone; looking for it", !connected);
  if (connected) greet();
});
const editor = new Editor(written, () => {
  mark();
  if (!tabs.form.hidden) form.show(editor.text);
  clearTimeout(checking);
  checking = setTimeout(check, 300);
});
const form = new Form(filled, {
  change: (text) => editor.change(text),
  undo: () => editor.undo(),
  redo: () => editor.redo(),
});
const dragging = new Drag(server, stage, canvas, values, {
  shown: (scene, load) => numbersShown(scene, load),
  failed: (why) => tell(why, true),
  taken: takeOver,
  released: (pose) => compute("release", { pose }),
});
const sweeps = new SweepTab(swept, server, computeSweep, {
  tell,
  see: (text) => compute("run", { text, name: "case.yaml", unkept: true }),
  open: (text) => {
    if (editor.text !== clean && !confirm("The text has changes that are not saved. Open another one?")) return;
    begun("", "", text);
    show("text");
  },
});
const lesson = new Lesson(lessons, async (step) => begin(step));

function tell(text: string, bad = false): void {
  status.textContent = text;
  status.title = text;
  status.classList.toggle("bad", bad);
}

function mark(): void {
  const changed = editor.text !== clean;
  document.title = `${changed ? "• " : ""}${file.name || "new"} – ropewalk studio`;
  save.disabled = !changed || !file.name;
}

function numbersShown(scene: { layout: Film["layout"]; frame: Record<string, Float32Array> }, dragged = ""): void {
  const rows = numbersOf(scene, scene.frame, dragged);
  numbers.replaceChildren(...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

/** Write what was changed by hand into the text. */
function takeOver(hand: ByHand): boolean {
  try {
    editor.change(intoText(editor.text, hand));
  } catch (problem) {
    tell(problem instanceof Error ? problem.message : String(problem), true);
    return false;
  }
  tell(`in the text now: ${saidByHand(hand).join("; ")}`);
  return true;
}
player.shown = (shown, frame) => numbersShown({ layout: shown.layout, frame });

// -- Files ------------------------------------------------------------------------------------------------------

async function greet(): Promise<void> {
  const { head } = await server.ask("hello");
  if (head.error) return tell(String(head.error), true);
  templates = head.templates as Template[];
  list(head);
  lesson.learn(head.lesson as Step[]);
  server.ask("schema").then((message) => {
    editor.learn(message.head.schema as Schema);
    form.learn(message.head.schema as Schema);
  });
  if (editor.text) {
    prepare(); // the server had gone: what is on the page stays
    return;
  }
  const first = String(head.file);
  if (first.endsWith(".nc")) await result(first);
  else if (first) await read(first);
  else {
    show("lesson");
    await lesson.go(0);
  }
}

function list(head: Record<string, unknown>): void {
  const group = (label: string, names: [string, string][]) => {
    const made = element("optgroup", { label });
    made.append(...names.map(([value, text]) => element("option", { value }, text)));
    return made;
  };
  open.replaceChildren(
    element("option", { value: "" }, "Open…"),
    group(
      "Scenarios",
      (head.scenarios as string[]).map((name) => [`file:${name}`, name]),
    ),
    group(
      "Results",
      (head.results as string[]).map((name) => [`result:${name}`, name]),
    ),
    group(
      "Examples",
      templates.map((t) => [`template:${t.name}`, t.title]),
    ),
  );
}

let opening: Promise<void> = Promise.resolve();
open.onchange = () => {
  opening = chosen();
};

async function chosen(): Promise<void> {
  const [kind, name] = [open.value.slice(0, open.value.indexOf(":")), open.value.slice(open.value.indexOf(":") + 1)];
  open.value = "";
  if (kind === "result") return result(name);
  if (editor.text !== clean && !confirm("The text has changes that are not saved. Open another one?")) return;
  if (kind === "file") await read(name);
  if (kind === "template") begun("", "", templates.find((t) => t.name === name)?.text ?? "");
}

async function read(name: string): Promise<void> {
  const { head } = await server.ask("read", { name });
  if (head.error) return tell(String(head.error), true);
  begun(name, String(head.stamp), String(head.text));
}

function begun(name: string, stamp: string, text: string): void {
  file = { name, stamp };
  clean = text;
  editor.text = text;
  beside = undefined;
  doubts({});
  mark();
  if (!tabs.form.hidden) form.show(text);
  check();
  prepare();
}

async function write(name: string, stamp: string): Promise<void> {
  const text = editor.text;
  const { head } = await server.ask("save", { name, text, stamp });
  if (head.error) return tell(String(head.error), true);
  file = { name, stamp: String(head.stamp) };
  clean = text;
  mark();
  tell(`${name} saved`);
  list((await server.ask("files")).head);
}

save.onclick = () => write(file.name, file.stamp);
saveAs.onclick = () => {
  const name = prompt("Name of the file, in the folder of the studio", file.name || "scenario.yaml");
  if (name) write(name, name === file.name ? file.stamp : "");
};

// -- Text -------------------------------------------------------------------------------------------------------

async function check(): Promise<boolean> {
  const { head } = await server.ask("check", { text: editor.text, name: file.name || "scenario.yaml" });
  const found = (head.problems as Problem[]) ?? [{ line: 1, key: "", message: String(head.error) }];
  editor.show(found);
  mistakes = found;
  remarked();
  problems.replaceChildren(
    ...(found.length
      ? found.map((problem) => {
          const button = element("button", { type: "button" }, `line ${problem.line ?? "–"}: ${problem.message}`);
          button.onclick = () => editor.goTo(problem.line ?? 1);
          return element("li", {}, button);
        })
      : [element("li", { class: "fine" }, "No mistakes.")]),
  );
  if (!found.length && !running && !player.isActive) prepare();
  return !found.length;
}

// -- Dragging and running ---------------------------------------------------------------------------------------

let prepared = 0;

async function prepare(contact = ""): Promise<void> {
  const turn = ++prepared;
  halt();
  player.leave();
  player.bar.hidden = true;
  stage.doubted = [];
  const { head } = await server.ask("prepare", { text: editor.text, name: file.name || "scenario.yaml" });
  if (turn !== prepared) return; // another one, or a run, has begun since
  if (head.problems) return tell("the scenario has mistakes: see Text", true);
  if (head.error) return tell(String(head.error), true);
  tell(String(head.title));
  dragging.begin(head, contact);
}

drag.onclick = () => {
  show("values");
  prepare();
};
run.onclick = async () => {
  await opening; // it is meant, not what it replaces
  const hand = dragging.byHand;
  const said = hand ? saidByHand(hand) : [];
  const asked = `By hand, and not in the text: ${said.join("; ")}.\n\nOK: write it into the text and run that. Cancel: run the text as it stands.`;
  if (hand && said.length && confirm(asked) && !takeOver(hand)) return;
  compute("run", { text: editor.text, name: file.name || "scenario.yaml" });
};
stop.onclick = () => server.tell("stop");
keep.onclick = () => {
  beside = film;
  tell(beside ? "kept; the next run is drawn over it" : "there is no run yet");
};

function halt(): void {
  if (running) server.tell("stop");
}

async function compute(what: string, given: object, withBeside = beside): Promise<void> {
  if (running) return tell("a run is under way; stop it first", true);
  dragging.leave();
  prepared++;
  running = true;
  stop.disabled = false;
  run.disabled = true;
  doubts({});
  exports.replaceChildren();
  summary.textContent = "";
  compared.replaceChildren();
  tell("computing");
  player.isOver = false;
  film = undefined;
  let { head } = await server.ask(what, given, (message) => heard(message, withBeside));
  running = false;
  if (String(head.error).includes("holds a result of another scenario") && confirm(`${head.error}\n\nReplace it?`)) {
    run.disabled = false;
    return compute(what, { ...given, overwrite: true }, withBeside);
  }
  stop.disabled = true;
  run.disabled = false;
  player.isOver = true;
  ended(head);
  head = (await server.ask("files")).head;
  if (!head.error) list(head);
}

function heard(message: { head: Record<string, unknown>; arrays: Parameters<Film["add"]>[0] }, other?: Film): void {
  const { head, arrays } = message;
  if (head.event === "compiling")
    tell(`compiling, once for each kind of structure: ${head.how_long} on a quiet machine`);
  else if (head.event === "layout") {
    film = new Film(head);
    player.bar.hidden = false;
    player.load(film, other);
  } else if (film) {
    film.add(arrays);
    player.more();
    const told = head.run as { warnings: string[]; doubts: Doubt[] } | undefined;
    if (told) doubts(told);
    if (running) tell(`computing: ${Math.round((100 * film.count) / Math.max(film.total, 1))} %`);
  }
}

function doubts(told: { warnings?: string[]; doubts?: Doubt[] }): void {
  const now = JSON.stringify([told.doubts, told.warnings]);
  if (now === toldOf) return;
  toldOf = now;
  doubtful = told.doubts ?? [];
  stage.doubted = doubtful.map((doubt) => doubt.key);
  player.mark(doubtful);
  remarked();
  said.replaceChildren(...listed(doubtful, told.warnings ?? [], { go: (time) => player.stop(time), open: openKey }));
}

function openKey(key: string): void {
  show("form");
  form.goTo(key);
}

/** What the form tells at its fields: mistakes, and doubts about the run that is shown. */
function remarked(): void {
  const keyed = doubtful.filter((doubt) => doubt.key);
  form.tell([...mistakes, ...keyed.map(({ key, text }) => ({ key, message: text, isDoubt: true }))]);
}

function ended(head: Record<string, unknown>): void {
  if (head.problems) {
    tell("the scenario has mistakes: see Text", true);
    show("text");
    return;
  }
  if (head.error) return tell(String(head.error), true);
  const outcome = String(head.outcome);
  tell(head.file ? `${outcome}; result in ${head.file}` : outcome, !["completed", "interrupted"].includes(outcome));
  doubts(head as { warnings: string[]; doubts: Doubt[] });
  if (head.advice) said.prepend(element("p", { class: "hint" }, String(head.advice)));
  summary.textContent = String(head.summary);
  if (film) {
    film.title = String(head.title);
    film.numbers = head.numbers as Film["numbers"];
    const other = player.other;
    if (other) compared.replaceChildren(besides(film.numbers, other.numbers, film.title, other.title));
  }
  if (!head.file) return;
  exports.append(...links(String(head.file), OF_RUNS, tell));
}

async function result(name: string): Promise<void> {
  if (running) return tell("a run is under way; stop it first", true);
  dragging.leave();
  prepared++;
  player.isOver = true;
  doubts({});
  const { head } = await server.ask("result", { name }, (message) => heard(message, beside));
  if (head.sweep) return sweepFound(head);
  ended(head);
  show("result");
}

function sweepFound(head: Record<string, unknown>): void {
  const sweep = head.sweep as Sweep;
  tell(`${sweep.outcome}; sweep in ${head.file}`, sweep.outcome !== "completed");
  sweeps.show(String(head.file), sweep);
  show("sweep");
}

/** Have something computed that takes its time, and hear how far it is. */
async function computed(what: string, told: (head: Record<string, unknown>) => string) {
  await opening;
  if (running) return void tell("a run is under way; stop it first", true);
  prepared++;
  running = true;
  stop.disabled = false;
  run.disabled = computeSweep.disabled = compareModels.disabled = true;
  tell("computing");
  const given = { text: editor.text, name: file.name || "scenario.yaml" };
  const { head } = await server.ask(what, given, (message) => {
    if (running) tell(told(message.head));
  });
  running = false;
  stop.disabled = true;
  run.disabled = computeSweep.disabled = compareModels.disabled = false;
  const wrong = (head.problems as Problem[] | undefined)?.[0]?.message ?? head.error;
  if (wrong) return void tell(String(wrong), true);
  return head;
}

compareModels.onclick = async () => {
  const head = await computed("models", ({ model, done }) => `${model}: ${Math.round(100 * Number(done))} %`);
  if (!head) return;
  tell(`models of ${head.title} compared`);
  compared.replaceChildren(models(head as unknown as Models));
};

computeSweep.onclick = async () => {
  const head = await computed("sweep", ({ done, total }) => `computing: ${done} of ${total} cases`);
  if (head) sweepFound(head);
  const files = (await server.ask("files")).head;
  if (!files.error) list(files);
};

async function begin(step: Step): Promise<void> {
  file = { name: "", stamp: "" };
  clean = step.scenario;
  beside = undefined;
  editor.text = clean;
  if (!tabs.form.hidden) form.show(clean);
  mark();
  player.choose(step.pace, step.larger);
  dragging.leave();
  if (running) return;
  if (step.beside) {
    await compute("lesson", { name: `${step.name}.beside` }, undefined);
    beside = film;
  }
  await compute("lesson", { name: step.name }, beside);
}

// -- Keys -------------------------------------------------------------------------------------------------------

theme.onclick = () => {
  const dark = getComputedStyle(document.documentElement).getPropertyValue("--dark").trim() === "1";
  document.documentElement.dataset.theme = dark ? "light" : "dark";
  stage.draw();
  plots.clear();
  player.more();
  sweeps.draw();
};
addEventListener("keydown", (event) => {
  const control = event.ctrlKey || event.metaKey;
  if (control && event.key === "s") {
    if (!save.disabled) save.click();
  } else if (control && event.key === "Enter") run.click();
  else {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    const target = event.target as HTMLElement;
    const isOurs = target === canvas || target === document.body;
    if (!isOurs && !(by && (target.tagName === "BUTTON" || target.getAttribute("aria-label") === "Time"))) return;
    if (event.key === " ") player.toggle();
    else if (by && player.isActive) player.step(by);
    else if (by) dragging.nudge(by);
    else return;
  }
  event.preventDefault();
});
addEventListener("beforeunload", (event) => {
  if (editor.text !== clean) event.preventDefault();
});
