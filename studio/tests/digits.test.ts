import { expect, test } from "vitest";
import type { Film } from "../src/film";
import { numbersOf } from "../src/player";
import { written } from "../src/units";

test("numbers have as many digits as are asked for, whatever their size", () => {
  expect(written(0.1534, "m")).toBe("0.153 m");
  expect(written(-2.8521, "m", 4)).toBe("−2.852 m");
  expect(written(1586.2, "N", 4)).toBe("1.586 kN");
  expect(written(0.2791, "", 4)).toBe("0.2791");
  expect(written(123456, "N")).toBe("123 kN");
  expect(written(0, "N", 4)).toBe("0 N");
});

test("beside a dragged load stands its height by the linear theory, and what it presses with", () => {
  const layout = { axes: ["x", "z"], loads: ["her"] } as unknown as Film["layout"];
  const colour = { name: "tension", label: "tension", unit: "N", of: "link" as const, lines: [], down: false };
  const picture = { colour, diagrams: [], symbols: [], around: null };
  const ranges = { tension: { low: 7, high: 8, unit: "kN", size: 1000 } };
  const described = { layout, picture, state: { factor: 1, height_factor: 1, ranges } };
  const frame = {
    tension: Float32Array.of(8000),
    contact_position: Float32Array.of(10, -0.153),
    contact_force: Float32Array.of(0, -200),
    contact_tension: Float32Array.of(8100, 8100),
    hold_force: Float32Array.of(0, 0),
    ghost: Float32Array.of(0, 0, 10, -0.156, 20, 0),
  };
  const rows = new Map(numbersOf(described, frame, "her"));
  expect(rows.get("largest tension")).toBe("8.000 kN");
  expect(rows.get("her: z by the linear theory")).toBe("−0.1560 m");
  expect(rows.get("her: contact force, downwards")).toBe("200.0 N");
  expect(numbersOf(described, frame).some(([name]) => /theory/.test(name))).toBe(false);
});
