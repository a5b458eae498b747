import { told } from "./cases";
import { element } from "./dom";
import { short } from "./units";

/** Numbers of a run by their names, with their units. */
export type Numbers = Record<string, [number, string]>;

/** Simpler models beside the full one, as `ropewalk compare` finds them. */
export interface Models {
  title: string;
  tables: string[][][];
  verdict: string;
  picture: string; // SVG
}

/** What two runs have in common and differ in: name, the one, the other, and by how much of the other. */
export function differences(now: Numbers, beside: Numbers): [string, string, string, string][] {
  const found: [string, string, string, string][] = [];
  for (const [name, [value, unit]] of Object.entries(now)) {
    const other = beside[name];
    if (!other || other[1] !== unit) continue;
    const size = Math.max(Math.abs(value), Math.abs(other[0]));
    if (!(Math.abs(value - other[0]) > 1e-6 * size)) continue;
    const part = (100 * (value - other[0])) / Math.abs(other[0]);
    const isRounding = Math.abs(other[0]) <= 1e-9 * size;
    found.push([name, told(value, unit), told(other[0], unit), isRounding ? "–" : `${short(part, 3)} %`]);
  }
  return found;
}

/** Two runs beside each other, in numbers. */
export function besides(now: Numbers, beside: Numbers, title: string, other: string): HTMLElement {
  const titles = title === other ? ["this run", "beside"] : [title, other];
  const rows = differences(now, beside);
  const inside = rows.length
    ? tableOf([["quantity", ...titles, "difference"], ...rows])
    : element("p", { class: "hint" }, "No number differs by more than a millionth.");
  return element("section", { class: "compared" }, element("h2", {}, "This run, and the one beside it"), inside);
}

/** What comes of simpler models. */
export function models(found: Models): HTMLElement {
  const picture = element("img", { alt: `Simpler models of ${found.title}`, class: "figure" });
  picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(found.picture)}`;
  return element(
    "section",
    { class: "compared" },
    element("h2", {}, "Simpler models"),
    element("p", { class: "verdict" }, found.verdict),
    picture,
    ...found.tables.map(tableOf),
  );
}

function tableOf([head, ...rows]: string[][]): HTMLElement {
  const header = (text: string) => element("th", { scope: "col" }, text);
  const lines = rows.map(([name, ...cells]) =>
    element("tr", {}, header(name), ...cells.map((text) => element("td", {}, text))),
  );
  const titles = element("thead", {}, element("tr", {}, ...head.map(header)));
  const table = element("table", {}, titles, element("tbody", {}, ...lines));
  return element("div", { class: "scroll", tabindex: "0" }, table);
}
