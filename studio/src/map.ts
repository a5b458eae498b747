import { type Column, casesAt, levels, nextFrom, placesOf, type Sweep, told } from "./cases";
import { stepOf, steps } from "./colours";
import { button, coloursOf, element, pairs, select } from "./dom";
import { ends, ticks } from "./units";

const [WIDTH, HEIGHT] = [384, 300];
const EDGE = { left: 62, right: 12, top: 30, bottom: 42 };
const LONGEST = 14; // letters of a word at an axis
const NOTHING = "";

/** What is done with a case that was picked. */
export interface Actions {
  see: (row: number) => void;
  open: (row: number) => void;
}

/** A sweep as a map, a curve or points, in which a case is picked by pointer or arrow keys. */
export class SweepMap {
  private sweep?: Sweep;
  private picked = -1;
  private points = new Map<number, [number, number]>();
  private picture = drawn("svg", {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    class: "map",
    tabindex: "0",
    role: "application",
    "aria-label": "Cases of the sweep; arrow keys pick one, Enter computes it",
  });
  private choices = element("div", { class: "choices" });
  private about = element("div", { class: "picked", "aria-live": "polite" });
  private chosen: Record<"quantity" | "x" | "y", string> = { quantity: "", x: "", y: "" };
  private fixed = new Map<string, number | string>();

  constructor(
    private place: HTMLElement,
    private act: Actions,
  ) {
    this.picture.addEventListener("keydown", (event) => this.pressed(event as KeyboardEvent));
  }

  show(sweep: Sweep): void {
    this.sweep = sweep;
    const varied = sweep.parameters.filter((column) => levels(column).length > 1);
    const [x, y] = varied.length ? varied : sweep.parameters;
    this.chosen = {
      quantity: sweep.quantities[0]?.name ?? "",
      x: x.name,
      y: sweep.grid ? (y?.name ?? NOTHING) : NOTHING,
    };
    this.fixed = new Map();
    this.picked = -1;
    const counted = Object.entries(sweep.counted).map(([outcome, count]) => `${count} ${outcome}`);
    this.place.replaceChildren(
      element("h2", {}, sweep.title),
      element(
        "p",
        { class: "hint" },
        `${counted.join(", ")}${sweep.outcome === "completed" ? "" : ` (${sweep.outcome})`}`,
      ),
      this.choices,
      this.picture,
      this.about,
    );
    this.draw();
  }

  /** Draw anew, as after light has become dark. */
  draw(): void {
    const { sweep } = this;
    if (!sweep) return;
    this.choose(sweep);
    this.points.clear();
    this.picture.replaceChildren();
    const rows = casesAt(sweep, this.fixed);
    const [x, y] = [this.chosen.x, this.chosen.y].map((name) => sweep.parameters.find((one) => one.name === name));
    const quantity = sweep.quantities.find((one) => one.name === this.chosen.quantity);
    if (!x || !quantity) return;
    const values = placesOf(quantity);
    const words = y && !y.numeric ? (levels(y) as string[]) : [];
    EDGE.left = Math.max(62, 12 + 6 * Math.min(LONGEST, Math.max(0, ...words.map((word) => word.length))));
    const isGrid = sweep.grid && y !== undefined;
    const [across, up] = [this.axis(x, rows, "x", isGrid), this.axis(y ?? quantity, rows, "y", isGrid)];
    this.names(x, y ?? quantity);
    if (!y && sweep.grid) {
      const ordered = rows.filter((row) => Number.isFinite(values[row])).sort((a, b) => across(a) - across(b));
      const points = ordered.map((row) => `${across(row)},${up(row)}`).join(" ");
      this.picture.append(drawn("polyline", { points, class: "curve" }));
    }
    const colour = y ? this.scale(quantity, values, rows) : () => "var(--accent)";
    const width = (WIDTH - EDGE.left - EDGE.right) / levels(x).length;
    const height = (HEIGHT - EDGE.top - EDGE.bottom) / (y ? levels(y).length : 1);
    for (const row of rows) {
      const isThere = Number.isFinite(values[row]);
      const fill = isThere ? colour(values[row]) : "none";
      const [cx, cy] = [across(row), Number.isFinite(up(row)) ? up(row) : HEIGHT - EDGE.bottom - 6];
      const shape = isGrid
        ? drawn("rect", { x: cx - width / 2, y: cy - height / 2, width, height, fill, class: "cell" })
        : drawn("circle", { cx, cy, r: 4.5, fill, class: "point" });
      this.add(row, shape, cx, cy, isThere);
    }
    this.pick(this.points.has(this.picked) ? this.picked : (rows[0] ?? -1));
  }

