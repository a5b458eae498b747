import { short } from "./units";

/** A column of a sweep: one entry for each case. */
export interface Column {
  name: string;
  unit: string;
  numeric: boolean;
  values: (number | string | null)[];
}

/** A sweep as `ropewalk.studio.sweeps` describes it. */
export interface Sweep {
  title: string;
  outcome: string;
  counted: Record<string, number>;
  grid: boolean;
  parameters: Column[];
  quantities: Column[];
  outcomes: string[];
  doubts: string[];
  reason: string[];
}

/** What a column takes: numbers in their order, words as they come. */
export function levels(column: Column): (number | string)[] {
  const found = [...new Set(column.values.filter((value) => value !== null))] as (number | string)[];
  return column.numeric ? found.sort((a, b) => Number(a) - Number(b)) : found;
}

/** Where the value of a case stands along an axis: a number itself, a word by its place among the others. */
export function placesOf(column: Column): number[] {
  if (column.numeric) return column.values.map((value) => (value === null ? Number.NaN : Number(value)));
  const known = levels(column);
  return column.values.map((value) => known.indexOf(value as string));
}

/** Cases that have these values; what is not named may be anything. */
export function casesAt(sweep: Sweep, fixed: ReadonlyMap<string, number | string>): number[] {
  const columns = sweep.parameters.filter((column) => fixed.has(column.name));
  return sweep.outcomes
    .map((_, row) => row)
    .filter((row) => columns.every((column) => column.values[row] === fixed.get(column.name)));
}

/** The next point from one, in a direction; the same one where there is none. Points in pixels. */
export function nextFrom(points: Map<number, [number, number]>, row: number, dx: number, dy: number): number {
  const here = points.get(row);
  if (!here) return points.keys().next().value ?? -1;
  let best = row;
  let least = Number.POSITIVE_INFINITY;
  for (const [other, [x, y]] of points) {
    const ahead = (x - here[0]) * dx + (y - here[1]) * dy;
    const aside = Math.abs((x - here[0]) * dy) + Math.abs((y - here[1]) * dx);
    const way = ahead + 3 * aside;
    if (ahead > 0.5 && way < least) {
      least = way;
      best = other;
    }
  }
  return best;
}

/** A number with four digits, as a table has it. */
export function told(value: number | string | null, unit = ""): string {
  if (value === null) return "–";
  const text = typeof value === "number" ? short(value, 4) : value;
  return unit && unit !== "1" ? `${text} ${unit}` : text;
}
