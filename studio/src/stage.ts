import { Camera } from "./camera";
import { bar, stepOf, steps } from "./colours";
import { diagram } from "./diagrams";
import { coloursOf } from "./dom";
import type { Film, Frame, Layout } from "./film";
import { type Picture, type State, valuesAlong } from "./picture";
import { arrow, BEHIND, dot, label, line, type Pen, type Spot, type Surface, symbol, triangle } from "./symbols";
import { ends, short, ticks, written } from "./units";

interface Drawn {
  layout: Layout;
  frame: Frame;
  picture: Picture;
  reference: Float32Array; // m, positions without displacement
}

export interface Scene extends Drawn {
  state: State;
  ghost?: Float32Array;
  beside?: Drawn; // another run, drawn faintly
  orbits?: boolean; // in space, by a camera that goes around it
  film?: Film; // of the frame, whose largest values diagrams show
}

type Range = [number, number];
export interface View {
  x: Range;
  z: Range;
  force: number; // N, the longest arrow
}

const MARGIN = { side: 80, top: 76, bottom: 40 };
const EDGE = { left: 48, right: 24 }; // of axes and diagrams
const ROW = [64, 118]; // pixels, least and most height of a diagram
const LABELLED = 12; // most forces that are drawn

/** Draws a structure with its loads on a canvas, as the description of its frame has it. */
export class Stage {
  /** What is written where nothing is shown. */
  hint = "";
  /** Keys of the scenario that doubts name: their loads and lines are marked. */
  doubted: string[] = [];
  /** How many times as large displacements are drawn, where the description is not to decide. */
  exaggeration = 0;
  private scene?: Scene;
  private view: View = { x: [0, 1], z: [-1, 1], force: 1 };
  private scale: [number, number, number, number] = [1, 0, 1, 0];
  private due = false;
  private pen!: Pen;

  private closing = new AbortController();
  private orbit?: Camera;

