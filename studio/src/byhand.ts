import { Source } from "./edits";

/** What was changed by hand of a load and of its line, beside the text: SI units. */
export interface ByHand {
  load: string;
  on: string;
  gravity: number; // m/s^2
  weight?: number; // N
  wind?: number; // m/s, along the first horizontal axis; in space the second
  line: Record<string, number | number[]>;
}

const UNITS: Record<string, string> = {
  tension: "N",
  length: "m",
  mass: "kg/m",
  wind_drag: "m",
  start: "m",
  end: "m",
};
const rounded = (value: number) => Number(value.toPrecision(4)) + 0;
const withUnit = (value: number | number[], unit: string) =>
  typeof value === "number" ? `${rounded(value)} ${unit}` : `[${value.map((v) => `${rounded(v)} ${unit}`).join(", ")}]`;

/** What is other than in the text, in words; empty if nothing is. */
export function saidByHand({ load, on, weight, wind, line }: ByHand): string[] {
  const said = Object.entries(line).map(([key, value]) => `${key} of ${on} ${withUnit(value, UNITS[key] ?? "")}`);
  if (weight !== undefined) said.push(`weight of ${load} ${withUnit(weight, "N")}`);
  if (wind !== undefined) said.push(`wind ${withUnit(wind, "m/s")}`);
  return said;
}

/** The text with what was changed by hand, to four digits. */
export function intoText(text: string, { load, on, gravity, weight, wind, line }: ByHand): string {
  let now = new Source(text);
  const set = (path: string[], value: string, raw = false) => {
    now = new Source(now.set(path, value, { raw }));
  };
  for (const [key, value] of Object.entries(line))
    set(["lines", on, key], withUnit(value, UNITS[key] ?? ""), typeof value !== "number");
  if (weight !== undefined) {
    const force = ["loads", load, "force"];
    const last = now.keys(force).pop();
    if (now.kind(force) === "list" && last !== undefined) set([...force, last], withUnit(-weight, "N"));
    else if (now.kind(["loads", load, "mass"]) === "scalar")
      set(["loads", load, "mass"], withUnit(weight / gravity, "kg"));
    else throw new Error(`the weight of ${load} is a table, or stands elsewhere: change it in the text`);
  }
  if (wind !== undefined) {
    const axes = now.keys(["lines", on, "start"]).length;
    if (!wind && now.kind(["wind"]) === "nothing") return now.text;
    set(["wind", "speed"], withUnit(wind, "m/s"));
    set(["wind", "direction"], axes === 3 ? "[0, 1, 0]" : "[1, 0]", true);
  }
  return now.text;
}
