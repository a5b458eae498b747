import { type Column, casesAt, levels, nextFrom, placesOf, type Sweep, told } from "./cases";
import { stepOf, steps } from "./colours";
import { button, coloursOf, element, pairs, select } from "./dom";
import { ticks } from "./units";

const [WIDTH, HEIGHT] = [384, 300];
const EDGE = { left: 62, right: 12, top: 30, bottom: 42 };
const LONGEST = 14; // letters of a word at an axis
const NOTHING = "";

type Ends = [number, number];

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
    if (!this.sweep) return;
    this.choose(this.sweep);
    this.points.clear();
    const rows = casesAt(this.sweep, this.fixed);
    const column = (name: string) => this.sweep?.parameters.find((one) => one.name === name) as Column;
    const quantity = this.sweep.quantities.find((one) => one.name === this.chosen.quantity) as Column;
    const x = column(this.chosen.x);
    this.picture.replaceChildren();
    const words = [column(this.chosen.y)]
      .filter((one) => one && !one.numeric)
      .flatMap((one) => levels(one) as string[]);
    EDGE.left = Math.max(62, 12 + 6 * Math.min(LONGEST, Math.max(0, ...words.map((word) => word.length))));
    if (this.chosen.y === NOTHING) this.curve(x, quantity, rows);
    else if (this.sweep.grid) this.cells(x, column(this.chosen.y), quantity, rows);
    else this.cloud(x, column(this.chosen.y), quantity, rows);
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
      const made = select(
        label,
        options.map((one) => [one, one || "–"] as const),
        choose,
      );
      made.value = now;
      return element("label", {}, label, made);
    };
    const quantities = sweep.quantities.map((column) => column.name);
    const made = [
      labelled("Quantity", quantities, this.chosen.quantity, (value) => {
        this.chosen.quantity = value;
      }),
      labelled("Along x", names, this.chosen.x, (value) => {
        if (value === this.chosen.y) this.chosen.y = this.chosen.x;
        this.chosen.x = value;
      }),
    ];
    const others = [NOTHING, ...names.filter((name) => name !== this.chosen.x)];
    if (others.length > 1)
      made.push(
        labelled("Along y", others, this.chosen.y, (value) => {
          this.chosen.y = value;
        }),
      );
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

  private curve(x: Column, quantity: Column, rows: number[]): void {
    const along = placesOf(x);
    const up = placesOf(quantity);
    const [sx, sy] = [this.axis(x, along, rows, "x"), this.axis(quantity, up, rows, "y")];
    const there = rows.filter((row) => Number.isFinite(up[row]));
    if (this.sweep?.grid) {
      const ordered = [...there].sort((a, b) => along[a] - along[b]);
      const points = ordered.map((row) => `${sx(along[row])},${sy(up[row])}`).join(" ");
      this.picture.append(drawn("polyline", { points, class: "curve" }));
    }
    for (const row of rows) this.point(row, sx(along[row]), sy(up[row]));
  }

  private cloud(x: Column, y: Column, quantity: Column, rows: number[]): void {
    const [along, up, values] = [placesOf(x), placesOf(y), placesOf(quantity)];
    const [sx, sy] = [this.axis(x, along, rows, "x"), this.axis(y, up, rows, "y")];
    const colour = this.scale(quantity, values, rows);
    for (const row of rows) this.point(row, sx(along[row]), sy(up[row]), colour(values[row]));
  }

  private cells(x: Column, y: Column, quantity: Column, rows: number[]): void {
    const [columns, lines] = [levels(x), levels(y)];
    const values = placesOf(quantity);
    const colour = this.scale(quantity, values, rows);
    const w = (WIDTH - EDGE.left - EDGE.right) / columns.length;
    const h = (HEIGHT - EDGE.top - EDGE.bottom) / lines.length;
    for (const row of rows) {
      const i = columns.indexOf(x.values[row] as number);
      const j = lines.indexOf(y.values[row] as number);
      const [left, top] = [EDGE.left + i * w, HEIGHT - EDGE.bottom - (j + 1) * h];
      const fill = Number.isFinite(values[row]) ? colour(values[row]) : "none";
      const cell = { x: `${left}`, y: `${top}`, width: `${w}`, height: `${h}`, fill, class: "cell" };
      this.add(row, drawn("rect", cell), left + w / 2, top + h / 2, Number.isFinite(values[row]));
    }
    const every = (count: number, most: number) => Math.ceil(count / most);
    columns.forEach((value, i) => {
      if (i % every(columns.length, 6) === 0)
        this.text(short(told(value)), EDGE.left + (i + 0.5) * w, HEIGHT - EDGE.bottom + 15, "middle");
    });
    lines.forEach((value, j) => {
      if (j % every(lines.length, 10) === 0)
        this.text(short(told(value)), EDGE.left - 5, HEIGHT - EDGE.bottom - (j + 0.5) * h + 4, "end");
    });
    this.names(x, y);
  }

  private point(row: number, x: number, y: number, fill = "var(--accent)"): void {
    const isThere = Number.isFinite(y) && Number.isFinite(x);
    const foot = isThere ? y : HEIGHT - EDGE.bottom - 6;
    const place = { cx: `${x}`, cy: `${foot}`, r: "4.5", fill: isThere ? fill : "none", class: "point" };
    this.add(row, drawn("circle", place), x, foot, isThere && Number.isFinite(this.numberOf(row)));
  }

  private numberOf(row: number): number {
    const value = this.sweep?.quantities.find((one) => one.name === this.chosen.quantity)?.values[row];
    return typeof value === "number" ? value : Number.NaN;
  }

  /** A case in the picture: a ring where it is doubtful, a cross where it has no value. */
  private add(row: number, shape: SVGElement, x: number, y: number, hasValue: boolean): void {
    shape.addEventListener("click", () => this.pick(row));
    shape.append(drawn("title", {}, this.inWords(row)));
    this.points.set(row, [x, y]);
    this.picture.append(shape);
    const d = `M${x - 4},${y - 4}l8,8m0,-8l-8,8`;
    const ring = { cx: `${x}`, cy: `${y}`, r: "7" };
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

  private axis(column: Column, places: number[], rows: number[], which: "x" | "y"): (value: number) => number {
    const [low, high] = ends(rows.map((row) => places[row]));
    const [from, to] =
      which === "x" ? [EDGE.left + 8, WIDTH - EDGE.right - 8] : [HEIGHT - EDGE.bottom - 8, EDGE.top + 8];
    const at = (value: number) => from + ((value - low) / (high - low || 1)) * (to - from);
    const marks = column.numeric ? ticks(low, high, 5) : levels(column).map((_, i) => i);
    for (const mark of marks) {
      const text = column.numeric ? told(mark) : short(`${levels(column)[mark]}`);
      if (which === "x") {
        this.picture.append(line(at(mark), EDGE.top, at(mark), HEIGHT - EDGE.bottom));
        this.text(text, at(mark), HEIGHT - EDGE.bottom + 15, "middle");
      } else {
        this.picture.append(line(EDGE.left, at(mark), WIDTH - EDGE.right, at(mark)));
        this.text(text, EDGE.left - 5, at(mark) + 4, "end");
      }
    }
    if (which === "y") this.names(this.sweep?.parameters.find((one) => one.name === this.chosen.x) as Column, column);
    return at;
  }

  private names(x: Column, y: Column): void {
    const label = ({ name, unit }: Column) => `${name.replaceAll("_", " ")}${unit && unit !== "1" ? ` (${unit})` : ""}`;
    this.text(label(x), (WIDTH + EDGE.left) / 2, HEIGHT - 8, "middle");
    this.text(label(y), 4, 14, "start");
  }

  /** Colours of a quantity, with their scale in the corner. */
  private scale(quantity: Column, values: number[], rows: number[]): (value: number) => string {
    const table = steps(coloursOf(this.place)("--dark") === "1");
    const [low, high] = ends(rows.map((row) => values[row]));
    const wide = 90;
    const left = WIDTH - EDGE.right - wide;
    table.forEach((fill, i) => {
      const part = wide / table.length;
      const bar = { x: `${left + i * part}`, y: "18", width: `${part + 0.3}`, height: "6", fill };
      this.picture.append(drawn("rect", bar));
    });
    this.text(
      `${told(low)} to ${told(high)}${quantity.unit ? ` ${quantity.unit}` : ""}`,
      WIDTH - EDGE.right,
      14,
      "end",
    );
    return (value) => table[stepOf(value, low, high)];
  }

  private text(text: string, x: number, y: number, anchor: string): void {
    this.picture.append(drawn("text", { x: `${x}`, y: `${y}`, "text-anchor": anchor }, text));
  }

  private pick(row: number): void {
    const { sweep } = this;
    for (const old of this.picture.querySelectorAll(".here")) old.remove();
    const at = this.points.get(row);
    this.picked = row;
    if (!sweep || !at) return;
    const ring = { cx: `${at[0]}`, cy: `${at[1]}`, r: "9.5" };
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

function ends(values: number[]): Ends {
  const there = values.filter(Number.isFinite);
  return there.length ? [Math.min(...there), Math.max(...there)] : [0, 1];
}

function short(word: string): string {
  return word.length > LONGEST ? `${word.slice(0, LONGEST - 1)}…` : word;
}

function line(x1: number, y1: number, x2: number, y2: number): SVGElement {
  return drawn("line", { x1: `${x1}`, y1: `${y1}`, x2: `${x2}`, y2: `${y2}`, class: "grid" });
}

function drawn(tag: string, given: Record<string, string>, text = ""): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(given)) made.setAttribute(name, value);
  if (text) made.textContent = text;
  return made;
}
