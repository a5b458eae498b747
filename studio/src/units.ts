/** A number as an engineer writes it: three digits (or more), and a unit with a prefix. */
export function written(value: number, unit: string, digits = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return unit ? `0 ${unit}` : "0";
  const size = Math.abs(value);
  const [factor, prefix] =
    unit === "" || size === 0
      ? [1, ""]
      : size >= 1e6
        ? [1e-6, "M"]
        : size >= 1e3 && unit !== "m"
          ? [1e-3, "k"]
          : size < 0.1 && unit !== "kg"
            ? [1e3, "m"]
            : [1, ""];
  const scaled = value * factor;
  const before = Math.abs(scaled) >= 1 ? Math.floor(Math.log10(Math.abs(scaled))) + 1 : 0;
  const text = scaled.toFixed(Math.min(Math.max(digits - before, 0), digits)).replace("-", "−");
  return `${text}${unit ? ` ${prefix}${unit}` : ""}`;
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
