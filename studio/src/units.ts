/** A number as an engineer writes it: three digits (or more), and a unit with a prefix. */
export function written(value: number, unit: string, digits = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return `0 ${unit}`.trim();
  const [factor, prefix] = scaled(Math.abs(value), unit);
  return `${rounded(value * factor, digits)}${unit ? ` ${prefix}${unit}` : ""}`;
}

function scaled(size: number, unit: string): [number, string] {
  if (unit !== "" && size >= 1e6) return [1e-6, "M"];
  if (!["", "m"].includes(unit) && size >= 1e3) return [1e-3, "k"];
  return !["", "kg"].includes(unit) && size < 0.1 ? [1e3, "m"] : [1, ""];
}

/** A number to so many digits, of small ones so many decimals. */
export function rounded(value: number, digits: number): string {
  const decimals = Math.min(Math.max(digits - 1 - Math.floor(Math.log10(Math.abs(value))), 0), digits);
  return value.toFixed(decimals).replace("-", "−");
}

/** A number without the zeros at its end. */
export function short(value: number, digits = 6): string {
  return `${Number(value.toPrecision(digits))}`.replace("-", "−");
}

/** The smallest and the largest of some numbers that are finite; infinite where there are none. */
export function ends(values: Iterable<number>): [number, number] {
  let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const value of values) {
    if (value < low && Number.isFinite(value)) low = value;
    if (value > high && Number.isFinite(value)) high = value;
  }
  return [low, high];
}

/** Round steps of a scale. */
export function ticks(low: number, high: number, about: number): number[] {
  const raw = (high - low) / about;
  if (!(raw > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw) ?? raw;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step + 0);
  return found;
}
