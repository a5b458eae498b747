import type { Message } from "./messages";
import type { Picture, State } from "./picture";
import { ends } from "./units";

export interface Layout {
  axes: string[];
  path: string;
  nodes: [string, number, number][];
  links: [string, number, number][];
  loads: string[];
  supports: string[];
  cells: [number, number, number][];
}

/** The numbers of one instant, by their names. */
export type Frame = Record<string, Float32Array>;

/** The curves of the places that a file asks for, over the path. */
export interface Curves {
  path: number[];
  groups: { quantity: string; unit: string; curves: Record<string, (number | null)[]> }[];
}

interface Track {
  each: number;
  values: Float32Array<ArrayBuffer>;
}

/** Frames as they come. */
export class Film {
  layout: Layout;
  picture: Picture;
  reference: Float32Array; // m, positions without displacement
  state: State = { factor: 1, height_factor: 1, ranges: {} };
  curves: Curves = { path: [], groups: [] }; // when it has ended
  energies: string[];
  total: number;
  count = 0;
  title = "";
  numbers: Record<string, [number, string]> = {}; // of its summary, when it has ended
  path: Float32Array<ArrayBuffer> = new Float32Array(64);
  private tracks = new Map<string, Track>();
  private known = new Map<string, number[]>(); // what has been found out of the frames that were there
  private envelopes = new Map<string, { low: Float32Array; high: Float32Array; seen: number }>();
  version = 0; // grows with the frames

  constructor({ head, arrays }: Message) {
    this.layout = head.layout as Layout;
    this.picture = head.picture as Picture;
    this.reference = arrays.reference.values;
    this.energies = (head.energies as string[]) ?? [];
    this.total = Math.ceil((head.total as number) / ((head.step as number) || 1));
  }

  add({ head, arrays }: Message): void {
    this.state = head.state as State;
    const { path, ...rest } = arrays;
    if (!path) return; // frames of which none is shown
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
    this.version++;
  }

  /** Take what is known when the run has ended. */
  complete({ title, numbers, curves }: Message["head"]): void {
    this.title = String(title);
    this.numbers = (numbers as Film["numbers"]) ?? {};
    this.curves = (curves as Curves) ?? this.curves;
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

  /** The smallest and the largest of each number of an array over all frames. */
  envelope(name: string): { low: Float32Array; high: Float32Array } {
    const track = this.tracks.get(name) ?? { each: 0, values: new Float32Array(0) };
    const found = this.envelopes.get(name) ?? {
      low: new Float32Array(track.each).fill(Number.POSITIVE_INFINITY),
      high: new Float32Array(track.each).fill(Number.NEGATIVE_INFINITY),
      seen: 0,
    };
    const { low, high } = found;
    for (; found.seen < this.count; found.seen++)
      for (let i = 0, at = found.seen * track.each; i < track.each; i++, at++) {
        const value = track.values[at];
        if (value < low[i]) low[i] = value;
        if (value > high[i]) high[i] = value;
      }
    this.envelopes.set(name, found);
    return found;
  }

  /** The largest size of the numbers of an array over all frames. */
  most(name: string): number {
    const { low, high } = this.envelope(name);
    return Math.max(0, -ends(low)[0], ends(high)[1]);
  }

  /** The smallest and the largest coordinate along an axis of what is drawn, displacements being so much larger. */
  box(axis: number, factor: number): [number, number] {
    const axes = this.layout.axes.length;
    const places: number[] = [];
    const names = factor === 1 ? ["position", "contact_position", "body_position"] : ["position"];
    for (const name of names) {
      const { low, high } = this.envelope(name);
      for (let i = axis; i < low.length; i += axes) {
        if (!(high[i] >= low[i])) continue;
        const at = name === "position" ? this.reference[i] : low[i];
        places.push(at, at + factor * (low[i] - at), at + factor * (high[i] - at));
      }
    }
    return places.length ? ends(places) : [0, 1];
  }
}

function grown(values: Float32Array<ArrayBuffer>, used: number, more: number): Float32Array<ArrayBuffer> {
  if (used + more <= values.length) return values;
  const larger = new Float32Array(Math.max(2 * values.length, used + more));
  larger.set(values.subarray(0, used));
  return larger;
}
