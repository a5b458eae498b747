import { type ByHand, intoText, saidByHand } from "./byhand";
import type { Sweep } from "./cases";
import { besides, type Models, models } from "./compare";
import { Connection, type Heard, wrongOf } from "./connection";
import { button, choices, coloursOf, element, folded } from "./dom";
import { type Doubt, listed } from "./doubts";
import { Drag } from "./drag";
import { Editor, type Problem } from "./editor";
import { links, OF_RUNS } from "./exports";
import { Film } from "./film";
import { Form } from "./form";
import { Lesson, type Step } from "./lesson";
import type { Message } from "./messages";
import { Player } from "./player";
import type { Schema } from "./schema";
import { SweepTab } from "./sweep";
import { tabbed } from "./tabs";
import "./style.css";

// -- What is on the page ----------------------------------------------------------------------------------------

const status = element("span", { class: "status", role: "status" }, "connecting");
const state = element("p", { class: "state", role: "status", hidden: "" }); // of what is computed, in the picture
const open = element("select", { "aria-label": "Open", title: "Open a scenario, a result or an example" });
const opened = element("strong", { class: "file" });
const save = button("Save", () => write(file.name, file.stamp), { title: "Save to the file that was opened (Ctrl+S)" });
const saveAs = button("Save as…");
const run = button("Run", undefined, { class: "main", title: "Compute the scenario (Ctrl+Enter)" });
const stop = button("Stop", undefined, { disabled: "" });
const drag = button("Drag the load", undefined, { title: "Drag the load; the rope answers" });
const keep = button("Keep beside", undefined, { title: "Draw this run faintly under the next one" });
const theme = button("◐", undefined, { class: "icon", "aria-label": "Light or dark", title: "Light or dark" });
const largely = { class: "icon", "aria-label": "Large type", title: "Large type, for projectors" };
const large = button("A", undefined, largely);
const player = new Player("The structure; arrow keys move the load or step through time");
const { stage, canvas, plotted, numbers } = player;
const said = element("div");
const summary = element("div");
const exports = element("div", { class: "row" });
const compared = element("div");
const compareModels = button("Compare with simpler models", () => simplerModels(), {
  title: "Run simpler models of the scenario, from the linear theory upwards",
});
const written = element("div", { class: "editor" });
const problems = element("ul", { class: "problems", "aria-label": "Mistakes", "aria-live": "polite" });
const values = element("div", { class: "values" });
const lessons = element("div");
const computeSweep = button("Compute the sweep", () => sweepCases());

const tabs = {
  values: element("div", { class: "tab" }, values),
  form: element("div", { class: "tab" }),
  text: element("div", { class: "tab text" }, written, problems),
  result: element("div", { class: "tab" }, said, exports, summary, compareModels, compared),
  sweep: element("div", { class: "tab" }),
  lesson: element("div", { class: "tab" }, lessons),
};
const measured = element("div", {}, element("h2", {}, "Numbers"), numbers); // in the tab that is shown: of a lesson, too
const { bar, show } = tabbed(tabs, (key) => {
  if (key === "values" || key === "lesson") tabs[key].append(measured);
  if (key === "form") form.show(editor.text);
});

document.body.append(
  element(
    "header",
    {},
    element("h1", {}, "ropewalk studio"),
    open,
    opened,
    ...[save, saveAs, drag, run, stop, keep, status, large, theme],
  ),
  element(
    "main",
    {},
    element("section", { class: "stage", "aria-label": "Picture" }, canvas, state, player.bar, plotted),
    element("aside", {}, bar, ...Object.values(tabs)),
  ),
);
player.bar.hidden = true;
show("values");

// -- State ------------------------------------------------------------------------------------------------------

let file = { name: "", stamp: "" };
let clean = ""; // the text as it is in the file
let beside: Film | undefined;
let running: Promise<unknown> | undefined; // what is computed
let isKept = false; // whether it writes a result
let turn = 0; // number of what is shown: answers to what was shown before are dropped
let shown = ""; // result that was opened
let checking = 0;
let templates: Record<"name" | "title" | "text", string>[] = [];
let mistakes: Problem[] = [];
let doubtful: Doubt[] = [];
let toldOf = ""; // the doubts and notes that are shown

