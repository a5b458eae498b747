import { element } from "./player";

/** What a result can be exported as, and how that is called. */
export const OF_RUNS: [string, string][] = [
  ["page", "Page to share"],
  ["report", "Report"],
  ["png", "Figure"],
  ["svg", "SVG"],
  ["gif", "Film"],
  ["csv", "Table"],
  ["xlsx", "Excel"],
];
export const OF_SWEEPS: [string, string][] = OF_RUNS.filter(([kind]) => ["png", "svg", "csv", "xlsx"].includes(kind));

/** Links that export a file of the folder. */
export function links(file: string, kinds: [string, string][]): HTMLElement[] {
  return kinds.map(([kind, text]) => {
    const href = `export?name=${encodeURIComponent(file)}&as=${kind}`;
    return element("a", { href, download: "", class: "export", "data-kind": kind }, text);
  });
}
