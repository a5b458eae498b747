import { button, element } from "./dom";
import type { Layout } from "./film";
import type { Pen, Spot } from "./symbols";
import { ends, ticks, written } from "./units";

type Place = [number, number, number];

/** Where the camera can be put: the direction from what it looks at, and whether its rays are parallel. */
const VIEWS: Record<string, { title: string; direction: Place; isParallel: boolean }> = {
  Perspective: {
    title: "From aside; drag to turn, wheel to come nearer, right button to move (Shift + arrow keys, + and −)",
    direction: [0.55, -1, 0.5],
    isParallel: false,
  },
  Plan: { title: "From above, x to the right", direction: [0, -1e-6, 1], isParallel: true },
  Elevation: { title: "From the front, x to the right", direction: [0, -1, 0], isParallel: true },
  Side: { title: "Along x, y to the right", direction: [1, 0, 0], isParallel: true },
};
const HALF_ANGLE = (17.5 * Math.PI) / 180; // of the field of view, upwards
const STEP = Math.PI / 36; // by which a key turns
const TURNS: Record<string, [number, number]> = {
  ArrowLeft: [-STEP, 0],
  ArrowRight: [STEP, 0],
  ArrowUp: [0, -STEP],
  ArrowDown: [0, STEP],
};

/** A camera's place, seen from what it looks at, turned about the vertical and towards it, rad. */
export function turned([x, y, z]: Place, about: number, down: number): Place {
  const far = Math.hypot(x, y, z);
  const azimuth = Math.atan2(y, x) + about;
  const polar = Math.min(Math.max(Math.acos(z / far) + down, 1e-3), Math.PI - 1e-3);
  const flat = far * Math.sin(polar);
  return [flat * Math.cos(azimuth), flat * Math.sin(azimuth), far * Math.cos(polar)];
}

const dot = (a: ArrayLike<number>, b: Place) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** A camera that goes around lines and nets in space: by mouse, fingers and keys. */
export class Camera {
  private bar = element("div", { class: "row cameras", role: "group", "aria-label": "Camera" });
  private view = "Perspective";
  private target: Place = [0, 0, 0]; // what it looks at, m
  private offset: Place = [0, -1, 0]; // from there to the camera, m
  private right: Place = [1, 0, 0];
  private up: Place = [0, 0, 1];
  private radius = 1; // m, of all that is seen
  private spacing = 1; // m, of the lines of the floor
  private side = 1; // squares of the floor to each side
  private layout?: Layout;
  private size: [number, number] = [1, 1]; // pixels
  private held = new Map<number, Spot>(); // pointers

