import type { ByHand } from "./byhand";
import { type Connection, Latest, wrongOf } from "./connection";
import { button, element, select } from "./dom";
import { Film, type Frame, type Layout } from "./film";
import type { Message } from "./messages";
import { viewOf } from "./player";
import type { Scene, Stage, View } from "./stage";
import { ends, written } from "./units";

interface Line {
  start: number[];
  end: number[];
  length: number | null;
  tension: number | null;
  mass: number;
  wind_drag: number;
}

interface Load {
  name: string;
  on: string;
  force: number[];
  line: Line;
}

interface Pose {
  load: string;
  x: number;
  contact: string;
  weight?: number;
  wind?: number; // m/s; not there: as the scenario says
  line: ByHand["line"];
}

interface Told {
  shown: (scene: Scene, load: string) => void;
  taken: (hand: ByHand) => boolean;
  failed: (why: string) => void;
  released: (pose: Pose) => void;
}

/** The frame of a message that has one alone, with its description. */
function sceneOf({ head, arrays }: Message): Scene {
  const { layout, picture, state } = head as unknown as Scene;
  const frame: Frame = Object.fromEntries(Object.entries(arrays).map(([name, { values }]) => [name, values]));
  return { layout, picture, state, frame, reference: frame.reference, ghost: frame.ghost };
}

const CONTACTS = [
  ["clamped", "clamped: the rope's friction holds it"],
  ["frictionless", "frictionless: a hold force keeps it"],
] as const;
const NEAR = 22; // pixels around a handle in which the mouse grasps it
const FINGER = 36; // pixels in which a finger does
const WIDTH = 0.01; // m, of a line that has told none, in the wind that is made by hand

/** Return the node that is nearest to a load. */
function nearest({ position, contact_position }: Frame, { axes, loads }: Layout, load: string): number {
  const k = Math.max(loads.indexOf(load), 0) * axes.length;
  let [node, least] = [0, Number.POSITIVE_INFINITY];
  for (let i = 0; i < position.length; i += axes.length) {
    const distance = Math.hypot(...axes.map((_, a) => position[i + a] - contact_position[k + a]));
    if (distance < least) [node, least] = [i / axes.length, distance];
  }
  return node;
}

/** All of the lines, and below them what a load needs. */
function viewOfPose({ frame: { position }, layout: { axes } }: Scene): View {
  const [low, high] = ends(position.filter((_, i) => i % axes.length === 0));
  const w = high - low;
  const level = Math.max(position[axes.length - 1], position[position.length - 1]);
  return { x: [low - 0.04 * w, high + 0.04 * w], z: [level - 0.24 * w, level + 0.07 * w], force: 1 };
}

/** The load under the pointer: the equilibrium for every place, and what else can be changed by hand. */
export class Drag {
  private loads: Load[] = [];
  private load?: Load;
  private pose?: Pose;
  private gravity = 9.81;
  private view?: View;
  private grabbed = ""; // "load", or the name of a support
  private loaded = 0; // node nearest to the load
  private latest = new Latest<{ pose: Pose; since: number }>(({ pose, since }) => this.ask(pose, since));
  /** For tests: how long it took from what was done by hand to its picture, in ms. */
  readonly delays: number[] = [];

  constructor(
    private server: Connection,
    private stage: Stage,
    private canvas: HTMLCanvasElement,
    private place: HTMLElement,
    private told: Told,
  ) {
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    const touched = (event: TouchEvent) =>
      this.load && this.handleAt(event.touches[0], FINGER) && event.preventDefault();
    canvas.addEventListener("touchstart", touched, { passive: false }); // a swipe that starts on a handle does not scroll
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.onpointerup = canvas.onpointercancel = () => {
      this.grabbed = "";
    };
    const loadPixel = () => stage.pixel(this.loaded);
    Object.assign(globalThis, { ropewalkDelays: this.delays, ropewalkLoad: loadPixel });
  }

  /** Take up a scenario that the server has made ready. */
  begin(message: Message, contact = ""): void {
    const { head, arrays } = message;
    this.loads = head.loads as Load[];
    this.gravity = head.gravity as number;
    this.take(this.loads[0], contact);
    if (!this.load) {
      this.stage.hint = "Run shows this scenario.";
      const film = head.picture ? new Film(message) : undefined;
      film?.add({ head, arrays: { ...arrays, path: { shape: [1], values: Float32Array.of(0) } } });
      if (film) this.stage.show({ ...sceneOf(message), orbits: true }, viewOf(film, film.state.factor));
      else this.stage.show(undefined);
      const why = "Nothing here can be dragged: forces and masses on lines can. Run it instead.";
      this.place.replaceChildren(element("p", { class: "hint" }, why));
    }
  }

  /** What is other than in the text. */
  get byHand(): ByHand | undefined {
    if (!this.load || !this.pose) return undefined;
    const { weight, wind, line } = this.pose;
    return { load: this.load.name, on: this.load.on, gravity: this.gravity, weight, wind, line };
  }

  leave(): void {
    this.load = undefined;
    this.pose = undefined;
    this.place.replaceChildren(
      element("p", { class: "hint" }, "Choose “Drag the load” to drag it and to change values."),
    );
  }

  private take(load: Load | undefined, contact = ""): void {
    this.load = load;
    this.view = undefined;
    if (!load) return;
    const { start, end } = load.line;
    this.pose = { load: load.name, x: start[0] + 0.3 * (end[0] - start[0]), contact: contact || "clamped", line: {} };
    this.panel();
    this.latest.want({ pose: this.pose, since: performance.now() });
  }

  /** Move the load by a part of the span. */
  nudge(by: number): void {
    if (!this.load || !this.pose) return;
    this.want({ x: this.pose.x + 0.01 * by * (this.load.line.end[0] - this.load.line.start[0]) });
  }