  constructor(readonly canvas: HTMLCanvasElement) {
    new ResizeObserver(() => this.draw()).observe(canvas);
    const { signal } = this.closing;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw(), { signal });
  }

  /** Let go of what outlives the canvas. */
  close(): void {
    this.closing.abort();
    this.show(undefined);
  }

  show(scene: Scene | undefined, view?: View): void {
    this.scene = scene;
    if (view) this.view = view;
    this.draw();
  }

  /** The camera, where one goes around. */
  private get camera(): Camera | undefined {
    if (!this.scene?.orbits || this.scene.layout.axes.length < 3 || this.scene.picture.around) return undefined;
    this.orbit ??= new Camera(this.canvas, () => this.draw(), this.closing.signal);
    return this.orbit;
  }

  draw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.paint();
    });
  }

  // -- Places -----------------------------------------------------------------------------------------------------

  /** Where a place on the canvas is, in m. */
  place(px: number, py: number): [number, number] {
    const [sx, ox, sz, oz] = this.scale;
    return [(px - ox) / sx, (py - oz) / sz];
  }

  /** How many times as large displacements are drawn. */
  get factor(): number {
    return this.exaggeration || this.scene?.state.factor || 1;
  }

  /** Where a point is in the picture, in pixels. */
  private point = (at: ArrayLike<number>): Spot => {
    if (this.camera) return this.camera.pixel(at);
    const [sx, ox, sz, oz] = this.scale;
    return [ox + sx * at[0], oz + sz * at[at.length - 1]];
  };

  /** Where point `i` of some positions is drawn, displaced from a reference. */
  private at(position: Float32Array | undefined, i: number, reference?: Float32Array): Spot {
    const axes = this.scene?.layout.axes.length ?? 2;
    if (!position || i < 0) return [Number.NaN, Number.NaN];
    const at = position.subarray(axes * i, axes * (i + 1));
    if (!reference || this.factor === 1) return this.point(at);
    return this.point(at.map((value, a) => reference[axes * i + a] + this.factor * (value - reference[axes * i + a])));
  }

  /** What symbols of a frame are drawn on. */
  private surface({ frame, reference, layout }: Drawn, pen: Pen): Surface {
    const isOff = (k: number) => frame.wheel_position && Number.isNaN(frame.contact_position[k * layout.axes.length]);
    const contact = (k: number) => this.at(frame.contact_position, k, frame.contact_reference);
    return {
      ...pen,
      contact,
      wheel: (k) => (isOff(k) ? this.at(frame.wheel_position, k) : contact(k)),
      body: (i) => this.at(frame.body_position, i, frame.body_reference),
      node: (i) => this.at(frame.position, i, reference),
      point: this.point,
      metre: this.camera ? 12 : this.scale[0],
    };
  }

  /** Heights of the diagrams below the lines, in pixels. */
  private rows(height: number): number[] {
    const shown = this.scene?.picture.diagrams.filter(({ name }) => this.scene?.state.ranges[name]) ?? [];
    return shown.map(() => Math.min(Math.max((0.5 * height) / shown.length, ROW[0]), ROW[1]));
  }

  private fit(width: number, height: number): void {
    const { x, z } = this.view;
    const tall = this.scene?.state.height_factor ?? 1;
    const [low, high] = this.window(x);
    const side = Math.min(MARGIN.side, width / 8);
    const wide = width - 2 * side;
    const free = Math.max(height - MARGIN.top - MARGIN.bottom - sum(this.rows(height)), 20);
    const s = Math.min(wide / Math.max(high - low, 1e-9), free / Math.max(z[1] - z[0], 1e-9) / tall);
    const ox = side + (wide - s * (high - low)) / 2 - s * low;
    this.scale = [s, ox, -s * tall, MARGIN.top + free / 2 + (s * tall * (z[0] + z[1])) / 2];
  }

  /** What of the lines is seen: all, or what is around the contacts. */
  private window([low, high]: Range): Range {
    const { picture, frame, layout } = this.scene ?? {};
    if (!picture?.around || !frame || !layout) return [low, high];
    const places = Array.from(frame.contact_position ?? []).filter((_, i) => i % layout.axes.length === 0);
    const [first, last] = places.some(Number.isFinite) ? ends(places) : [low, low];
    const wide = Math.min(last - first + 2 * picture.around, high - low);
    const left = Math.min(Math.max((first + last - wide) / 2, low), high - wide);
    return [left, left + wide];
  }

  // -- Drawing ----------------------------------------------------------------------------------------------------

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
    const { fontSize, fontFamily } = getComputedStyle(canvas);
    const colour = coloursOf(canvas);
    this.pen = { ink, colour };
    ink.font = `${fontSize} ${fontFamily}`;
    ink.lineJoin = ink.lineCap = "round";
    this.fit(width, height);
    if (this.orbit && !this.camera) this.orbit.isShown = false;
    if (!scene) {
      ink.fillStyle = colour("--faint");
      ink.textAlign = "center";
      ink.fillText(this.hint, width / 2, height / 2);
      ink.textAlign = "left";
      return;
    }
    if (this.camera) this.inSpace(this.camera, scene, width, height);
    else this.axes(scene, width, height);
    ink.save();
    if (scene.picture.around && !this.camera) {
      ink.beginPath();
      ink.rect(EDGE.left, 0, width - EDGE.left - EDGE.right, height);
      ink.clip();
    }
    const { ghost, layout, beside } = scene;
    if (ghost?.length) this.line(ghost, 0, ghost.length / layout.axes.length, colour("--ghost"), [7, 5]);
    if (beside) {
      this.cells(beside, colour("--beside"));
      for (const [, first, count] of linesOf(beside.layout))
        this.line(beside.frame.position, first, count, colour("--beside"), [], 3, beside.reference);
      this.symbols(beside, { ink, colour: () => colour("--beside") });
    }
    this.symbols(scene, this.pen, true);
    this.symbols(scene, this.pen);
    this.links(scene);
    for (const [, node] of this.supportNodes())
      triangle(this.pen, this.at(scene.frame.position, node, scene.reference));
    this.forces(scene);
    this.alerts(scene);
    ink.restore();
    this.diagrams(scene, width, height);
    this.key(scene, width);
  }

  private symbols(drawn: Drawn, pen: Pen, behind = false): void {
    const surface = this.surface(drawn, pen);
    for (const mark of drawn.picture.symbols) if (BEHIND.includes(mark.kind) === behind) symbol(surface, mark);
  }

  private diagrams({ picture, state, reference, layout, film, frame }: Scene, width: number, height: number): void {
    const [left, right] = [EDGE.left, width - EDGE.right];
    const along = (node: number) => {
      const own = layout.nodes.find(([, first, count]) => node >= first && node < first + count) ?? ["", 0, 1];
      return left + ((node - own[1]) / Math.max(own[2] - 1, 1)) * (right - left);
    };
    const across = this.camera ? along : (node: number) => this.at(reference, node)[0];
    const rows = this.rows(height);
    let top = height - MARGIN.bottom + 10 - sum(rows);
    for (const quantity of picture.diagrams) {
      const shown = state.ranges[quantity.name];
      if (!shown) continue;
      const place = { left, right, top, height: rows[0] };
      diagram(this.pen, place, quantity, shown, { layout, frame, envelope: film?.envelope(quantity.name), across });
      top += rows[0];
    }
  }

  /** The floor, and where the axes point to. */
  private inSpace(camera: Camera, { layout, frame }: Scene, width: number, height: number): void {
    const { ink, colour } = this.pen;
    const low = sum(this.rows(height)); // of the diagrams below
    camera.begin(layout, frame.position, width, height - low);
    const floor = camera.floor(this.pen, this.view.z[0]);
    const [x, y] = [52, height - low - 46];
    ink.fillStyle = colour("--faint");
    for (const [k, name] of ["x", "y", "z"].entries()) {
      const [right, up] = camera.seen([0, 1, 2].map((a) => +(a === k)));
      const size = Math.hypot(right, up);
      if (size < 0.1) continue;
      arrow(ink, [x, y], [right / size, -up / size], 32 * size, colour("--faint"));
      ink.textAlign = "center";
      ink.fillText(name, x + 42 * right, y - 42 * up + 4);
    }
    ink.textAlign = "left";
    ink.fillText(floor, 110, height - low - 16);
  }

  private alerts({ layout, frame, reference }: Scene): void {
    const { ink, colour } = this.pen;
    const isNamed = (kind: string, name: string) =>
      this.doubted.some((key) => `${key}.`.startsWith(`${kind}.${name}.`) || `${kind}.${name}.`.startsWith(`${key}.`));
    const places: Spot[] = [];
    layout.loads.forEach((name, k) => {
      if (isNamed("loads", name)) places.push(this.at(frame.contact_position, k, frame.contact_reference));
    });
    for (const [name, first, count] of layout.nodes)
      if (isNamed("lines", name)) places.push(this.at(frame.position, first + (count >> 1), reference));
    ink.textAlign = "center";
    for (const [x, z] of places) {
      ink.fillStyle = colour("--bad");
      dot(ink, [x, z - 20], 9); // nowhere, if there is no such place
      ink.fillStyle = colour("--panel");
      ink.fillText("!", x, z - 16);
    }
    ink.textAlign = "left";
  }

  private line(
    p: Float32Array,
    first: number,
    count: number,
    stroke: string,
    dash: number[],
    wide = 1.5,
    reference?: Float32Array,
  ): void {
    const { ink } = this.pen;
    ink.strokeStyle = stroke;
    ink.lineWidth = wide;
    ink.setLineDash(dash);
    line(ink, ...Array.from({ length: count }, (_, i) => this.at(p, first + i, reference)));
    ink.setLineDash([]);
  }

  /** Triangles of nets and membranes: their edges, filled where they have colours. */
  private cells({ layout, frame, reference }: Drawn, stroke: string, tint?: (k: number) => string): void {
    const { ink } = this.pen;
    ink.strokeStyle = stroke;
    ink.lineWidth = 0.5;
    for (const [k, cell] of layout.cells.entries()) {
      ink.beginPath();
      for (const i of cell) ink.lineTo(...this.at(frame.position, i, reference));
      ink.closePath();
      ink.globalAlpha = 0.72;
      if (tint) ink.fillStyle = tint(k);
      if (tint) ink.fill();
      ink.globalAlpha = 1;
      ink.stroke();
    }
  }

  private links(scene: Scene): void {
    const { layout, frame, reference, picture, state } = scene;
    const { ink, colour } = this.pen;
    const names = steps(colour);
    const shown = picture.colour && state.ranges[picture.colour.name];
    const tint = (value: number) =>
      shown && Number.isFinite(value) ? names[stepOf(value / shown.size, shown.low, shown.high)] : colour("--faint");
    const values = picture.colour?.of === "cell" && shown ? frame[picture.colour.name] : undefined;
    this.cells(scene, colour("--faint"), values && ((k) => tint(values[k])));
    ink.lineWidth = 3.5;
    for (const [name, first, count] of linesOf(layout)) {
      const value = valuesAlong(shown ? picture.colour : null, frame, layout, name);
      let last = "";
      for (let i = 0; i < count - 1; i++) {
        const now = tint(value(i));
        if (now !== last) {
          if (last) ink.stroke();
          ink.beginPath();
          ink.moveTo(...this.at(frame.position, first + i, reference));
          ink.strokeStyle = last = now;
        }
        ink.lineTo(...this.at(frame.position, first + i + 1, reference));
      }
      ink.stroke();
    }
  }

  /** Where the supports are that ends of lines have: their names, and their nodes. */
  supportNodes(): [string, number, number][] {
    const { nodes = [], supports = [] } = this.scene?.layout ?? {};
    return nodes.flatMap(([line, first, count]) =>
      supports.flatMap((name, k): [string, number, number][] =>
        name === `${line}.start` ? [[name, first, k]] : name === `${line}.end` ? [[name, first + count - 1, k]] : [],
      ),
    );
  }

  pixel(node: number): Spot {
    return this.scene ? this.at(this.scene.frame.position, node, this.scene.reference) : [0, 0];
  }

  /** Forces on lines: of each load as a whole, and of supports, those at one place together. */
  private forces({ frame, layout, reference, picture }: Scene): void {
    const { colour } = this.pen;
    const axes = layout.axes.length;
    const sumOf = (values: Float32Array | undefined, which: number[]) =>
      Array.from({ length: axes }, (_, a) => sum(which.map((k) => values?.[k * axes + a] || 0)));
    for (const { contacts = [] } of layout.loads.length > LABELLED ? [] : picture.symbols) {
      const spots = contacts.map((k) => this.at(frame.contact_position, k, frame.contact_reference));
      const there = spots.filter(([x]) => Number.isFinite(x));
      const at = [0, 1].map((a) => sum(there.map((spot) => spot[a])) / there.length) as Spot;
      const [force, hold] = [sumOf(frame.contact_force, contacts), sumOf(frame.hold_force, contacts)];
      const own = force.map((f, a) => f - hold[a]);
      this.force(at, own, "", colour("--load"));
      this.force(at, hold, "hold ", colour("--hold"));
    }
    if (layout.supports.length > LABELLED) return;
    const grouped = new Map<string, { at: Spot; which: number[] }>();
    for (const [, node, k] of this.supportNodes()) {
      const at = this.at(frame.position, node, reference);
      const group = grouped.get(at.map(Math.round).join()) ?? { at, which: [] };
      group.which.push(k);
      grouped.set(at.map(Math.round).join(), group);
    }
    for (const { at, which } of grouped.values()) this.force(at, sumOf(frame.reaction, which), "", colour("--faint"));
  }

  private force(at: Spot, force: number[], name: string, stroke: string): void {
    const { ink } = this.pen;
    const size = Math.hypot(...force);
    if (!(size > 0) || Number.isNaN(at[0])) return;
    const seen = this.camera?.seen(force);
    const [right, up] = seen ?? [force[0], force[force.length - 1]];
    const flat = Math.hypot(right, up) || 1;
    const way: Spot = [right / flat, -up / flat];
    const along = seen ? flat / size : 1; // what of it is not along the line of sight
    const length = Math.max(along * Math.min(Math.max((size * 50) / (this.view.force || 1), 14), 60), 14);
    if (along > 0.2) arrow(ink, at, way, length, stroke);
    else {
      ink.fillStyle = stroke; // it points at who looks, or away
      dot(ink, at, 5);
    }
    const text = `${name}${written(size, "N")}`;
    const wide = ink.measureText(text).width;
    const part = way[0] < -0.3 ? 1 : way[0] > 0.3 ? 0 : 0.5; // of the text, before the end of the arrow
    const [x, z] = [at[0] + way[0] * (length + 8) - part * wide, at[1] + way[1] * (length + 8)];
    const inside = Math.max(Math.min(x, this.canvas.clientWidth - wide - 4), EDGE.left); // right of the axis numbers
    const aside = name || inside !== x ? -12 : 0; // where it would stand on its arrow
    const below = Math.max(z + (way[1] > 0.3 ? 10 : aside), 60); // the title
    label(this.pen, text, [inside, below], stroke);
  }

  /** Level axis of places; upright axis of places, or of displacements where these are exaggerated. */
  private axes(scene: Scene, width: number, height: number): void {
    const { ink, colour } = this.pen;
    const low = height - MARGIN.bottom + 12;
    const rows = this.rows(height);
    const [x0, z0] = this.place(EDGE.left, low - sum(rows) - (rows.length ? 14 : 0)); // above the title of a diagram
    const [x1, z1] = this.place(width - EDGE.right, 54);
    ink.strokeStyle = colour("--grid");
    ink.fillStyle = colour("--faint");
    ink.lineWidth = 1;
    const [sx, ox, sz, oz] = this.scale;
    const mark = (value: number, at: [number, number, number, number], x: number, z: number) => {
      line(ink, [at[0], at[1]], [at[2], at[3]]);
      ink.fillText(short(value), x, z);
    };
    ink.textAlign = "center";
    for (const x of ticks(x0, x1, 9).filter((x) => ox + sx * x < width - 50))
      mark(x, [ox + sx * x, 50, ox + sx * x, low], ox + sx * x, low + 15);
    ink.textAlign = "right";
    const { title, level, size } = this.upright(scene);
    for (const value of ticks(...ends([(z0 - level) / size, (z1 - level) / size]), 5)) {
      const pz = oz + sz * (level + size * value);
      mark(value, [EDGE.left, pz, width - EDGE.right, pz], EDGE.left - 5, pz + 4);
    }
    ink.textAlign = "left";
    ink.fillText(title, 8, 44);
    ink.fillText("x (m)", width - 36, low + 15);
  }

  /** What the upright axis shows: its title, the height of zero in m, and the size of its unit as drawn, in m. */
  private upright({ picture, state, reference, layout }: Scene): { title: string; level: number; size: number } {
    const { colour } = picture;
    const shown = colour?.unit === "m" ? state.ranges[colour.name] : undefined;
    if (this.factor === 1 || state.height_factor !== 1 || !colour || !shown)
      return { title: "z (m)", level: 0, size: 1 };
    const first = layout.nodes.find(([name]) => !colour.lines.length || colour.lines.includes(name))?.[1] ?? 0;
    const level = reference[layout.axes.length * (first + 1) - 1];
    const size = this.factor * shown.size * (colour.down ? -1 : 1);
    return { title: `${colour.label} (${shown.unit})`, level, size };
  }

  /** The factors, the linear theory, and the bar of colours. */
  private key({ picture, state, ghost }: Scene, width: number): void {
    const { ink, colour } = this.pen;
    const quantity = picture.colour;
    const shown = quantity && state.ranges[quantity.name];
    ink.fillStyle = colour("--ink");
    const factors = [[quantity?.unit === "m" ? quantity.label : "displacement", this.factor]];
    if (!this.camera) factors.push(["heights", state.height_factor]);
    const plain = ink.font;
    ink.font = `bold ${plain}`;
    const larger = factors.filter(([, factor]) => factor !== 1).map((one) => one.join(" × "));
    ink.fillText(larger.join(", "), 8, 24);
    ink.font = plain;
    if (shown) bar(this.pen, quantity.label, shown, width);
    if (!ghost?.length) return;
    ink.setLineDash([7, 5]);
    ink.strokeStyle = colour("--ghost");
    ink.lineWidth = 1.5;
    line(ink, [170, 20], [204, 20]);
    ink.setLineDash([]);
    ink.fillText("linear theory", 210, 24);
  }
}

/** Lines of a layout, without nets, whose nodes are in no order. */
const linesOf = ({ nodes, links }: Layout) =>
  nodes.filter(([name, , count]) => links.some(([line, , many]) => line === name && many === count - 1));
const sum = (values: number[]) => values.reduce((a, b) => a + b, 0);