const server = new Connection(`${location.href.replace(/^http/, "ws").replace(/[#?].*$/, "")}socket`, (connected) => {
  tell(connected ? "" : "no connection to the server; trying again", !connected);
  if (connected) greet();
  else under("");
});
const editor = new Editor(written, () => {
  mark();
  if (!tabs.form.hidden) form.show(editor.text);
  clearTimeout(checking);
  checking = setTimeout(() => check(true), 300);
});
const form = new Form(tabs.form, editor);
const dragging = new Drag(server, stage, canvas, values, {
  shown: (scene, load) => {
    if (!running) under("");
    player.count(scene, scene.frame, load);
  },
  failed: (why) => {
    under("");
    tell(why, true);
  },
  taken: takeOver,
  released: (pose) => compute("release", { pose }),
});
const sweeps = new SweepTab(tabs.sweep, server, computeSweep, {
  tell,
  see: (text) => compute("run", { text, name: "case.yaml", unkept: true }),
  open: (text) => {
    if (!mayLeave()) return;
    begun("", "", text);
    show("text");
  },
});
const lesson = new Lesson(lessons, begin);

function tell(text: string, bad = false): void {
  status.textContent = text;
  status.title = text;
  status.classList.toggle("bad", bad);
}

/** Show the state of what is computed in the picture. */
function under(text: string): void {
  state.textContent = text;
  state.hidden = !text;
}

function mark(): void {
  const changed = editor.text !== clean;
  const name = `${changed ? "• " : ""}${file.name || "new"}`;
  opened.textContent = shown && shown !== `${file.name}` ? shown : name;
  opened.title = changed ? `${name.slice(2)} has changes that are not saved` : name;
  document.title = `${opened.textContent} – ropewalk studio`;
  save.disabled = !changed || !file.name;
}

/**
 * Begin to show something else: of what was shown nothing stays but the picture, where it is of the same scenario.
 *
 * Returns the number by which late answers are recognised. `step`: of the lesson, if it is what is shown.
 */