  private want(change: Partial<Pose>): void {
    if (!this.pose) return;
    this.pose = { ...this.pose, ...change };
    this.latest.want({ pose: this.pose, since: performance.now() });
  }

  /** Ask, and show the answer with the next frame; the next question does not wait for that. */
  private async ask(pose: Pose, since: number): Promise<void> {
    const message = await this.server.ask("pose", { pose });
    const { head } = message;
    if (!this.load || this.pose?.load !== pose.load) return;
    const wrong = wrongOf(head);
    if (wrong) return this.told.failed(wrong);
    const scene = sceneOf(message);
    this.loaded = nearest(scene.frame, scene.layout, pose.load);
    this.view ??= viewOfPose(scene);
    const { reaction, contact_force } = scene.frame;
    this.view.force = Math.max(...[...reaction, ...contact_force].map(Math.abs).filter(Number.isFinite), 1);
    this.stage.show(scene, this.view);
    this.told.shown(scene, pose.load);
    requestAnimationFrame(() => {
      this.delays.push(performance.now() - since);
      if (this.delays.length > 2000) this.delays.shift();
    });
  }

  /** Pixels of the canvas at which a pointer is; the page may be zoomed. */
  private pixel({ clientX, clientY }: { clientX: number; clientY: number }): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    const zoom = this.canvas.clientWidth / box.width;
    return [zoom * (clientX - box.left), zoom * (clientY - box.top)];
  }

  /** The handle near a pointer: a support of the line of the load, or the load; empty where there is none. */
  private handleAt(pointer: { clientX: number; clientY: number }, reach: number): string {
    const at = this.pixel(pointer);
    const near = (node: number) => {
      const [x, z] = this.stage.pixel(node);
      return Math.hypot(x - at[0], z - at[1]) < reach;
    };
    const ends = this.stage.supportNodes().filter(([name]) => name.startsWith(`${this.load?.on}.`));
    return ends.find(([, node]) => near(node))?.[0] ?? (near(this.loaded) ? "load" : "");
  }

  private down(event: PointerEvent): void {
    if (!this.load) return;
    const isTouch = event.pointerType === "touch"; // elsewhere on the picture a finger scrolls, a mouse moves the load
    this.grabbed = this.handleAt(event, isTouch ? FINGER : NEAR) || (isTouch ? "" : "load");
    if (!this.grabbed) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.move(event);
  }

  private move(event: PointerEvent): void {
    if (!this.grabbed || !this.load || !this.pose) return;
    const [x, z] = this.stage.place(...this.pixel(event));
    if (this.grabbed === "load") return this.want({ x });
    const end = this.grabbed.slice(this.grabbed.lastIndexOf(".") + 1);
    const old = this.load.line[end as "start" | "end"];
    this.want({ line: { ...this.pose.line, [end]: old.length === 2 ? [x, z] : [x, old[1], z] } });
  }

  /** A slider for the weight, the wind or a key of the line. */
  private slider(label: string, unit: string, value: number, low: number, high: number, key = label): HTMLElement {
    const about = { min: `${low}`, max: `${high}`, step: "any", "aria-label": `${label} (${unit})` };
    const input = element("input", { type: "range", ...about });
    input.valueAsNumber = value;
    const changed = (value: number) => {
      const line = this.pose?.line;
      if (key === "weight") this.want({ weight: value });
      else if (key === "wind")
        this.want({ wind: value, line: { wind_drag: this.load?.line.wind_drag || WIDTH, ...line } });
      else this.want({ line: { ...line, [key]: value } });
    };
    const output = element("output", {}, written(value, unit));
    input.oninput = () => {
      output.value = written(input.valueAsNumber, unit);
      input.setAttribute("aria-valuetext", output.value);
      changed(input.valueAsNumber);
    };
    return element("label", { class: "slider" }, element("span", {}, label), input, output);
  }

  private panel(): void {
    const { load, pose } = this;
    if (!load || !pose) return;
    const contact = select("Contact", [...CONTACTS], (value) => this.want({ contact: value }), { value: pose.contact });
    const names = this.loads.map(({ name }) => name);
    const taken = (name: string) => this.take(this.loads.find((one) => one.name === name));
    const which = select("Load", names, taken, { value: load.name });
    const go = button("Let go", () => this.pose && this.told.released(this.pose), {
      title: "It slides and swings as a mass that weighs as much",
    });
    const reset = button("As in the file", () => this.take(load, this.pose?.contact));
    const keep = button("Into the text", () => this.byHand && this.told.taken(this.byHand), {
      title: "Write what was changed by hand into the text",
    });
    const { line, force } = load;
    const span = Math.hypot(...line.end.map((e, a) => e - line.start[a]));
    const weight = -force[force.length - 1];
    const tension = line.tension || 1;
    const shortest = Math.min(0.998 * span, line.length ?? span);
    this.place.replaceChildren(
      element("p", { class: "hint" }, "Drag the load or a support in the picture (arrow keys move the load)."),
      element("div", { class: "row" }, which, contact),
      weight > 0 ? this.slider("weight", "N", weight, 0.02 * weight, 3 * weight) : "",
      line.length === null
        ? this.slider("tension", "N", tension, 0.3 * tension, 3 * tension)
        : this.slider("length", "m", line.length, shortest, Math.max(1.2 * span, line.length)),
      this.slider("mass", "kg/m", line.mass, 0.05 * line.mass, 5 * line.mass),
      this.slider("wind", "m/s", 0, -40, 40),
      this.slider("width in wind", "m", line.wind_drag || WIDTH, 0.001, 0.1, "wind_drag"),
      element("div", { class: "row" }, go, reset, keep),
    );
  }
}
