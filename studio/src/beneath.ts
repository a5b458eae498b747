import type { Frame, Layout } from "./film";

/** Where loads and bodies would be without the displacement of their lines: what they are exaggerated from, with these.
 *
 * A load goes with the point of a line that is nearest to it, and so does a body with that nearest to its nearest load.
 */
export function beneath(layout: Layout, frame: Frame, rest: Float32Array, places: Float32Array): Float32Array {
  const axes = layout.axes.length;
  const found = places.slice();
  if (frame.position.length !== rest.length) return found; // of another structure
  const loads = pointsOf(frame.contact_position ?? [], axes);
  pointsOf(places, axes).forEach((place, k) => {
    const near = places === frame.contact_position ? place : nearest(loads, place);
    if (Number.isNaN(place[0]) || !near) return;
    const moved = displacement(layout, frame.position, rest, near);
    for (let a = 0; a < axes; a++) found[axes * k + a] -= moved[a];
  });
  return found;
}

/** By how much the point of a line that is nearest to a place has been displaced. */
function displacement(layout: Layout, position: Float32Array, rest: Float32Array, place: number[]): number[] {
  const axes = place.length;
  let least = Number.POSITIVE_INFINITY;
  let best = place.map(() => 0);
  for (const [, first, count] of layout.nodes)
    for (let i = axes * first; i < axes * (first + count - 1); i += axes) {
      const d = place.map((_, a) => position[i + axes + a] - position[i + a]);
      const square = dot(d, d);
      const along = dot(
        d,
        place.map((value, a) => value - position[i + a]),
      );
      const s = square > 0 ? Math.min(Math.max(along / square, 0), 1) : 0;
      const here = d.map((value, a) => position[i + a] + s * value);
      const far = apart(here, place);
      if (far >= least) continue;
      least = far;
      best = here.map((value, a) => value - rest[i + a] - s * (rest[i + axes + a] - rest[i + a]));
    }
  return best;
}

function pointsOf(values: ArrayLike<number>, axes: number): number[][] {
  return Array.from({ length: values.length / axes }, (_, k) =>
    Array.from({ length: axes }, (_, a) => values[axes * k + a]),
  );
}

function nearest(points: number[][], place: number[]): number[] | undefined {
  const there = points.filter((point) => !Number.isNaN(point[0]));
  return there.reduce<number[] | undefined>(
    (best, point) => (best && apart(best, place) <= apart(point, place) ? best : point),
    undefined,
  );
}

const dot = (a: number[], b: number[]) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const apart = (a: number[], b: number[]) => a.reduce((sum, value, k) => sum + (value - b[k]) ** 2, 0);
