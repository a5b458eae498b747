import { expect, test } from "vitest";
import { type ByHand, intoText, saidByHand } from "../src/byhand";

const TEXT = `lines:
  rope:
    start: [0 m, 0 m]
    end: [20 m, 0 m]
    tension: 8 kN    # at rest
loads:
  her: {kind: force, on: rope, force: [0 N, -200 N], travel: {speed: 1 m/s}}
  cart: {kind: mass, on: rope, mass: 10 kg, travel: {speed: 1 m/s}}
`;
const hand: ByHand = { load: "her", on: "rope", gravity: 10, line: {} };

test("what was changed by hand goes where it stands in the text", () => {
  const all: ByHand = { ...hand, weight: 312.34567, wind: 12, line: { tension: 4953.4321, end: [19, -1] } };
  const text = intoText(TEXT, all);
  expect(text).toContain("tension: 4953 N    # at rest");
  expect(text).toContain("end: [19 m, -1 m]");
  expect(text).toContain("force: [0 N, -312.3 N]");
  expect(text).toMatch(/wind:\n {2}speed: 12 m\/s\n {2}direction: \[1, 0\]/);
  expect(saidByHand(all).join("; ")).toBe(
    "tension of rope 4953 N; end of rope [19 m, -1 m]; weight of her 312.3 N; wind 12 m/s",
  );
});

test("a mass weighs what was chosen, and calm air needs no block", () => {
  expect(intoText(TEXT, { ...hand, load: "cart", weight: 50, wind: 0 })).toBe(TEXT.replace("10 kg", "5 kg"));
  expect(saidByHand(hand)).toEqual([]);
});

test("a force that is a table is not written over", () => {
  const table = TEXT.replace("[0 N, -200 N]", "{time: [0 s], value: [[0 N, -200 N]]}");
  expect(() => intoText(table, { ...hand, weight: 50 })).toThrow(/table/);
});