  constructor(
    private canvas: HTMLCanvasElement,
    private changed: () => void,
    signal: AbortSignal,
  ) {
    for (const [name, { title }] of Object.entries(VIEWS))
      this.bar.append(button(name, () => this.look(name), { title }));
    canvas.after(this.bar);
    signal.addEventListener("abort", () => this.bar.remove());
    canvas.addEventListener("keydown", (event) => this.key(event), { signal });
    canvas.addEventListener("pointerdown", (event) => this.hold(event), { signal });
    canvas.addEventListener("pointermove", (event) => this.drag(event), { signal });
    for (const ended of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(ended, ({ pointerId }) => this.held.delete(pointerId), { signal });
    canvas.addEventListener("contextmenu", (event) => this.isShown && event.preventDefault(), { signal });
    const wheel = (event: WheelEvent) => {
      if (!this.isShown) return;
      event.preventDefault();
      this.approach(0.95 ** ((event.deltaY * (event.deltaMode ? 33 : 1)) / 100)); // some browsers count lines
    };
    canvas.addEventListener("wheel", wheel, { passive: false, signal });
  }

  get isShown(): boolean {
    return !this.bar.hidden;
  }

  set isShown(shown: boolean) {
    this.bar.hidden = !shown;
    this.canvas.style.touchAction = shown ? "none" : "";
  }

  /** Look at positions (m, three for each node) in a picture of this size; another layout is looked at as a whole. */
  begin(layout: Layout, position: Float32Array, width: number, height: number): void {
    this.isShown = true;
    this.size = [width, height];
    if (this.layout === layout) return;
    this.layout = layout;
    const box = [0, 1, 2].map((a) => ends(position.filter((_, i) => i % 3 === a)));
    this.target = box.map(([low, high]) => (low + high) / 2) as Place;
    const [x, y, z] = box.map(([low, high]) => high - low);
    this.radius = Math.max(0.5 * Math.hypot(x, y, z), 1e-6) / Math.min(1, width / height);
    const side = 2.4 * Math.max(x, y);
    this.spacing = ticks(0, side, 12)[1] || 1;
    this.side = Math.ceil(side / this.spacing / 2);
    this.look("Perspective");
  }

  /** Look at all of it from one of the directions of `VIEWS`. */
  private look(name: string): void {
    this.view = name;
    const { direction, isParallel } = VIEWS[name];
    const away = this.radius * (isParallel ? 4 : 0.9 / Math.sin(HALF_ANGLE));
    this.turn(direction.map((part) => (away * part) / Math.hypot(...direction)) as Place);
    for (const one of this.bar.querySelectorAll("button"))
      one.setAttribute("aria-pressed", `${one.textContent === name}`);
  }

  private turn(offset: Place): void {
    const [x, y, z] = offset;
    const [flat, far] = [Math.hypot(x, y), Math.hypot(x, y, z)];
    this.offset = offset;
    this.right = [-y / flat, x / flat, 0];
    this.up = [(-x * z) / flat / far, (-y * z) / flat / far, flat / far];
    this.changed();
  }

  /** Come nearer by a factor. */
  private approach(factor: number): void {
    this.turn(this.offset.map((part) => part / factor) as Place);
  }

  private get isParallel(): boolean {
    return VIEWS[this.view].isParallel;
  }

  /** Pixels of 1 m, so far in front of the camera. */
  private scale(depth: number): number {
    const half = this.size[1] / 2;
    return this.isParallel ? (4 * half) / Math.hypot(...this.offset) : half / Math.tan(HALF_ANGLE) / depth;
  }

  /** Where a place in space is in the picture, in pixels; not a number behind the camera. */
  pixel(place: ArrayLike<number>): Spot {
    const from: Place = [place[0] - this.target[0], place[1] - this.target[1], place[2] - this.target[2]];
    const far = Math.hypot(...this.offset);
    const depth = far - dot(from, this.offset) / far;
    if (depth < 0.01 * this.radius && !this.isParallel) return [Number.NaN, Number.NaN];
    const scale = this.scale(depth);
    return [this.size[0] / 2 + scale * dot(from, this.right), this.size[1] / 2 - scale * dot(from, this.up)];
  }

  /** How far a vector points to the right and upwards in the picture. */
  seen(vector: ArrayLike<number>): [number, number] {
    return [dot(vector, this.right), dot(vector, this.up)];
  }

  /** Draw the squares of the floor at a height, m, and say how wide they are. */
  floor({ ink, colour }: Pen, height: number): string {
    const [x, y] = this.target.map((value) => Math.round(value / this.spacing));
    ink.beginPath();
    for (let k = -this.side; k <= this.side; k++)
      for (const isAcross of [false, true]) {
        let isDown = false; // a line begins and ends where the camera begins to see it
        for (let l = -this.side; l <= this.side; l++) {
          const [a, b] = isAcross ? [x + k, y + l] : [x + l, y + k];
          const spot = this.pixel([a * this.spacing, b * this.spacing, height]);
          if (isDown) ink.lineTo(...spot);
          else ink.moveTo(...spot);
          isDown = Number.isFinite(spot[0]);
        }
      }
    ink.strokeStyle = colour("--grid");
    ink.lineWidth = 1;
    ink.stroke();
    return `squares of ${written(this.spacing, "m")}`;
  }

  private hold(event: PointerEvent): void {
    if (!this.isShown) return;
    this.held.set(event.pointerId, [event.clientX, event.clientY]);
    this.canvas.setPointerCapture(event.pointerId);
  }

  /** One pointer turns; two, the right button or Shift move, and two come nearer by their distance. */
  private drag({ pointerId, clientX, clientY, buttons, shiftKey }: PointerEvent): void {
    const old = this.held.get(pointerId);
    if (!old) return;
    const [dx, dy] = [clientX - old[0], clientY - old[1]];
    this.held.set(pointerId, [clientX, clientY]);
    const other = [...this.held].find(([id]) => id !== pointerId)?.[1];
    if (!other && !this.isParallel && buttons !== 2 && !shiftKey) {
      const turn = (2 * Math.PI) / this.size[1];
      return this.turn(turned(this.offset, -turn * dx, -turn * dy));
    }
    const metre = this.scale(Math.hypot(...this.offset)) * (other ? 2 : 1); // of two pointers, each is one half
    this.target = this.target.map((value, a) => value - (dx * this.right[a] - dy * this.up[a]) / metre) as Place;
    const apart = ([x, y]: Spot) => (other ? Math.hypot(x - other[0], y - other[1]) : 1);
    this.approach(apart([clientX, clientY]) / Math.max(apart(old), 1));
  }

  private key(event: KeyboardEvent): void {
    if (!this.isShown) return;
    const turn = event.shiftKey && !this.isParallel ? TURNS[event.key] : undefined;
    const nearer = { "+": 1.1, "-": 1 / 1.1 }[event.key];
    if (turn) this.turn(turned(this.offset, ...turn));
    else if (nearer) this.approach(nearer);
    else return;
    event.preventDefault();
    event.stopPropagation(); // arrow keys alone step through time
  }
}
