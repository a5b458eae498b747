type Place = [number, number, number];

/** Where the camera can be put: the direction from what it looks at, and whether its rays are parallel. */
export const VIEWS: Record<string, { title: string; direction: Place; isParallel: boolean }> = {
  Perspective: {
    title: "From aside; drag to turn, wheel to come nearer, right button to move (Shift + arrow keys, + and −)",
    direction: [0.55, -1, 0.5],
    isParallel: false,
  },
  Plan: { title: "From above, x to the right", direction: [0, -1e-6, 1], isParallel: true },
  Elevation: { title: "From the front, x to the right", direction: [0, -1, 0], isParallel: true },
  Side: { title: "Along x, y to the right", direction: [1, 0, 0], isParallel: true },
};

/** A camera's place, seen from what it looks at, turned about the vertical and towards it, in rad. */
export function turned([x, y, z]: Place, about: number, down: number): Place {
  const r = Math.hypot(x, y, z);
  const azimuth = Math.atan2(y, x) + about;
  const polar = Math.min(Math.max(Math.acos(z / r) + down, 1e-3), Math.PI - 1e-3);
  return [r * Math.sin(polar) * Math.cos(azimuth), r * Math.sin(polar) * Math.sin(azimuth), r * Math.cos(polar)];
}

/** The lowest and the highest of all coordinates. */
export function boxOf(position: Float32Array): [Place, Place] {
  const low: Place = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  const high: Place = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (let i = 0; i < position.length; i++) {
    const a = i % 3;
    if (position[i] < low[a]) low[a] = position[i];
    if (position[i] > high[a]) high[a] = position[i];
  }
  return [low, high];
}
