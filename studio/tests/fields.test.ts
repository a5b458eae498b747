import { expect, test } from "vitest";
import { Source } from "../src/edits";
import { type Field, fieldsOf, joined } from "../src/fields";
import type { Schema } from "../src/schema";

const number: Schema = { type: ["number", "string"], unit: "m" };
const SCHEMA: Schema = {
  properties: {
    title: { type: "string", default: "untitled", description: "a line of text" },
    lines: { type: "object", additionalProperties: { $ref: "#/$defs/Line" } },
    run: { oneOf: [{ $ref: "#/$defs/Dynamic" }, { $ref: "#/$defs/Rest" }] },
  },
  $defs: {
    Line: {
      required: ["start"],
      properties: {
        start: { type: "array", items: number, minItems: 2, maxItems: 3 },
        at: { type: "array", items: number, minItems: 1 },
        elements: { anyOf: [{ type: "integer" }, { enum: ["auto"] }] },
        slack: { type: "boolean" },
        speed: { anyOf: [number, { $ref: "#/$defs/Table" }] },
      },
    },
    Table: { required: ["time"], properties: { time: { type: "array", items: { unit: "s" } } } },
    Dynamic: { required: ["kind", "until"], properties: { kind: { const: "dynamic" }, until: number } },
    Rest: { properties: { kind: { const: "rest" }, loose: { type: "boolean" } } },
  },
};
const shown = (text: string, ...begun: string[][]) => fieldsOf(SCHEMA, new Source(text), new Set(begun.map(joined)));
const at = (root: Field, ...path: string[]) =>
  path.reduce<Field | undefined>((field, name) => field?.fields.find((one) => one.name === name), root);

test("a form shows what is written and what must be; all else can be added", () => {
  const root = shown("lines:\n  rope: {slack: true}\n");
  expect(root.fields.map((field) => field.name)).toEqual(["lines"]);
  expect(root.more).toEqual([
    { name: "title", about: "a line of text" },
    { name: "run", about: "" },
  ]);
  const rope = at(root, "lines", "rope");
  expect(rope?.fields.map(({ name, isRequired, isThere }) => [name, isRequired, isThere])).toEqual([
    ["start", true, false],
    ["slack", false, true],
  ]);
});

test("values have the shape of their schema, and their unit", () => {
  const root = shown(
    "lines:\n  rope:\n    start: [0 m, 3 m]\n    at: [1 m, 2 m]\n    elements: auto\n    slack: true\n",
  );
  const told = at(root, "lines", "rope")?.fields.map(({ shape, value, unit }) => [shape, value, unit]);
  expect(told).toEqual([
    ["vector", "[0 m, 3 m]", "m"],
    ["list", "1 m, 2 m", "m"],
    ["text", "auto", ""],
    ["choice", "true", ""],
  ]);
  expect(at(root, "lines", "rope", "start")).toMatchObject({ places: ["x", "z"], components: ["0 m", "3 m"] });
});

test("a union is a choice of kind, and the usual one where none is written", () => {
  expect(at(shown("run: {until: 1 s}\n"), "run")).toMatchObject({ kind: "rest", kinds: ["dynamic", "rest"] });
  const run = at(shown("run: {kind: dynamic, loose: true}\n"), "run");
  expect(run?.keysOf.rest).toEqual(["kind", "loose"]);
  expect(run?.fields.map(({ name, about }) => [name, about])).toEqual([
    ["until", ""],
    ["loose", "There is no such key here."],
  ]);
});

test("a value may become a table, and what is begun is shown before it is written", () => {
  const speed = ["lines", "rope", "speed"];
  expect(at(shown("lines: {rope: {speed: 3 m/s}}\n"), ...speed)).toMatchObject({ shape: "text", canBeBlock: true });
  const table = at(shown("lines: {rope: {speed: 3 m/s}}\n", [...speed, ""]), ...speed);
  expect(table?.fields.map(({ name, isThere }) => [name, isThere])).toEqual([["time", false]]);
  expect(at(shown("", ["lines", "new"]), "lines", "new", "start")).toMatchObject({ isRequired: true, isThere: false });
});

test("what another block gives is not asked for again", () => {
  const text = "lines:\n  a: &a {start: [0 m, 0 m]}\n  b: {<<: *a, slack: true}\n  c: *a\n";
  const fields = at(shown(text), "lines", "b")?.fields.map(({ name, shape }) => [name, shape]);
  expect(fields).toEqual([
    ["slack", "choice"],
    ["<<", "locked"],
  ]);
  expect(at(shown(text), "lines", "c")?.shape).toBe("locked");
});
