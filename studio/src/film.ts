import type { Arrays, Message } from "./messages";

export interface Layout {
  axes: string[];
  path: string;
  nodes: [string, number, number][];
  links: [string, number, number][];
  loads: string[];
  supports: string[];
  bodies: string[];
  cells: [number, number, number][];
}

/** The numbers of one instant, by their names. */
export type Frame = Record<string, Float32Array>;

/** What a structure is coloured by: tensions of links in N; of nets, the larger of both directions, in N/m. */
export function tensionsOf(layout: Layout, frame: Frame): { values: Float32Array; unit: string } {
  const { tension, cell_tension } = frame;
  if (tension?.length || !cell_tension) return { values: tension ?? new Float32Array(0), unit: "N" };
  const values = new Float32Array(layout.cells.length);
  const each = cell_tension.length / values.length;
  for (let k = 0; k < values.length; k++) {
    values[k] = cell_tension[k * each];
    for (let i = k * each + 1; i < (k + 1) * each; i++) values[k] = Math.max(values[k], cell_tension[i]);
  }
  return { values, unit: "N/m" };
}

/** The largest of these tensions, in N or N/m. */
export function largestTension({ tension, cell_tension }: Frame): number {
  let most = Number.NEGATIVE_INFINITY;
  const values = tension?.length ? tension : (cell_tension ?? []);
  for (let i = 0; i < values.length; i++) if (values[i] > most) most = values[i];
  return most;
}

interface Track {
  each: number;
  values: Float32Array<ArrayBuffer>;
}

/** Frames as they come. */
export class Film {
  layout: Layout;
  energies: string[];
  total: number;
  count = 0;
  title = "";
  numbers: Record<string, [number, string]> = {}; // of its summary, when it has ended
  path: Float32Array<ArrayBuffer> = new Float32Array(64);
  private tracks = new Map<string, Track>();
  private known = new Map<string, number[]>(); // what has been found out of the frames that were there
  private ranges = new Map<string, { low: number; high: number; seen: number }>();
  private changed = 0;

  constructor(head: Message["head"]) {
    this.layout = head.layout as Layout;
    this.energies = (head.energies as string[]) ?? [];
    this.total = Math.ceil((head.total as number) / ((head.step as number) || 1));
  }

  add(arrays: Arrays): void {
    const { path, ...rest } = arrays;
    const many = path.values.length;
    this.path = grown(this.path, this.count, many);
    this.path.set(path.values, this.count);
    for (const [name, { values }] of Object.entries(rest)) {
      const each = values.length / many;
      const track = this.tracks.get(name) ?? { each, values: new Float32Array(64 * each) };
      track.values = grown(track.values, this.count * each, many * each);
      track.values.set(values, this.count * each);
      this.tracks.set(name, track);
    }
    this.count += many;
    this.changed++;
  }

  get version(): number {
    return this.changed;
  }

  frame(i: number): Frame {
    const found: Frame = {};
    for (const [name, { each, values }] of this.tracks) found[name] = values.subarray(i * each, (i + 1) * each);
    return found;
  }

  /** The last frame at an instant or before it. */
  at(path: number): number {
    const rounded = Math.fround(path + 1e-9); // as the instants are
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.path[middle] <= rounded) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  get end(): number {
    return this.count ? this.path[this.count - 1] : 0;
  }

  /** A number of every frame; its name tells it from others, so that each frame is asked once only. */
  series(name: string, of: (frame: Frame) => number): number[] {
    const found = this.known.get(name) ?? [];
    this.known.set(name, found);
    while (found.length < this.count) found.push(of(this.frame(found.length)));
    return found;
  }

  has(name: string): boolean {
    return this.tracks.has(name);
  }

  /** The smallest and the largest of some numbers over all frames; of positions by axis. */
  range(name: string, axis = 0, axes = 1): [number, number] {
    const track = this.tracks.get(name);
    if (!track) return [0, 1];
    const key = `${name} ${axis} ${axes}`;
    let { low, high, seen } = this.ranges.get(key) ?? {
      low: Number.POSITIVE_INFINITY,
      high: Number.NEGATIVE_INFINITY,
      seen: axis,
    };
    for (; seen < this.count * track.each; seen += axes) {
      const value = track.values[seen];
      if (value < low) low = value;
      if (value > high) high = value;
    }
    this.ranges.set(key, { low, high, seen });
    return low <= high ? [low, high] : [0, 1];
  }
}

function grown(values: Float32Array<ArrayBuffer>, used: number, more: number): Float32Array<ArrayBuffer> {
  if (used + more <= values.length) return values;
  const larger = new Float32Array(Math.max(2 * values.length, used + more));
  larger.set(values.subarray(0, used));
  return larger;
}
