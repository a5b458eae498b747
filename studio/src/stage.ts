import { beneath } from "./beneath";
import { stepOf, steps } from "./colours";
import { type Frame, type Layout, tensionsOf } from "./film";
import type { Space } from "./space";
import { ticks, written } from "./units";

export interface Scene {
  layout: Layout;
  frame: Frame;
  ghost?: Float32Array;
  beside?: { layout: Layout; frame: Frame }; // another run, drawn faintly
  orbits?: boolean; // in space, by a camera that goes around it
  rest?: Frame; // what displacements are measured from where they are exaggerated
}

type Range = [number, number];
export interface View {
  x: Range;
  z: Range;
  tension: Range;
  force: number; // N, the longest arrow
}

export interface Choices {
  exaggeration: number;
  arrows: boolean;
  turn: number; // rad, of the camera about the vertical, in space
}

const MARGIN = { left: 96, right: 96, top: 60, bottom: 40 };

/** Draws a structure with its loads on a canvas. */
export class Stage {
  /** What is written where nothing is shown. */
  hint = "";
  /** Keys of the scenario that doubts name: their loads and lines are marked. */
  doubted: string[] = [];
  choices: Choices = { exaggeration: 1, arrows: true, turn: 0.5 };
  private scene?: Scene;
  private view: View = { x: [0, 1], z: [-1, 1], tension: [0, 1], force: 1 };
  private scale: [number, number, number, number] = [1, 0, 1, 0];
  private due = false;

  private closing = new AbortController();
  private space?: Space | null; // null: it is on its way, or there is none

