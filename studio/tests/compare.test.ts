import { expect, test } from "vitest";
import { differences, type Numbers } from "../src/compare";

test("of two runs only what both have and what differs is told", () => {
  const now: Numbers = {
    sag: [1.1, "m"],
    tension: [1000, "N"],
    only: [1, "m"],
    unit: [1, "m"],
    zero: [2, "J"],
    rest: [2, "N"],
  };
  const beside: Numbers = {
    ...{ sag: [1, "m"], tension: [1000.0001, "N"], unit: [2, "mm"], zero: [0, "J"] },
    rest: [3e-14, "N"], // rounding: no number to divide by
  };
  expect(differences(now, beside)).toEqual([
    ["sag", "1.1 m", "1 m", "10 %"],
    ["zero", "2 J", "0 J", "–"],
    ["rest", "2 N", "3e−14 N", "–"],
  ]);
});
