import { button, element, pairs, select } from "./dom";
import type { Doubt } from "./doubts";
import type { Film, Frame, Layout } from "./film";
import { type Picture, type State, said } from "./picture";
import { Plots } from "./plots";
import { Stage, type View } from "./stage";
import { ends, written } from "./units";

const SPEEDS = [0.02, 0.1, 0.25, 0.5, 1, 2, 5].map((value) => [`${value}`, `${value} × speed`] as const);
const FACTORS = [0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].map(
  (value) => [`${value}`, `${value || "auto"} × displ.`] as const,
);

/** Plays the frames of a run: those that are there, while others come. */
export class Player {
  readonly bar: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly plotted = element("div", { class: "plots", tabindex: "0", role: "group", "aria-label": "Curves" });
  readonly numbers = element("dl", { class: "numbers", "aria-live": "off" });
  readonly stage: Stage;
  private plots = new Plots(this.plotted, (path) => this.go(path));
  film?: Film;
  beside?: Film; // the run that is drawn faintly
  private view?: View;
  private now = 0; // s of the run, or m of the load's path
  private speed = 1;
  private playing = false;
  private last = 0;
  private seen = -1;
  private hasMore = false;
  private play = button("▶", () => this.toggle(), {
    class: "icon",
    title: "Play or pause (space)",
    "aria-label": "Play",
  });
  private slider = element("input", {
    type: "range",
    min: "0",
    max: "1",
    step: "any",
    value: "0",
    "aria-label": "Time",
  });
  private doubts: Doubt[] = [];
  private placed = ""; // for which end and how many doubts the marks stand where they are
  private marks = element("span", { class: "marks" });
  private clock = element("output", { class: "clock" }, "0 s");
  private pace = select("Speed", SPEEDS, () => this.chosen(), { title: "Speed", value: "1" });
  private larger = select("Exaggeration", FACTORS, () => this.chosen(), { title: "Exaggeration of displacements" });

  /** `label`: of the picture, for those who do not see it. */
  constructor(label: string) {
    this.canvas = element("canvas", { tabindex: "0", role: "img", "aria-label": label });
    this.stage = new Stage(this.canvas);
    this.bar = element(
      "div",
      { class: "player", role: "group", "aria-label": "Film" },
      this.play,
      element("span", { class: "line" }, this.slider, this.marks),
      this.clock,
      this.pace,
      this.larger,
    );
    this.slider.oninput = () => this.stop(this.slider.valueAsNumber);
  }

  private chosen(): void {
    this.speed = Number(this.pace.value);
    this.stage.exaggeration = Number(this.larger.value);
    this.view = undefined;
    this.seen = -1;
    this.refresh();
  }

  /** Play at a speed that the list has, and let the picture choose the exaggeration. */
  choose(speed: number): void {
    this.pace.value = `${speed}`;
    this.larger.value = "0";
    this.chosen();
  }

  /** Show the numbers of a frame; `dragged`: its load beside a linear theory. */
  count(scene: Described, frame: Frame, dragged = ""): void {
    this.numbers.replaceChildren(...pairs(numbersOf(scene, frame, dragged)));
  }

  /** Draw anew, in other colours or sizes. */
  redraw(): void {
    this.plots.clear();
    this.refresh(); // at once: without curves the picture would be painted too high
    this.stage.draw();
  }

  /** Mark the instants of doubts on the slider. */
  mark(doubts: Doubt[]): void {
    this.doubts = doubts;
    this.seen = -1;
    this.refresh();
  }

  private place({ layout, end }: Film): void {
    const marks = this.doubts.flatMap(({ time, text }) => {
      if (layout.path !== "time" || time === null || time > end) return [];
      const about = { class: "alert", title: text, "aria-label": `Doubt at ${time} s` };
      const mark = button("!", () => this.stop(time), about);
      mark.style.left = `calc(8px + ${time / Math.max(end, 1e-9)} * (100% - 16px))`;
      return [mark];
    });
    this.marks.replaceChildren(...marks);
  }

  /** Stand still at an instant. */
  stop(path: number): void {
    this.playing = false;
    this.go(path);
  }

  /** Show another run, from its beginning. */
  load(film: Film, beside?: Film): void {
    this.film = film;
    this.beside = beside;
    this.view = undefined;
    this.now = 0;
    this.seen = -1;
    this.doubts = [];
    this.placed = "";
    this.plots.clear();
    this.playing = true;
    this.last = performance.now();
    requestAnimationFrame(this.tick);
  }

  leave(): void {
    this.film = undefined;
    this.playing = false;
    this.plots.clear();
    this.play.textContent = "▶";
  }

  toggle(): void {
    if (!this.film) return;
    if (!this.playing && this.now >= this.film.end - 1e-9) this.now = 0;
    this.playing = !this.playing;
    this.last = performance.now();
    this.seen = -1;
    requestAnimationFrame(this.tick);
  }

  go(path: number): void {
    if (!this.film) return;
    this.now = Math.max(0, Math.min(path, this.film.end));
    this.refresh();
  }

  step(by: number): void {
    if (!this.film) return;
    this.playing = false;
    const i = Math.max(0, Math.min(this.film.count - 1, this.film.at(this.now) + by));
    this.go(this.film.path[i]);
  }

