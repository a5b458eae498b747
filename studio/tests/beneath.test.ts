import { expect, test } from "vitest";
import { beneath } from "../src/beneath";
import type { Layout } from "../src/film";

test("a load that is exaggerated goes with the line below it, and what hangs from it goes with the load", () => {
  const layout = { axes: ["x", "z"], nodes: [["rope", 0, 3]] } as unknown as Layout;
  const rest = Float32Array.of(0, 0, 1, 0, 2, 0);
  const position = Float32Array.of(0, 0, 1, -2, 2, 0);
  const contacts = Float32Array.of(0.5, -1, Number.NaN, Number.NaN);
  const bodies = Float32Array.of(0.5, -4);
  const frame = { position, contact_position: contacts, body_position: bodies };
  expect([...beneath(layout, frame, rest, contacts)]).toEqual([0.5, 0, Number.NaN, Number.NaN]);
  expect([...beneath(layout, frame, rest, bodies)]).toEqual([0.5, -3]);
  expect([...beneath(layout, frame, rest.slice(2), contacts)]).toEqual([...contacts]); // of another structure
});
