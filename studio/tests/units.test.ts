import { expect, test } from "vitest";
import { turned } from "../src/camera";
import { Latest } from "../src/connection";
import { Film } from "../src/film";
import { unpacked } from "../src/messages";
import { completions, type Schema } from "../src/schema";
import { ticks, written } from "../src/units";

const reference = (...values: number[]) => ({
  reference: { shape: [values.length], values: Float32Array.of(...values) },
});
const state = { factor: 1, height_factor: 1, ranges: {} };

function packed(head: object, ...values: number[]): ArrayBuffer {
  let text = JSON.stringify(head);
  text += " ".repeat((4 - (text.length % 4)) % 4);
  const data = new ArrayBuffer(4 + text.length + 4 * values.length);
  new DataView(data).setUint32(0, text.length, true);
  new Uint8Array(data, 4).set(new TextEncoder().encode(text));
  new Float32Array(data, 4 + text.length).set(values);
  return data;
}

test("a message is a header and its arrays, one after the other", () => {
  const arrays = [
    ["path", [2]],
    ["tension", [2, 1]],
  ];
  const message = unpacked(packed({ id: 7, arrays }, 0, 0.5, 10, 20));
  expect(message.head.id).toBe(7);
  expect([...message.arrays.path.values]).toEqual([0, 0.5]);
  expect([...message.arrays.tension.values]).toEqual([10, 20]);
});

test("a film gives the last frame at an instant, whatever came at once", () => {
  const film = new Film({ head: { layout: {}, total: 300 }, arrays: reference() });
  for (let i = 0; i < 100; i++) {
    const path = Float32Array.of(3 * i, 3 * i + 1, 3 * i + 2);
    const tension = { shape: [3, 1], values: path.map((x) => 1 - x) };
    film.add({ head: { state }, arrays: { path: { shape: [3], values: path }, tension } });
  }
  expect(film.count).toBe(300);
  expect(film.at(200.7)).toBe(200);
  expect(film.at(-1)).toBe(0);
  expect(film.frame(200).tension[0]).toBe(-199);
  expect([film.envelope("tension").low[0], film.envelope("tension").high[0], film.most("tension")]).toEqual([
    -298, 1, 298,
  ]);
  const tenths = new Film({ head: { layout: {}, total: 3 }, arrays: reference() });
  tenths.add({ head: { state }, arrays: { path: { shape: [3], values: Float32Array.of(0, 0.1, 0.2) } } });
  expect(tenths.at(0.1)).toBe(1); // 0.1 as a 32-bit float is a little more
});

test("of what is wanted while an answer is on its way, only the latest is asked", async () => {
  const asked: number[] = [];
  let answer = () => {};
  const latest = new Latest<number>((wanted) => {
    asked.push(wanted);
    return new Promise((resolve) => {
      answer = () => resolve();
    });
  });
  const all = latest.want(1);
  for (const wanted of [2, 3, 4]) latest.want(wanted);
  answer();
  await Promise.resolve();
  await Promise.resolve();
  answer();
  await all;
  expect(asked).toEqual([1, 4]);
});

test("completion knows the block and the key", () => {
  const schema: Schema = {
    properties: { lines: { additionalProperties: { $ref: "#/$defs/Line" } }, run: { $ref: "#/$defs/Run" } },
    $defs: {
      Line: { properties: { mass: { unit: "kg/m" }, length: {} } },
      Run: { properties: { kind: { enum: ["dynamic", "equilibrium"] } } },
    },
  };
  const labels = (text: string) => completions(schema, text).map((option) => option.label);
  expect(labels("")).toEqual(["lines", "run"]);
  expect(labels("lines:\n  rope:\n    ")).toEqual(["mass", "length"]);
  expect(labels("run:\n  kind: ")).toEqual(["dynamic", "equilibrium"]);
});

test("a camera goes around what it looks at, at the same distance, and never over its head", () => {
  const [x, y, z] = turned([3, 0, 0], Math.PI / 2, -Math.PI / 6);
  expect([x, y, z]).toEqual([
    expect.closeTo(0, 12),
    expect.closeTo(3 * Math.cos(Math.PI / 6), 12),
    expect.closeTo(1.5, 12),
  ]);
  const up = turned([0, 1, 1], 0, -3);
  expect(Math.hypot(...up)).toBeCloseTo(Math.SQRT2, 12);
  expect(up[2]).toBeLessThan(Math.SQRT2);
});

test("numbers have three digits and a unit", () => {
  expect(written(1234.5, "N")).toBe("1.23 kN");
  expect(written(-800, "N")).toBe("−800 N");
  expect(written(0.0042, "m")).toBe("4.20 mm");
  expect(written(Number.NaN, "N")).toBe("–");
  expect(ticks(0, 19.5, 9)).toEqual([0, 5, 10, 15]);
});
