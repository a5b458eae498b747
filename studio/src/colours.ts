import { type Shown, said } from "./picture";
import type { Pen } from "./symbols";

// Stops of Matplotlib's map `plasma`, without its light end, as the figures of the package use it.
const STOPS = [
  [13, 8, 135],
  [84, 2, 163],
  [139, 10, 165],
  [185, 50, 137],
  [219, 92, 104],
  [244, 136, 73],
  [254, 188, 43],
];
// In the dark the low end would vanish.
const BRIGHT = [[92, 110, 245], ...STOPS.slice(2).map(([r, g, b]) => [Math.min(255, r + 20), g + 15, b])];
const COUNT = 64;

function table(stops: number[][]): string[] {
  return Array.from({ length: COUNT }, (_, k) => {
    const at = (k / (COUNT - 1)) * (stops.length - 1);
    const i = Math.min(Math.floor(at), stops.length - 2);
    const part = at - i;
    const mixed = stops[i].map((v, c) => Math.round(v + part * (stops[i + 1][c] - v)));
    return `rgb(${mixed.join(",")})`;
  });
}

const [LIGHT, DARK] = [table(STOPS), table(BRIGHT)];

export function steps(colour: Pen["colour"]): string[] {
  return colour("--dark") === "1" ? DARK : LIGHT;
}

/** Which step of the scale a value has. */
export function stepOf(value: number, low: number, high: number): number {
  if (!(high > low)) return COUNT >> 1;
  return Math.max(0, Math.min(COUNT - 1, Math.round(((value - low) / (high - low)) * (COUNT - 1))));
}

/** Draw the scale of a quantity at the top right, with its range. */
export function bar({ ink, colour }: Pen, label: string, shown: Shown, width: number): void {
  const names = steps(colour);
  const [wide, right] = [Math.min(shown.unit.length < 3 ? 150 : 190, 0.35 * width), width - 26];
  for (let k = 0; k < wide; k++) {
    ink.fillStyle = names[Math.floor((k / wide) * names.length)];
    ink.fillRect(right - wide + k, 22, 1.5, 8);
  }
  ink.fillStyle = colour("--ink");
  const digits = said(shown.low, shown) === said(shown.high, shown) ? 5 : 3; // of a taut string tensions hardly differ
  ink.fillText(said(shown.low, shown, digits), right - wide, 16);
  ink.textAlign = "right";
  ink.fillText(said(shown.high, shown, digits), right, 16);
  ink.fillText(label, right - wide - 8, 30);
  ink.textAlign = "left";
}
