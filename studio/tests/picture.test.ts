import { expect, test } from "vitest";
import { Film } from "../src/film";
import { type Quantity, said, valuesAlong } from "../src/picture";
import { viewOf } from "../src/player";

const layout = { axes: ["x", "z"], nodes: [["deck", 0, 3]], links: [["deck", 0, 2]], loads: [], cells: [] };
const array = (values: number[], ...shape: number[]) => ({ shape, values: Float32Array.of(...values) });
const quantity = (name: string, of: Quantity["of"], ...lines: string[]) => ({
  name,
  label: name,
  unit: "m",
  of,
  lines,
  down: true,
});

test("what is in view holds the exaggerated displacement and the place without it", () => {
  const picture = { colour: null, diagrams: [], symbols: [], around: null };
  const reference = array([0, 2, 5, 2, 10, 2], 3, 2);
  const film = new Film({ head: { layout, picture, total: 2 }, arrays: { reference } });
  const position = array([0, 2, 5, 2, 10, 2, 0, 2, 5, 1.99, 10, 2], 2, 3, 2);
  const state = { factor: 100, height_factor: 1, ranges: {} };
  film.add({ head: { state }, arrays: { path: array([0, 1], 2), position } });
  expect(viewOf(film, film.state.factor).z).toEqual([expect.closeTo(1, 4), 2]);
  expect(viewOf(film, 1).z).toEqual([expect.closeTo(1.99, 4), 2]);
});

test("links are coloured by their own value or by the mean of their ends, other lines by none", () => {
  const frame = { tension: Float32Array.of(5, 7), deflection: Float32Array.of(0, 4, 2) };
  const along = (one: Quantity) => [0, 1].map(valuesAlong(one, frame, layout as never, "deck"));
  expect(along(quantity("tension", "link"))).toEqual([5, 7]);
  expect(along(quantity("deflection", "node", "deck"))).toEqual([2, 3]);
  expect(along(quantity("deflection", "node", "rail"))).toEqual([Number.NaN, Number.NaN]);
});

test("numbers are in the unit of their range, and round-off is zero", () => {
  const range = { low: -1.34, high: 18.24, unit: "kN*m", size: 1000 };
  expect(said(18.239, range)).toBe("18.2 kN m");
  expect(said(-0.25, range)).toBe("−0.250 kN m");
  expect(said(1e-9, range)).toBe("0 kN m");
});
