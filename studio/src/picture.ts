import type { Frame, Layout } from "./film";
import { rounded } from "./units";

/** What `ropewalk.results.picture` describes: quantities, symbols, and what grows with the frames. */
export interface Quantity {
  name: string;
  label: string;
  unit: string;
  of: "link" | "node" | "cell";
  lines: string[];
  down: boolean;
}

export interface Mark {
  kind: string;
  name: string;
  contacts?: number[];
  bodies?: number[];
  nodes?: number[];
  at?: number[]; // m
  size?: number; // m
  foot?: number; // m
}

export interface Picture {
  colour: Quantity | null;
  diagrams: Quantity[];
  symbols: Mark[];
  around: number | null; // m, on each side of the contacts, of what is too long to be seen as a whole
}

/** In the unit that is shown, whose size in SI is `size`. */
export interface Shown {
  low: number;
  high: number;
  unit: string;
  size: number;
}

export interface State {
  factor: number;
  height_factor: number;
  ranges: Record<string, Shown | null>;
}

/** A number with its unit, to so many digits; round-off of the range is zero. */
export function said(value: number, { low, high, unit }: Shown, digits = 3): string {
  const isZero = Math.abs(value) <= 1e-6 * Math.max(Math.abs(low), Math.abs(high));
  return `${isZero ? "0" : rounded(value, digits)} ${unit.replace("*", " ")}`.trim();
}

/** The values that colour the links of a line, in SI; of quantities of nodes the means of their ends; NaN: none. */
export function valuesAlong(
  quantity: Quantity | null,
  frame: Frame,
  layout: Layout,
  line: string,
): (i: number) => number {
  const values = quantity && frame[quantity.name];
  const [first, link] = [layout.nodes, layout.links].map((all) => all.find(([name]) => name === line)?.[1] ?? 0);
  if (!values || (quantity.lines.length && !quantity.lines.includes(line))) return () => Number.NaN;
  if (quantity.of === "node") return (i) => 0.5 * (values[first + i] + values[first + i + 1]);
  return quantity.of === "link" ? (i) => values[link + i] : () => Number.NaN;
}
