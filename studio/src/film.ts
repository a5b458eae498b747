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
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.path[middle] <= path + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  get end(): number {
    return this.count ? this.path[this.count - 1] : 0;
  }

  /** A number of every frame. */
  series(of: (frame: Frame) => number): number[] {
    return Array.from({ length: this.count }, (_, i) => of(this.frame(i)));
  }

  /** The smallest and the largest of some numbers over all frames; of positions by axis. */
  range(name: string, axis = 0, axes = 1): [number, number] {
    const track = this.tracks.get(name);
    let low = Number.POSITIVE_INFINITY;
    let high = Number.NEGATIVE_INFINITY;
    if (track)
      for (let i = axis; i < this.count * track.each; i += axes) {
        const value = track.values[i];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    return low <= high ? [low, high] : [0, 1];
  }
}

function grown(values: Float32Array<ArrayBuffer>, used: number, more: number): Float32Array<ArrayBuffer> {
  if (used + more <= values.length) return values;
  const larger = new Float32Array(Math.max(2 * values.length, used + more));
  larger.set(values.subarray(0, used));
  return larger;
}