function anew(hasPicture = false, step?: Step): number {
  dragging.leave();
  doubts({});
  for (const part of [exports, summary, compared, numbers]) part.replaceChildren();
  shown = "";
  player.leave();
  player.bar.hidden = true;
  if (!hasPicture) stage.show(undefined);
  lesson.show(step);
  mark();
  return ++turn;
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

// -- Files ------------------------------------------------------------------------------------------------------

async function greet(): Promise<void> {
  const { head } = await server.ask("hello", { page: sessionStorage.getItem("page") ?? "" });
  if (head.error) return tell(String(head.error), true);
  sessionStorage.setItem("page", String(head.page));
  templates = head.templates as typeof templates;
  list(head);
  lesson.learn(head.lesson as Step[]);
  server.ask("schema").then((message) => {
    editor.schema = message.head.schema as Schema;
    form.learn(message.head.schema as Schema);
  });
  if (head.under_way) return resume(head.under_way as Record<string, string>);
  if (editor.text) {
    prepare(); // the connection was lost: what is on the page stays
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

/** Come back to what the server computes for this page, which was reloaded. */
async function resume({ id, do: what, text = "", name = "", unkept }: Record<string, string>): Promise<void> {
  if (!editor.text) {
    const { stamp, text: saved } = (unkept ? {} : (await server.ask("read", { name })).head) as Record<string, string>;
    if (stamp) file = { name, stamp };
    clean = saved ?? text;
    editor.text = text;
  }
  if (what === "sweep") sweepCases(Number(id));
  else if (what === "models") simplerModels(Number(id));
  else compute("resume", { unkept: unkept || what === "release" }, Number(id));
}

function list(head: Record<string, unknown>): void {
  const named = (kind: string, names: unknown) => (names as string[]).map((name) => [`${kind}:${name}`, name] as const);
  const groups = {
    Scenarios: named("file", head.scenarios),
    Results: named("result", head.results),
    Examples: templates.map(({ name, title }) => [`template:${name}`, title] as const),
  };
  open.replaceChildren(element("option", { value: "" }, "Open…"));
  for (const [label, options] of Object.entries(groups)) {
    open.append(element("optgroup", { label }, ...choices(options)));
  }
}

let opening: Promise<void> = Promise.resolve();
open.onchange = () => {
  opening = chosen();
};

async function chosen(): Promise<void> {
  const [kind, name] = [open.value.slice(0, open.value.indexOf(":")), open.value.slice(open.value.indexOf(":") + 1)];
  open.value = "";
  if (kind === "result") return result(name);
  if (!(await halted()) || !mayLeave()) return;
  if (kind === "file") await read(name);
  if (kind === "template") begun("", "", templates.find((t) => t.name === name)?.text ?? "");
}

async function read(name: string): Promise<void> {
  const { head } = await server.ask("read", { name });
  if (head.error) return tell(String(head.error), true);
  begun(name, String(head.stamp), String(head.text));
}

/** Whether the text may be replaced by another one. */
function mayLeave(): boolean {
  return editor.text === clean || confirm("The text has changes that are not saved. Open another one?");
}

function put(name: string, stamp: string, text: string): void {
  file = { name, stamp };
  clean = text;
  editor.text = text;
  beside = undefined;
  if (!tabs.form.hidden) form.show(text);
}

function begun(name: string, stamp: string, text: string): void {
  put(name, stamp, text);
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
  refresh();
}

/** List the files of the folder anew. */
async function refresh(): Promise<void> {
  const { head } = await server.ask("files");
  if (!head.error) list(head);
}

/** What is computed: the text, and the name of its file. */
const given = () => ({ text: editor.text, name: file.name || "scenario.yaml" });

saveAs.onclick = () => {
  const name = prompt("Name of the file, in the folder of the studio", file.name || "scenario.yaml");
  if (name) write(name, name === file.name ? file.stamp : "");
};

// -- Text -------------------------------------------------------------------------------------------------------

async function check(prepares = false): Promise<boolean> {
  const { head } = await server.ask("check", given());
  const found = (head.problems as Problem[]) ?? [{ line: 1, key: "", message: String(head.error) }];
  editor.show(found);
  mistakes = found;
  remarked();
  problems.replaceChildren(
    ...(found.length
      ? found.map(({ line, message }) =>
          element(
            "li",
            {},
            button(`line ${line ?? "–"}: ${message}`, () => editor.goTo(line ?? 1)),
          ),
        )
      : [element("li", { class: "fine" }, "No mistakes.")]),
  );
  if (prepares && !found.length && !running && !player.film) prepare();
  return !found.length;
}

// -- Dragging and running ---------------------------------------------------------------------------------------

async function prepare(): Promise<void> {
  if (!(await halted())) return;
  const mine = anew();
  under("setting up");
  const message = await server.ask("prepare", given());
  const { head } = message;
  if (mine !== turn) return;
  under("");
  if (head.problems) return tell("the scenario has mistakes: see Text", true);
  if (head.error) return tell(String(head.error), true);
  tell(String(head.title));
  dragging.begin(message);
}

drag.onclick = () => {
  show("values");
  prepare();
};
run.onclick = async () => {
  await opening; // the file that was chosen last is meant
  const hand = dragging.byHand;
  const said = hand ? saidByHand(hand) : [];
  const asked = `Changed by hand, and not in the text: ${said.join("; ")}.\n\nOK: write it into the text and run that. Cancel: run the text as it is.`;
  if (hand && said.length && confirm(asked) && !takeOver(hand)) return;
  compute("run", given());
};
stop.onclick = () => {
  stop.disabled = true;
  under("stopping");
  server.tell("stop");
};
keep.onclick = () => {
  beside = player.film;
  tell(beside ? "kept; the next run is drawn over it" : "there is no run yet");
};

/** Stop what is computed; false if it writes a result and the user lets it continue. */
async function halted(): Promise<boolean> {
  if (running && isKept && !confirm("A computation is under way. Stop it?")) return false;
  if (running) stop.click();
  await running;
  return true;
}

/** Return the answer of the server to something that takes time; `id`: of what is under way already. */
async function computed(what: string, given: object, heard: Heard, id?: number): Promise<Record<string, unknown>> {
  const asked = server.ask(id ? "resume" : what, given, told, id);
  running = asked;
  isKept = what !== "release" && !("unkept" in given && given.unkept);
  function told(message: Message): void {
    if (message.head.event !== "stopped") return heard(message);
    busy(false, "stopped; completing the result");
  }
  busy(true, "setting up");
  const { head } = await asked;
  running = undefined;
  busy(false, "");
  return head;
}

function busy(isBusy: boolean, text: string): void {
  stop.disabled = !isBusy;
  for (const button of [run, computeSweep, compareModels]) button.disabled = isBusy;
  under(text);
}

/** Run something, and show it unless something else is shown by then. */
async function compute(what: string, given: Record<string, unknown>, id?: number): Promise<void> {
  if (!(await halted())) return;
  const mine = anew(!given.unkept);
  tell("");
  player.isOver = false;
  const other = beside;
  const head = await computed(what, given, (message) => heard(message, mine, other), id);
  player.isOver = true;
  refresh();
  if (mine !== turn) return;
  if (head.replaces && confirm(`${head.replaces} holds no result of this scenario. Replace it?`))
    return compute(what, { ...given, overwrite: true });
  if (head.replaces) tell(`${head.replaces} was not replaced`, true);
  else ended(head);
}

function heard(message: Message, mine: number, other?: Film): void {
  if (mine !== turn) return;
  const { head } = message;
  if (head.event === "state") under(String(head.state));
  else if (head.event === "layout") {
    player.bar.hidden = false;
    player.load(new Film(message), other);
  } else if (player.film) {
    const { film } = player;
    film.add(message);
    player.more();
    const told = head.run as { warnings: string[]; doubts: Doubt[] } | undefined;
    if (told) doubts(told);
    if (!stop.disabled) under(`computing ${Math.round((100 * film.count) / Math.max(film.total, 1))} %`);
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
  const open = (key: string) => {
    show("form");
    form.goTo(key);
  };
  said.replaceChildren(...listed(doubtful, told.warnings ?? [], (time) => player.stop(time), open));
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
  summary.replaceChildren(...folded(String(head.summary)));
  const { film, beside: other } = player;
  if (film) {
    film.complete(head);
    player.redraw();
    if (other) compared.replaceChildren(besides(film.numbers, other.numbers, film.title, other.title));
  }
  if (!head.file) return;
  exports.append(...links(String(head.file), OF_RUNS, tell));
}

/** Show what is computed already; returns how it ended, or nothing if something else is shown by then. */
async function stored(what: "result" | "lesson", name: string, step?: Step) {
  const mine = anew(false, step);
  player.isOver = false; // a film plays until its last frame has come
  under("opening");
  const { head } = await server.ask(what, { name }, (message) => heard(message, mine, beside));
  if (mine !== turn) return;
  player.isOver = true;
  under("");
  return head;
}

async function result(name: string): Promise<void> {
  if (!(await halted())) return;
  const head = await stored("result", name);
  if (!head) return;
  shown = name;
  mark();
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

/** Have the text computed in another way than as one run; nothing if that fails or something else is shown by then. */
async function extra(what: string, told: (head: Record<string, unknown>) => string, id?: number) {
  await opening;
  if (!(await halted())) return;
  const mine = turn;
  const head = await computed(what, given(), (message) => stop.disabled || under(told(message.head)), id);
  if (mine !== turn) return;
  const wrong = wrongOf(head);
  if (wrong) return void tell(wrong, true);
  return head;
}

async function simplerModels(id?: number): Promise<void> {
  const head = await extra("models", ({ model, done }) => `${model}: ${Math.round(100 * Number(done))} %`, id);
  if (!head) return;
  tell(`models of ${head.title} compared`);
  compared.replaceChildren(models(head as unknown as Models));
}

async function sweepCases(id?: number): Promise<void> {
  const head = await extra("sweep", ({ done, total }) => `computing: ${done} of ${total} cases`, id);
  if (head) sweepFound(head);
  refresh();
}

async function begin(step: Step): Promise<void> {
  if (!(await halted())) return;
  put("", "", step.scenario);
  player.choose(step.pace);
  for (const name of step.beside ? [`${step.name}.beside`, step.name] : [step.name]) {
    const head = await stored("lesson", name, step);
    if (!head) return; // another one was chosen meanwhile
    ended(head);
    if (name !== step.name) beside = player.film;
  }
}

// -- Keys -------------------------------------------------------------------------------------------------------

theme.onclick = () => {
  document.documentElement.dataset.theme = coloursOf(document.body)("--dark") === "1" ? "light" : "dark";
  redraw();
};
large.onclick = () => {
  const isLarge = document.documentElement.classList.toggle("large");
  large.setAttribute("aria-pressed", `${isLarge}`);
  redraw();
};
function redraw(): void {
  player.redraw();
  sweeps.map.draw();
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
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
    if (by && !player.film) dragging.nudge(by);
    else if (!player.press(event.key)) return;
  }
  event.preventDefault();
});
addEventListener("beforeunload", (event) => {
  if (editor.text !== clean) event.preventDefault();
});
