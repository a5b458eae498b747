import { element } from "./dom";

type Kinds = [string, [string, string][]][];

/** Formats of the export of a run, in groups: the format as the server names it, and its label. */
export const OF_RUNS: Kinds = [
  ["", Object.entries({ page: "Interactive page", report: "Report" })],
  ["Figure", Object.entries({ png: "PNG", svg: "SVG", pdf: "PDF" })],
  ["Film", Object.entries({ gif: "GIF", mp4: "MP4" })],
  ["Tables", Object.entries({ xlsx: "Excel", zip: "CSV" })],
];
export const OF_SWEEPS: Kinds = [OF_RUNS[1], ["Table", Object.entries({ xlsx: "Excel", csv: "CSV" })]];
const TITLES: Record<string, string> = {
  page: "One HTML file with the film, its curves and numbers; it opens offline",
  report: "One HTML file to print, with the scenario, tables and figures",
};

type Tell = (text: string, bad?: boolean) => void;

/** Links that export a file of the folder; failures are reported on the page. */
export function links(file: string, groups: Kinds, tell: Tell): HTMLElement[] {
  const parts = groups.map(([title, kinds]) => {
    const found = kinds.map(([kind, text]) => {
      const href = `export?name=${encodeURIComponent(file)}&as=${kind}`;
      const link = element("a", { href, download: "", class: "export", "data-kind": kind }, text);
      if (title) link.setAttribute("aria-label", `${title}, ${text}`);
      else link.title = TITLES[kind];
      link.onclick = (event) => {
        event.preventDefault();
        if (!link.ariaBusy) fetched(link, `${title} ${text}`.trim(), tell);
      };
      return link;
    });
    return element("span", { class: "exports" }, title, ...found);
  });
  return [element("strong", {}, file), ...parts];
}

async function fetched(link: HTMLAnchorElement, what: string, tell: Tell): Promise<void> {
  link.ariaBusy = "true";
  tell(`${what}: in preparation`);
  try {
    const answer = await fetch(link.href);
    if (!answer.ok) return tell(await answer.text(), true);
    const name = /filename="(.+)"/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? "";
    const href = URL.createObjectURL(await answer.blob());
    element("a", { href, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(href), 60_000);
    tell(`${name} downloaded`);
  } catch {
    tell(`${what}: no connection to the server`, true);
  } finally {
    link.ariaBusy = null;
  }
}
