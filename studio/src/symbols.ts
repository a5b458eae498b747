import type { Mark } from "./picture";

export type Spot = [number, number]; // pixels

export interface Pen {
  ink: CanvasRenderingContext2D;
  colour: (name: string) => string;
}

/** What symbols are drawn on, and where contacts, bodies and nodes are in the picture. */
export interface Surface extends Pen {
  contact: (k: number) => Spot;
  wheel: (k: number) => Spot; // also before and behind the line
  body: (i: number) => Spot;
  node: (i: number) => Spot;
  point: (at: number[]) => Spot;
  metre: number; // pixels
}

const between = (value: number, low: number, high: number) => Math.min(Math.max(value, low), high);
const known = (spots: Spot[]) => spots.filter(([x, z]) => Number.isFinite(x) && Number.isFinite(z));
const middle = (spots: Spot[]): Spot =>
  [0, 1].map((a) => spots.reduce((sum, p) => sum + p[a], 0) / spots.length) as Spot;

/** Draw a symbol as what it is, at a legible size. */
export function symbol(on: Surface, mark: Mark): void {
  const { ink, colour } = on;
  const contacts = known(
    (mark.contacts ?? []).map(mark.kind === "coach" || mark.kind === "vehicle" ? on.wheel : on.contact),
  );
  const bodies = known((mark.bodies ?? []).map(on.body));
  ink.strokeStyle = ink.fillStyle = colour("--load");
  ink.lineWidth = 1.5;
  const draw = DRAWN[mark.kind] ?? mass;
  draw(on, contacts, bodies, mark);
}

/** Kinds that lines are drawn over. */
export const BEHIND = ["tower", "saddle", "sheave", "dropper"];

type Drawing = (on: Surface, contacts: Spot[], bodies: Spot[], mark: Mark) => void;

const DRAWN: Record<string, Drawing> = {
  coach: vehicle,
  vehicle,
  cabin: hung,
  trolley: hung,
  person,
  pantograph,
  tower: post,
  saddle: post,
  sheave: post,
  bearing: (on, _, __, { at = [] }) => triangle(on, on.point(at)),
  dropper,
  place,
};

const pairs = (...values: number[]) => values.flatMap((value, i): Spot[] => (i % 2 ? [] : [[value, values[i + 1]]]));

function shape(ink: CanvasRenderingContext2D, ...spots: Spot[]): void {
  ink.beginPath();
  for (const spot of spots) ink.lineTo(...spot);
  ink.closePath();
}

export function line(ink: CanvasRenderingContext2D, ...spots: Spot[]): void {
  ink.beginPath();
  for (const spot of spots) ink.lineTo(...spot);
  ink.stroke();
}

/** An arrow from a spot along a unit vector. */
export function arrow(ink: CanvasRenderingContext2D, [x, z]: Spot, [a, b]: Spot, length: number, stroke: string): void {
  const [ex, ez] = [x + a * length, z + b * length];
  ink.strokeStyle = ink.fillStyle = stroke;
  ink.lineWidth = 2;
  line(ink, [x, z], [ex - 6 * a, ez - 6 * b]);
  const [left, right] = [-5, 5].map((side): Spot => [ex - 10 * a + side * b, ez - 10 * b - side * a]);
  shape(ink, [ex, ez], left, right);
  ink.fill();
}

export function dot(ink: CanvasRenderingContext2D, [x, z]: Spot, radius: number): void {
  ink.beginPath();
  ink.arc(x, z, radius, 0, 2 * Math.PI);
  ink.fill();
}

/** A text with a margin in the colour of the ground. */
export function label({ ink, colour }: Pen, text: string, [x, z]: Spot, fill: string): void {
  ink.lineWidth = 3;
  ink.strokeStyle = colour("--panel");
  ink.fillStyle = fill;
  ink.strokeText(text, x, z);
  ink.fillText(text, x, z);
}

/** A box on wheels that stand on the line. */
function vehicle({ ink, colour, metre }: Surface, wheels: Spot[]): void {
  if (!wheels.length) return;
  const sorted = [...wheels].sort((a, b) => a[0] - b[0]);
  const [a, b] = [sorted[0], sorted[sorted.length - 1]];
  const long = Math.hypot(b[0] - a[0], b[1] - a[1]);
  const [c, s] = long > 0 ? [(b[0] - a[0]) / long, (b[1] - a[1]) / long] : [1, 0];
  const [radius, high] = [between(0.45 * metre, 2.5, 7), between(3 * metre, 14, 40)];
  const over = sorted.length > 1 ? Math.max(0.1 * long, 7) : 20;
  const [base, top, end] = [1.7 * radius, 1.7 * radius + high, long + over];
  const corners = pairs(-over, base, end, base, end, top - 8, end - 4, top, 4 - over, top, -over, top - 8);
  shape(ink, ...corners.map(([x, up]): Spot => [a[0] + x * c + up * s, a[1] + x * s - up * c]));
  ink.fillStyle = colour("--panel");
  ink.fill();
  ink.globalAlpha = 0.25;
  ink.fillStyle = colour("--load");
  ink.fill();
  ink.globalAlpha = 1;
  ink.stroke();
  for (const wheel of sorted) dot(ink, [wheel[0] + radius * s, wheel[1] - radius * c], radius);
}