  private choose(sweep: Sweep): void {
    const names = sweep.parameters.map((column) => column.name);
    const labelled = (label: string, options: string[], now: string, chosen: (value: string) => void) => {
      const choose = (value: string) => {
        chosen(value);
        this.draw();
        this.choices.querySelector<HTMLElement>(`[aria-label="${label}"]`)?.focus();
      };
      const named = options.map((one) => [one, one || "–"] as const);
      return element("label", {}, label, select(label, named, choose, { value: now }));
    };
    const set = (key: "quantity" | "x" | "y") => (value: string) => {
      if (key === "x" && value === this.chosen.y) this.chosen.y = this.chosen.x;
      this.chosen[key] = value;
    };
    const quantities = sweep.quantities.map((column) => column.name);
    const others = [NOTHING, ...names.filter((name) => name !== this.chosen.x)];
    const made = [
      labelled("Quantity", quantities, this.chosen.quantity, set("quantity")),
      labelled("Along x", names, this.chosen.x, set("x")),
    ];
    if (others.length > 1) made.push(labelled("Along y", others, this.chosen.y, set("y")));
    this.fixed = new Map([...this.fixed].filter(([name]) => name !== this.chosen.x && name !== this.chosen.y));
    for (const column of sweep.grid ? sweep.parameters : []) {
      const values = levels(column);
      if (column.name === this.chosen.x || column.name === this.chosen.y || !values.length) continue;
      if (!this.fixed.has(column.name)) this.fixed.set(column.name, values[0]);
      const texts = values.map((value) => told(value, column.unit));
      const now = texts[values.indexOf(this.fixed.get(column.name) as number)];
      made.push(labelled(column.name, texts, now, (text) => this.fixed.set(column.name, values[texts.indexOf(text)])));
    }
    this.choices.replaceChildren(...made);
  }

  /** A case in the picture: a ring where it is doubtful, a cross where it has no value. */
  private add(row: number, shape: SVGElement, x: number, y: number, hasValue: boolean): void {
    shape.addEventListener("click", () => this.pick(row));
    shape.append(drawn("title", {}, this.inWords(row)));
    this.points.set(row, [x, y]);
    this.picture.append(shape);
    const d = `M${x - 4},${y - 4}l8,8m0,-8l-8,8`;
    const ring = { cx: x, cy: y, r: 7 };
    if (!hasValue) this.picture.append(drawn("path", { d, class: "without" }));
    else if (this.sweep?.outcomes[row] === "doubtful")
      this.picture.append(drawn("circle", { ...ring, class: "halo" }), drawn("circle", { ...ring, class: "doubtful" }));
  }

  private inWords(row: number): string {
    const { sweep } = this;
    if (!sweep) return "";
    const named = [...sweep.parameters, ...sweep.quantities.filter((one) => one.name === this.chosen.quantity)];
    return named.map((one) => `${one.name} ${told(one.values[row], one.unit)}`).join(", ");
  }

