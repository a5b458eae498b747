import { expect, test } from "vitest";
import { difference, Source } from "../src/edits";

const TEXT = `# of a rope
title: A slack rope  # stays
lines:
  rope:            # the one
    start: [0 m, 0 m]
    mass: 1 kg/m   # with water
    end:
      - 19.5 m
      - 0 m
    length: 20 m
    law: {kind: hooke}

loads:
  walker: {kind: force, on: rope, force: [0 N, -800 N]}  # one
run:
  kind: dynamic
  until: "1 s"
`;
/** What a change takes away and puts in its place. */
function changed(path: string, value?: string, raw = false, text = TEXT): string[] {
  const source = new Source(text);
  const keys = path.split(".");
  const after = value === undefined ? source.remove(keys) : source.set(keys, value, { raw });
  const { from, to, insert } = difference(text, after);
  expect(text.slice(0, from) + insert + text.slice(to)).toBe(after);
  expect(new Source(after).wrong).toBe("");
  return [text.slice(from, to), insert];
}

test("a value is changed where it stands, and nothing else", () => {
  expect(changed("lines.rope.mass", "2 kg/m")).toEqual(["1", "2"]);
  expect(changed("lines.rope.start.1", "3 m")).toEqual(["0", "3"]);
  expect(changed("lines.rope.end.0", "30 m")).toEqual(["19.5", "30"]);
  expect(changed("lines.rope.end", "[7 m, 0 m]", true)).toEqual(["19.5", "7"]);
  expect(changed("loads.walker.force", "[0 N, 5 N]", true)).toEqual(["-800", "5"]);
  expect(changed("run.until", "7 s")).toEqual(["1", "7"]);
});

test("what would be read as something else is quoted", () => {
  expect(changed("title", "a: b # c")).toEqual(["A slack rope", '"a: b # c"']);
  expect(new Source(TEXT).set(["title"], "2024", { words: true })).toContain('title: "2024"  # stays');
  expect(changed("lines.rope.law.kind", "x, y: 2")).toEqual(["hooke", '"x, y: 2"']);
});

test("a key that was not there comes at the end of its block", () => {
  expect(changed("run.every", "1 ms")).toEqual(["", "  every: 1 ms\n"]);
  expect(changed("lines.rope.cut.at", "3 m")).toEqual(["", "    cut:\n      at: 3 m\n"]);
  expect(changed("loads.walker.travel.speed", "3 m/s")).toEqual(["", ", travel: {speed: 3 m/s}"]);
  expect(changed("loads.cart.kind", "mass")).toEqual(["", "  cart:\n    kind: mass\n"]);
  expect(changed("a", "1", false, "")).toEqual(["", "a: 1\n"]);
  expect(changed("loads.cart.kind", "mass", false, "loads:  # none\n")).toEqual(["", "  cart:\n    kind: mass\n"]);
  expect(changed("x.kind", "mass", false, "x:\n  a: 1\n")).toEqual(["", "kind: mass\n  "]);
  expect(changed("x.speed.time", "[0 s]", true, "x: {speed: 3}\n")).toEqual(["3", "{time: [0 s]}"]);
});

test("a key is removed with its line, and with the block that it leaves empty", () => {
  expect(new Source(TEXT).remove(["lines", "rope", "mass"])).toBe(
    TEXT.replace("    mass: 1 kg/m   # with water\n", ""),
  );
  expect(new Source(TEXT).remove(["loads", "walker", "on"])).toBe(TEXT.replace("on: rope, ", ""));
  expect(new Source(TEXT).remove(["loads", "walker", "force"])).toBe(TEXT.replace(", force: [0 N, -800 N]", ""));
  expect(new Source(TEXT).remove(["lines", "rope", "law", "kind"])).toBe(TEXT.replace("    law: {kind: hooke}\n", ""));
  expect(new Source(TEXT).remove(["run", "until"])).toBe(TEXT.replace('  until: "1 s"\n', ""));
  expect(new Source("a: 1\nb: 2").remove(["b"])).toBe("a: 1");
  expect(new Source("x:\n  - a: 1\n    b: 2\n").remove(["x", "0", "a"])).toBe("x:\n  - b: 2\n");
  expect(new Source("x:\n  - 1\n  - 2\n").remove(["x", "0"])).toBe("x:\n  - 2\n");
});

test("names are changed, JSON stays JSON, and what cannot be read is said", () => {
  expect(new Source(TEXT).rename(["lines", "rope"], "cable")).toBe(TEXT.replace("  rope:  ", "  cable:  "));
  const json = '{\n  "run": {"kind": "dynamic", "until": 1}\n}\n';
  expect(changed("run.until", "1 s", false, json)).toEqual(["1", '"1 s"']);
  expect(changed("run.until", "2", false, json)).toEqual(["1", "2"]);
  expect(changed("run.at", "[1 s, 2 s]", true, json)).toEqual(["", ', "at": ["1 s","2 s"]']);
  expect(new Source("a: [1\nb: 2").wrong).toMatch(/^line \d: /);
  expect(new Source("a: &x {b: 1}\nc: *x\nd: {<<: *x}\n").kind(["c"])).toBe("alias");
  expect(new Source("a: &x {b: 1}\nd: {<<: *x}\n").merged(["d"], "b")).toBe("1");
  expect(new Source(new Source("a: &x {b: 1}\nc: *x\n").remove(["a"])).wrong).toBe("*x refers to nothing");
});