  constructor(readonly canvas: HTMLCanvasElement) {
    new ResizeObserver(() => this.draw()).observe(canvas);
    const { signal } = this.closing;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw(), { signal });
  }

  /** Let go of what outlives the canvas. */
  close(): void {
    this.closing.abort();
    this.space?.close();
    this.space = null;
    this.show(undefined);
  }

  show(scene: Scene | undefined, view?: View): void {
    this.scene = scene;
    if (view) this.view = view;
    if (this.orbits && this.space === undefined) this.open();
    this.draw();
  }

  private get orbits(): boolean {
    return this.scene?.orbits === true && this.scene.layout.axes.length === 3;
  }

  /** Fetch what draws in space; where the browser cannot, the oblique picture stays. */
  private async open(): Promise<void> {
    this.space = null;
    if (!SPACE || !document.createElement("canvas").getContext("webgl2")) return;
    const { Space } = await import("./space");
    if (!this.closing.signal.aborted) this.space = new Space(this.canvas, () => this.draw());
    this.draw();
  }

  /** The camera that is in use. */
  private get camera(): Space | undefined {
    return this.orbits ? (this.space ?? undefined) : undefined;
  }

  draw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.paint();
    });
  }

  /** Where a place on the canvas is, in m. */
  place(px: number, py: number): [number, number] {
    const [sx, ox, sz, oz] = this.scale;
    return [(px - ox) / sx, (py - oz) / sz];
  }

  /** Where a node is drawn. */
  private at(position: Float32Array, i: number, rest?: Float32Array): [number, number] {
    const [sx, ox, sz, oz] = this.scale;
    const axes = this.scene?.layout.axes.length ?? 2;
    if (this.camera) {
      const k = rest ? this.choices.exaggeration : 1;
      const [x, y, w] = [0, 1, 2].map((a) => {
        const p = position[3 * i + a];
        return rest && k !== 1 ? rest[3 * i + a] + k * (p - rest[3 * i + a]) : p;
      });
      return this.camera.pixel([x, y, w], this.canvas.clientWidth, this.canvas.clientHeight);
    }
    const [x, z] = this.flat(position, i * axes, axes, rest);
    return [ox + sx * x, oz + sz * z];
  }

  /** What loads and bodies of a frame are exaggerated from; nothing while nothing is. */
  private restOf(frame: Frame, places: Float32Array | undefined): Float32Array | undefined {
    const scene = this.scene;
    if (!places || !scene?.rest || this.choices.exaggeration === 1) return undefined;
    return beneath(scene.layout, frame, scene.rest.position, places);
  }

  private flat(p: Float32Array, at: number, axes: number, rest?: Float32Array): [number, number] {
    const k = this.choices.exaggeration;
    const shown = (a: number) => (rest && k !== 1 ? rest[at + a] + k * (p[at + a] - rest[at + a]) : p[at + a]);
    if (axes === 2) return [shown(0), shown(1)];
    const { turn } = this.choices;
    const y = shown(1);
    return [
      shown(0) * Math.cos(turn) + y * Math.sin(turn),
      shown(2) + 0.4 * (y * Math.cos(turn) - shown(0) * Math.sin(turn)),
    ];
  }

  private fit(width: number, height: number): void {
    const scene = this.scene;
    let [x, z] = [this.view.x, this.view.z];
    if (scene && scene.layout.axes.length === 3) [x, z] = this.box(scene);
    const w = Math.max(x[1] - x[0], 1e-9);
    const h = Math.max(z[1] - z[0], 1e-9);
    const s = Math.min((width - MARGIN.left - MARGIN.right) / w, (height - MARGIN.top - MARGIN.bottom) / h);
    const middle = (MARGIN.top + height - MARGIN.bottom) / 2;
    const ox = MARGIN.left + (width - MARGIN.left - MARGIN.right - s * w) / 2 - s * x[0];
    this.scale = [s, ox, -s, middle + (s * (z[0] + z[1])) / 2];
  }

  private box(scene: Scene): [Range, Range] {
    const x: Range = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    const z: Range = [...x];
    const p = (scene.rest ?? scene.frame).position;
    for (let i = 0; i < p.length; i += 3) {
      const [a, b] = this.flat(p, i, 3);
      x[0] = Math.min(x[0], a);
      x[1] = Math.max(x[1], a);
      z[0] = Math.min(z[0], b);
      z[1] = Math.max(z[1], b);
    }
    const free = 0.08 * Math.max(x[1] - x[0], z[1] - z[0]);
    return [
      [x[0] - free, x[1] + free],
      [z[0] - free, z[1] + free],
    ];
  }

  private paint(): void {
    const { canvas, scene } = this;
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const ink = canvas.getContext("2d");
    if (!ink) return;
    ink.setTransform(ratio, 0, 0, ratio, 0, 0);
    ink.clearRect(0, 0, width, height);
    const style = getComputedStyle(canvas);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    ink.font = `12px ${style.fontFamily}`;
    ink.lineJoin = ink.lineCap = "round";
    this.fit(width, height);
    if (this.space && !this.camera) this.space.isShown = false;
    if (!scene) {
      ink.fillStyle = colour("--faint");
      ink.textAlign = "center";
      ink.fillText(this.hint, width / 2, height / 2);
      ink.textAlign = "left";
      return;
    }
    if (this.camera) this.inSpace(this.camera, ink, scene, colour);
    else this.axes(ink, width, height, colour);
    if (scene.ghost?.length)
      this.line(ink, scene.ghost, 0, scene.ghost.length / scene.layout.axes.length, colour("--ghost"), [7, 5]);
    if (scene.beside) {
      for (const [, first, count] of this.camera ? [] : scene.beside.layout.nodes)
        this.line(ink, scene.beside.frame.position, first, count, colour("--beside"), [], 2);
      this.marks(ink, scene.beside.frame, colour("--beside"));
    }
    if (!this.camera) this.links(ink, scene, colour);
    this.supports(ink, scene, colour);
    this.marks(ink, scene.frame, colour("--load"));
    if (this.choices.arrows) this.forces(ink, scene, colour);
    this.alerts(ink, scene, colour);
    this.key(ink, width, colour);
  }

  private inSpace(camera: Space, ink: CanvasRenderingContext2D, scene: Scene, colour: (name: string) => string): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const k = this.choices.exaggeration;
    const rest = scene.rest?.position;
    const larger = (p: Float32Array) => (rest && k !== 1 ? p.map((value, i) => rest[i] + k * (value - rest[i])) : p);
    const { layout, frame, beside } = scene;
    camera.draw(
      {
        layout,
        frame,
        position: larger(frame.position),
        tension: this.view.tension,
        floor: this.view.z[0],
        beside: beside && { layout: beside.layout, position: beside.frame.position },
      },
      width,
      height,
      colour,
    );
    const { ways, floor } = camera.axes();
    const [x, y] = [52, height - 46];
    for (const [name, right, up] of ways) {
      const size = Math.hypot(right, up);
      if (size < 0.1) continue;
      this.arrow(ink, [x, y], [right / size, -up / size], 32 * size, colour("--faint"));
      ink.textAlign = "center";
      ink.fillText(name, x + 42 * right, y - 42 * up + 4);
    }
    ink.textAlign = "left";
    ink.fillText(floor, 110, height - 16);
  }

  private alerts(
    ink: CanvasRenderingContext2D,
    { layout, frame, rest }: Scene,
    colour: (name: string) => string,
  ): void {
    const isNamed = (kind: string, name: string) =>
      this.doubted.some((key) => `${key}.`.startsWith(`${kind}.${name}.`) || `${kind}.${name}.`.startsWith(`${key}.`));
    const places: [number, number][] = [];
    const loadsAtRest = this.restOf(frame, frame.contact_position);
    layout.loads.forEach((name, k) => {
      if (isNamed("loads", name)) places.push(this.at(frame.contact_position, k, loadsAtRest));
    });
    for (const [name, first, count] of layout.nodes)
      if (isNamed("lines", name)) places.push(this.at(frame.position, first + (count >> 1), rest?.position));
    ink.textAlign = "center";
    for (const [x, z] of places) {
      if (Number.isNaN(x)) continue;
      ink.beginPath();
      ink.arc(x, z - 20, 9, 0, 2 * Math.PI);
      ink.fillStyle = colour("--bad");
      ink.fill();
      ink.fillStyle = colour("--panel");
      ink.fillText("!", x, z - 16);
    }
    ink.textAlign = "left";
  }

  private line(
    ink: CanvasRenderingContext2D,
    p: Float32Array,
    first: number,
    count: number,
    stroke: string,
    dash: number[],
    wide = 1.5,
  ): void {
    ink.beginPath();
    for (let i = first; i < first + count; i++) ink.lineTo(...this.at(p, i));
    ink.strokeStyle = stroke;
    ink.lineWidth = wide;
    ink.setLineDash(dash);
    ink.stroke();
    ink.setLineDash([]);
  }

  private links(ink: CanvasRenderingContext2D, scene: Scene, colour: (name: string) => string): void {
    const { layout, frame } = scene;
    const rest = scene.rest?.position;
    const names = steps(colour("--dark") === "1");
    const [low, high] = this.view.tension;
    if (layout.cells.length) {
      ink.strokeStyle = colour("--faint");
      ink.lineWidth = 0.5;
      ink.beginPath();
      for (const [a, b, c] of layout.cells) {
        ink.moveTo(...this.at(frame.position, a, rest));
        for (const i of [b, c, a]) ink.lineTo(...this.at(frame.position, i, rest));
      }
      ink.stroke();
    }
    ink.lineWidth = 3.5;
    for (const [name, first, count] of layout.nodes) {
      const link = layout.links.find(([line]) => line === name);
      if (!link || link[2] !== count - 1) continue;
      let step = -1;
      for (let i = 0; i < count - 1; i++) {
        const now = stepOf(frame.tension[link[1] + i], low, high);
        if (now !== step) {
          if (step >= 0) ink.stroke();
          ink.beginPath();
          ink.moveTo(...this.at(frame.position, first + i, rest));
          ink.strokeStyle = names[now];
          step = now;
        }
        ink.lineTo(...this.at(frame.position, first + i + 1, rest));
      }
      ink.stroke();
    }
  }

  /** Where the supports are that ends of lines have: their names, and their nodes. */
  supportNodes(): [string, number, number][] {
    const { layout } = this.scene ?? {};
    if (!layout) return [];
    return layout.supports.flatMap((name, k): [string, number, number][] => {
      const [line, end] = [name.slice(0, name.lastIndexOf(".")), name.slice(name.lastIndexOf(".") + 1)];
      const own = layout.nodes.find(([n]) => n === line);
      if (!own || (end !== "start" && end !== "end")) return [];
      return [[name, end === "start" ? own[1] : own[1] + own[2] - 1, k]];
    });
  }

  pixel(node: number): [number, number] {
    return this.scene ? this.at(this.scene.frame.position, node) : [0, 0];
  }

  private supports(ink: CanvasRenderingContext2D, scene: Scene, colour: (name: string) => string): void {
    for (const [, node] of this.supportNodes()) {
      const [x, z] = this.at(scene.frame.position, node, scene.rest?.position);
      ink.beginPath();
      ink.moveTo(x, z);
      ink.lineTo(x - 8, z + 14);
      ink.lineTo(x + 8, z + 14);
      ink.closePath();
      ink.fillStyle = colour("--panel");
      ink.fill();
      ink.strokeStyle = colour("--ink");
      ink.lineWidth = 1.5;
      ink.stroke();
    }
  }

  private marks(ink: CanvasRenderingContext2D, frame: Frame, fill: string): void {
    const axes = this.scene?.layout.axes.length ?? 2;
    ink.fillStyle = fill;
    for (const places of [frame.body_position, frame.contact_position]) {
      const rest = places && this.restOf(frame, places);
      for (let k = 0; places && k < places.length / axes; k++) {
        const [x, z] = this.at(places, k, rest);
        if (Number.isNaN(x)) continue;
        ink.beginPath();
        ink.arc(x, z, places === frame.contact_position ? 6.5 : 4, 0, 2 * Math.PI);
        ink.fill();
      }
    }
  }

  private forces(ink: CanvasRenderingContext2D, scene: Scene, colour: (name: string) => string): void {
    const { frame, layout } = scene;
    const axes = layout.axes.length;
    const rest = scene.rest?.position;
    const own = axes === 2 ? [0, 1] : [0, 2];
    const longest = 70 / (this.view.force || 1);
    const one = (at: [number, number], force: number[], name: string, stroke: string) => {
      const size = Math.hypot(...force);
      if (!(size > 0) || Number.isNaN(at[0])) return;
      const seen = this.camera?.axes().ways;
      const [right, up] = [1, 2].map((a) =>
        seen ? force.reduce((sum, f, k) => sum + f * (seen[k][a] as number), 0) : force[own[a - 1]],
      );
      const flat = Math.hypot(right, up) || 1;
      const way = [right / flat, -up / flat];
      const along = seen ? flat / size : 1; // what of it is not along the line of sight
      const length = Math.max(along * Math.min(Math.max(size * longest, 14), 100), 14);
      if (along > 0.2) this.arrow(ink, at, [way[0], way[1]], length, stroke);
      else this.ring(ink, at, stroke);
      ink.fillStyle = stroke;
      ink.textAlign = way[0] < -0.3 ? "right" : way[0] > 0.3 ? "left" : "center";
      const [x, z] = [at[0] + way[0] * (length + 8), at[1] + way[1] * (length + 8)];
      const wide = ink.measureText(`${name}${written(size, "N")}`).width;
      const inside = way[0] < -0.3 ? Math.max(x, wide + 4) : Math.min(x, this.canvas.clientWidth - wide - 4);
      ink.fillText(`${name}${written(size, "N")}`, inside, z + (way[1] > 0.3 ? 10 : name ? -12 : 0));
      ink.textAlign = "left";
    };
    const vector = (values: Float32Array | undefined, k: number) =>
      values ? Array.from(values.subarray(k * axes, (k + 1) * axes)) : [];
    const loadsAtRest = this.restOf(frame, frame.contact_position);
    layout.loads.forEach((_, k) => {
      if (layout.loads.length > 12) return;
      const at = this.at(frame.contact_position, k, loadsAtRest);
      const [force, hold] = [vector(frame.contact_force, k), vector(frame.hold_force, k)];
      one(
        at,
        force.map((f, a) => f - (hold[a] || 0)),
        "",
        colour("--load"),
      );
      one(at, hold, "hold ", colour("--hold"));
    });
    if (layout.supports.length > 12) return;
    for (const [, node, k] of this.supportNodes())
      one(this.at(frame.position, node, rest), vector(frame.reaction, k), "", colour("--faint"));
  }

  /** A force that points at who looks, or away. */
  private ring(ink: CanvasRenderingContext2D, [x, z]: [number, number], stroke: string): void {
    ink.strokeStyle = stroke;
    ink.lineWidth = 2;
    ink.beginPath();
    ink.arc(x, z, 11, 0, 2 * Math.PI);
    ink.stroke();
  }

  private arrow(
    ink: CanvasRenderingContext2D,
    [x, z]: [number, number],
    [a, b]: [number, number],
    length: number,
    stroke: string,
  ): void {
    const [ex, ez] = [x + a * length, z + b * length];
    ink.strokeStyle = ink.fillStyle = stroke;
    ink.lineWidth = 2;
    ink.beginPath();
    ink.moveTo(x, z);
    ink.lineTo(ex - 6 * a, ez - 6 * b);
    ink.stroke();
    ink.beginPath();
    ink.moveTo(ex, ez);
    ink.lineTo(ex - 10 * a - 5 * b, ez - 10 * b + 5 * a);
    ink.lineTo(ex - 10 * a + 5 * b, ez - 10 * b - 5 * a);
    ink.fill();
  }

  private axes(ink: CanvasRenderingContext2D, width: number, height: number, colour: (name: string) => string): void {
    if (this.scene?.layout.axes.length === 3) return;
    const [x0, z0] = this.place(42, height - MARGIN.bottom + 12);
    const [x1, z1] = this.place(width - 46, 54);
    ink.strokeStyle = colour("--grid");
    ink.fillStyle = colour("--faint");
    ink.lineWidth = 1;
    const [sx, ox, sz, oz] = this.scale;
    ink.textAlign = "center";
    for (const x of ticks(x0, x1, 9)) {
      const px = ox + sx * x;
      ink.beginPath();
      ink.moveTo(px, 50);
      ink.lineTo(px, height - MARGIN.bottom + 12);
      ink.stroke();
      ink.fillText(`${+x.toPrecision(6)}`.replace("-", "−"), px, height - MARGIN.bottom + 27);
    }
    ink.textAlign = "right";
    for (const z of ticks(z0, z1, 5)) {
      const pz = oz + sz * z;
      ink.beginPath();
      ink.moveTo(42, pz);
      ink.lineTo(width - 12, pz);
      ink.stroke();
      ink.fillText(`${+z.toPrecision(6)}`.replace("-", "−"), 37, pz + 4);
    }
    ink.textAlign = "left";
    ink.fillText("z (m)", 8, 44);
    ink.fillText("x (m)", width - 36, height - MARGIN.bottom + 27);
  }

  private key(ink: CanvasRenderingContext2D, width: number, colour: (name: string) => string): void {
    const names = steps(colour("--dark") === "1");
    const [low, high] = this.view.tension;
    const unit = this.scene ? tensionsOf(this.scene.layout, this.scene.frame).unit : "N";
    const [w, right] = [unit === "N" ? 150 : 190, width - 26];
    for (let k = 0; k < w; k++) {
      ink.fillStyle = names[Math.floor((k / w) * names.length)];
      ink.fillRect(right - w + k, 22, 1.5, 8);
    }
    ink.fillStyle = colour("--ink");
    ink.textAlign = "left";
    const digits = written(low, unit) === written(high, unit) ? 5 : 3; // of a taut string tensions hardly differ
    ink.fillText(written(low, unit, digits), right - w, 16);
    ink.textAlign = "right";
    ink.fillText(written(high, unit, digits), right, 16);
    ink.fillText("tension", right - w - 8, 30);
    ink.textAlign = "left";
    if (this.scene?.ghost?.length) {
      ink.setLineDash([7, 5]);
      ink.strokeStyle = colour("--ghost");
      ink.lineWidth = 1.5;
      ink.beginPath();
      ink.moveTo(70, 20);
      ink.lineTo(104, 20);
      ink.stroke();
      ink.setLineDash([]);
      ink.fillText("linear theory", 110, 24);
    }
  }
}