  /** Marks of an axis; returns where each case is along it. In a grid, values stand side by side as words do. */
  private axis(column: Column, rows: number[], which: "x" | "y", isGrid: boolean): (row: number) => number {
    const [known, isWords] = [levels(column), isGrid || !column.numeric];
    const places = isWords ? column.values.map((value) => known.indexOf(value as string)) : placesOf(column);
    const [low, high] = isGrid ? [-0.5, known.length - 0.5] : endsOf(places, rows);
    const isX = which === "x";
    const [from, to] = isX ? [EDGE.left, WIDTH - EDGE.right] : [HEIGHT - EDGE.bottom, EDGE.top];
    const inset = isGrid ? 0 : 8 * Math.sign(to - from);
    const at = (place: number) => from + inset + ((place - low) / (high - low || 1)) * (to - from - 2 * inset);
    const every = Math.ceil(known.length / (isX ? 6 : 10));
    for (const mark of isWords ? [...known.keys()].filter((i) => i % every === 0) : ticks(low, high, 5)) {
      const text = shortened(told(isWords ? known[mark] : mark));
      const [x, y] = isX ? [at(mark), HEIGHT - EDGE.bottom] : [EDGE.left, at(mark)];
      const end = isX ? { x2: x, y2: EDGE.top } : { x2: WIDTH - EDGE.right, y2: y };
      this.picture.append(drawn("line", { x1: x, y1: y, ...end, class: "grid" }));
      if (isX) this.text(text, x, y + 15, "middle");
      else this.text(text, x - 5, y + 4, "end");
    }
    return (row) => at(places[row]);
  }

  private names(x: Column, y: Column): void {
    const label = ({ name, unit }: Column) => `${name.replaceAll("_", " ")}${unit && unit !== "1" ? ` (${unit})` : ""}`;
    this.text(label(x), (WIDTH + EDGE.left) / 2, HEIGHT - 8, "middle");
    this.text(label(y), 4, 14, "start");
  }

  /** Colours of a quantity, with their scale in the corner. */
  private scale(quantity: Column, values: number[], rows: number[]): (value: number) => string {
    const table = steps(coloursOf(this.place));
    const [low, high] = endsOf(values, rows);
    const [part, right] = [90 / table.length, WIDTH - EDGE.right];
    for (const [i, fill] of table.entries())
      this.picture.append(drawn("rect", { x: right - 90 + i * part, y: 18, width: part + 0.3, height: 6, fill }));
    this.text(`${told(low)} to ${told(high, quantity.unit)}`, right, 14, "end");
    return (value) => table[stepOf(value, low, high)];
  }

  private text(text: string, x: number, y: number, anchor: string): void {
    this.picture.append(drawn("text", { x, y, "text-anchor": anchor }, text));
  }

  private pick(row: number): void {
    const { sweep } = this;
    for (const old of this.picture.querySelectorAll(".here")) old.remove();
    const at = this.points.get(row);
    this.picked = row;
    if (!sweep || !at) return;
    const ring = { cx: at[0], cy: at[1], r: 9.5 };
    for (const name of ["halo here", "mark here"]) this.picture.append(drawn("circle", { ...ring, class: name }));
    const columns = [...sweep.parameters, ...sweep.quantities];
    const rows = columns.map((column) => [column.name, told(column.values[row], column.unit)] as const);
    const about = { class: "main", title: "Compute this case (Enter)" };
    const see = button("See this run", () => this.act.see(row), about);
    const open = button("Open its scenario", () => this.act.open(row));
    const doubts = sweep.doubts[row].split("\n").filter(Boolean);
    this.about.replaceChildren(
      element("div", { class: "row" }, see, open),
      ...[...doubts, sweep.reason[row]].filter(Boolean).map((text) => element("p", { class: "doubt" }, text)),
      element("dl", { class: "numbers" }, ...pairs([...rows, ["outcome", sweep.outcomes[row]]])),
    );
  }

  private pressed(event: KeyboardEvent): void {
    const ways: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    const way = ways[event.key];
    if (way) this.pick(nextFrom(this.points, this.picked, ...way));
    else if (event.key === "Enter" && this.picked >= 0) this.act.see(this.picked);
    else return;
    event.preventDefault();
  }
}

function shortened(word: string): string {
  return word.length > LONGEST ? `${word.slice(0, LONGEST - 1)}…` : word;
}

/** The smallest and the largest value of some cases. */
function endsOf(values: number[], rows: number[]): [number, number] {
  const found = ends(rows.map((row) => values[row]));
  return found[0] <= found[1] ? found : [0, 1];
}

function drawn(tag: string, given: Record<string, string | number>, text = ""): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(given)) made.setAttribute(name, `${value}`);
  if (text) made.textContent = text;
  return made;
}
