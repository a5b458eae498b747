import { expect, test } from "vitest";
import { casesAt, levels, nextFrom, placesOf, type Sweep, told } from "../src/cases";

const column = (name: string, values: (number | string | null)[], numeric = true) => ({
  name,
  unit: "",
  numeric,
  values,
});
const SWEEP: Sweep = {
  title: "",
  outcome: "completed",
  counted: {},
  grid: true,
  parameters: [column("speed", [3, 3, 2, 2]), column("contact", ["b", "a", "b", "a"], false)],
  quantities: [column("sag", [1, null, 3, 4])],
  outcomes: ["completed", "failed", "completed", "completed"],
  doubts: ["", "", "", ""],
  reason: ["", "", "", ""],
};

test("numbers stand in their order, words as they come, and nothing nowhere", () => {
  expect(levels(SWEEP.parameters[0])).toEqual([2, 3]);
  expect(levels(SWEEP.parameters[1])).toEqual(["b", "a"]);
  expect(placesOf(SWEEP.parameters[1])).toEqual([0, 1, 0, 1]);
  expect(placesOf(SWEEP.quantities[0])).toEqual([1, Number.NaN, 3, 4]);
});

test("of a slice, only its cases are there", () => {
  expect(casesAt(SWEEP, new Map([["speed", 2]]))).toEqual([2, 3]);
  expect(casesAt(SWEEP, new Map<string, number | string>().set("speed", 3).set("contact", "a"))).toEqual([1]);
});

test("arrow keys go to the next case that way", () => {
  const points = new Map<number, [number, number]>([
    [0, [0, 0]],
    [1, [10, 1]],
    [2, [20, 0]],
    [3, [10, 30]],
  ]);
  expect(nextFrom(points, 0, 1, 0)).toBe(1);
  expect(nextFrom(points, 2, -1, 0)).toBe(1);
  expect(nextFrom(points, 1, 0, 1)).toBe(3);
  expect(nextFrom(points, 2, 1, 0)).toBe(2);
  expect(nextFrom(points, 9, 1, 0)).toBe(0);
});

test("numbers of tables have four digits", () => {
  expect([told(-1.52487397, "kg/m"), told(null, "N"), told("a"), told(2, "1")]).toEqual(["−1.525 kg/m", "–", "a", "2"]);
});