/** Wheels on the line, and a cabin or a payload below. */
function hung({ ink, metre }: Surface, wheels: Spot[], bodies: Spot[], { kind }: Mark): void {
  for (const [x, z] of wheels) dot(ink, [x, z - 3.5], 3.5);
  if (!wheels.length) return;
  const top = middle(wheels);
  if (wheels.length > 1) line(ink, ...wheels.map(([x, z]): Spot => [x, z - 3.5]));
  for (const place of bodies) {
    const far = Math.hypot(place[0] - top[0], place[1] - top[1]) || 1;
    const body = top.map((value, a) => value + (place[a] - value) * Math.max(24 / far, 1)) as Spot; // legible
    line(ink, top, body);
    const angle = Math.atan2(top[0] - body[0], body[1] - top[1]);
    const [wide, high] = kind === "cabin" ? [between(2.4 * metre, 16, 44), between(2.2 * metre, 14, 40)] : [12, 12];
    ink.save();
    ink.translate(...body);
    ink.rotate(angle);
    ink.fillRect(-wide / 2, -high / 2, wide, high);
    ink.restore();
  }
}

/** A person who stands on the line, or hangs from it. */
function person({ ink }: Surface, feet: Spot[], bodies: Spot[]): void {
  const hangs = bodies.length > 0 && feet.length > 0 && bodies[0][1] > feet[0][1];
  if (hangs) line(ink, feet[0], bodies[0]);
  if (!feet.length && !bodies.length) return;
  const [x, z] = hangs || !feet.length ? [bodies[0][0], bodies[0][1] + 12] : middle(feet);
  ink.lineWidth = 2;
  dot(ink, [x, z - 24], 3.5);
  line(ink, [x, z - 20], [x, z - 10]);
  line(ink, [x - 6, z - (hangs ? 24 : 12)], [x, z - 18], [x + 6, z - (hangs ? 24 : 12)]);
  line(ink, [x - 4, z], [x, z - 10], [x + 4, z]);
}

/** Head, arms and base of a pantograph below the wire. */
function pantograph({ ink }: Surface, heads: Spot[]): void {
  if (!heads.length) return;
  const [x, z] = middle(heads);
  const half = 13 + (Math.max(...heads.map((p) => p[0])) - Math.min(...heads.map((p) => p[0]))) / 2;
  ink.lineWidth = 3;
  line(ink, [x - half - 4, z + 6], [x - half, z + 2], [x + half, z + 2], [x + half + 4, z + 6]);
  ink.lineWidth = 2;
  line(ink, [x, z + 3], [x - 18, z + 24], [x + 4, z + 44]);
  ink.fillRect(x - 14, z + 43, 28, 5);
}

function mass({ ink }: Surface, contacts: Spot[], bodies: Spot[]): void {
  for (const spot of contacts) dot(ink, spot, 6.5);
  for (const spot of bodies) dot(ink, spot, 4);
}

/** A tower with what carries the line on it. */
function post(
  { ink, colour, point, metre }: Surface,
  _: Spot[],
  __: Spot[],
  { kind, at = [], size = 0, foot }: Mark,
): void {
  const [x, z] = point(at);
  ink.strokeStyle = colour("--faint");
  if (foot !== undefined) {
    const [x1, z1] = point([...at.slice(0, -1), foot]);
    const [bays, wide] = [between(Math.round(Math.abs(z1 - z) / 22), 1, 12), (part: number) => 3 + 6 * part];
    const spot = (k: number, side: number): Spot => {
      const part = k / bays;
      return [x + part * (x1 - x) + side * wide(part), z + part * (z1 - z)];
    };
    for (const side of [-1, 1]) {
      line(ink, spot(0, side), spot(bays, side));
      ink.lineWidth = 1;
      for (let k = 0; k < bays; k++) line(ink, spot(k, side), spot(k + 1, -side));
      ink.lineWidth = 2;
    }
    line(ink, [x1 - 16, z1], [x1 + 16, z1]);
  }
  ink.strokeStyle = colour("--ink");
  const radius = kind === "saddle" ? Math.max(size * metre, 16) : 6;
  const half = kind === "saddle" ? Math.min(Math.PI / 3, 26 / radius) : Math.PI;
  ink.lineWidth = 4;
  ink.beginPath();
  if (kind !== "tower") ink.arc(x, z + radius, radius, -0.5 * Math.PI - half, -0.5 * Math.PI + half);
  ink.stroke();
}

function dropper({ ink, colour, node }: Surface, _: Spot[], __: Spot[], { nodes = [] }: Mark): void {
  ink.strokeStyle = colour("--faint");
  ink.lineWidth = 1;
  line(ink, ...nodes.map(node));
}

/** A place whose curve is asked for. */
function place({ ink, colour, node }: Surface, _: Spot[], __: Spot[], { nodes = [], name }: Mark): void {
  const [x, z] = node(nodes[0]);
  ink.fillStyle = colour("--accent");
  shape(ink, [x, z + 5], [x - 5, z + 13], [x + 5, z + 13]);
  ink.fill();
  ink.textAlign = "center";
  ink.fillText(name, x, z + 26);
  ink.textAlign = "left";
}

/** A support below a point of a line. */
export function triangle({ ink, colour }: Pen, [x, z]: Spot): void {
  shape(ink, [x, z], [x - 8, z + 14], [x + 8, z + 14]);
  ink.fillStyle = colour("--panel");
  ink.fill();
  ink.strokeStyle = colour("--ink");
  ink.lineWidth = 1.5;
  ink.stroke();
}