  /** Play by space, step by arrow keys; false if the key means nothing. */
  press(key: string): boolean {
    if (key === " ") this.toggle();
    else if (key === "ArrowRight") this.step(1);
    else if (key === "ArrowLeft") this.step(-1);
    else return false;
    return true;
  }

  /** Show frames that have come, with the next picture: many messages may come before it. */
  more(): void {
    if (this.hasMore) return;
    this.hasMore = true;
    requestAnimationFrame(() => {
      this.hasMore = false;
      this.view = undefined;
      this.refresh();
    });
  }

  private tick = (clock: number): void => {
    const film = this.film;
    if (!film) return;
    if (this.playing) {
      const rate = film.layout.path === "time" ? this.speed : this.speed * 0.2 * Math.max(film.end, 1e-9);
      this.now += (rate * Math.min(clock - this.last, 100)) / 1000;
      this.last = clock;
      if (this.now >= film.end) {
        this.now = film.end;
        this.playing = film.count < film.total && !this.isOver;
      }
      requestAnimationFrame(this.tick);
    }
    this.refresh();
  };

  /** Whether no frames will come any more. */
  isOver = false;

  private refresh(): void {
    const film = this.film;
    if (!film?.count) return;
    this.play.textContent = this.playing ? "❚❚" : "▶";
    this.play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    this.slider.max = `${film.end}`;
    this.slider.valueAsNumber = this.now;
    const placed = `${film.end} ${this.doubts.length}`;
    if (placed !== this.placed) {
      this.placed = placed;
      this.place(film);
    }
    const unit = film.layout.path === "time" ? "s" : "m";
    this.clock.value = `${this.now.toFixed(3)} ${unit}`;
    const i = film.at(this.now);
    const key = i + 1e7 * film.version;
    if (key !== this.seen) {
      this.seen = key;
      this.view ??= viewOf(film, this.stage.exaggeration || film.state.factor, this.beside);
      const frame = film.frame(i);
      const { beside: other } = this;
      const beside = other?.count ? { ...other, frame: other.frame(other.at(this.now)) } : undefined;
      const { layout, picture, state, reference } = film;
      this.stage.show({ layout, frame, picture, state, reference, film, beside, orbits: true }, this.view);
      this.count(film, frame);
    }
    this.plots.update(film, this.beside);
    this.plots.cursor(this.now);
  }
}

/** What is to be in view all the time, displacements being so much larger. */
export function viewOf(film: Film, factor: number, beside?: Film): View {
  const films = beside?.count ? [film, beside] : [film];
  const box = (axis: number) => ends(films.flatMap((one) => one.box(axis, factor)));
  const [x, z] = [box(0), box(film.layout.axes.length - 1)];
  const most = (name: string) => Math.max(...films.map((one) => one.most(name)));
  const w = x[1] - x[0];
  return {
    x: [x[0] - 0.02 * w, x[1] + 0.02 * w],
    z,
    force: film.layout.loads.length ? most("contact_force") : most("reaction"),
  };
}

/** What numbers are read of. */
interface Described {
  layout: Layout;
  picture: Picture;
  state: State;
}

/** The height of a load by the linear theory, m: of the point of its string that is under the load. */
function heightInTheory(ghost: Float32Array, axes: number, x: number): number {
  let best = 0;
  for (let i = 0; i < ghost.length; i += axes) if (Math.abs(ghost[i] - x) < Math.abs(ghost[best] - x)) best = i;
  return ghost[best + axes - 1];
}

/** The numbers of a frame that one asks for first, as rows, to four digits; `dragged`: the load beside a linear theory. */
export function numbersOf(film: Described, frame: Frame, dragged = ""): [string, string][] {
  const axes = film.layout.axes.length;
  const rows: [string, string][] = [];
  const quantities = [film.picture.colour, ...film.picture.diagrams];
  for (const quantity of new Map(quantities.map((one) => [one?.name, one])).values()) {
    const shown = quantity && film.state.ranges[quantity.name];
    if (!shown) continue;
    const [low, high] = ends(frame[quantity.name] ?? []);
    rows.push([`largest ${quantity.label}`, said(high / shown.size, shown, 4)]);
    rows.push([`smallest ${quantity.label}`, said(low / shown.size, shown, 4)]);
  }
  const loads = film.layout.loads.length > 12 ? [] : film.layout.loads.slice(0, 4);
  loads.forEach((name, k) => {
    const [behind, ahead] = frame.contact_tension?.subarray(2 * k) ?? [];
    const [x, z] = [frame.contact_position[k * axes], frame.contact_position[k * axes + axes - 1]];
    rows.push([`${name}: place x, z`, `${written(x, "m", 4)}, ${written(z, "m", 4)}`]);
    if (name === dragged && frame.ghost?.length)
      rows.push([`${name}: z by the linear theory`, written(heightInTheory(frame.ghost, axes, x), "m", 4)]);
    const down = frame.contact_force?.[k * axes + axes - 1];
    rows.push([`${name}: contact force, downwards`, written(down === undefined ? Number.NaN : -down, "N", 4)]);
    rows.push([`${name}: tension behind, ahead`, `${written(behind, "N", 4)}, ${written(ahead, "N", 4)}`]);
    rows.push([`${name}: hold force along x`, written(frame.hold_force?.[k * axes], "N", 4)]);
    if (frame.contact_friction) rows.push([`${name}: friction needed`, written(frame.contact_friction[k], "", 4)]);
  });
  return rows;
}
