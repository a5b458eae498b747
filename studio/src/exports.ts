import { element } from "./player";

type Kinds = [string, [string, string][]][];

/** What a result can be exported as, in groups: the kind that the server knows, and how it is called. */
export const OF_RUNS: Kinds = [
  [
    "",
    [
      ["page", "Page to share"],
      ["report", "Report"],
    ],
  ],
  [
    "Figure",
    [
      ["png", "PNG"],
      ["svg", "SVG"],
      ["pdf", "PDF"],
    ],
  ],
  [
    "Film",
    [
      ["gif", "GIF"],
      ["mp4", "MP4"],
    ],
  ],
  [
    "Tables",
    [
      ["xlsx", "Excel"],
      ["zip", "CSV"],
    ],
  ],
];
export const OF_SWEEPS: Kinds = [
  OF_RUNS[1],
  [
    "Table",
    [
      ["xlsx", "Excel"],
      ["csv", "CSV"],
    ],
  ],
];

type Tell = (text: string, bad?: boolean) => void;

/** Links that export a file of the folder; what they cannot do is told on the page. */
export function links(file: string, groups: Kinds, tell: Tell): HTMLElement[] {
  return groups.map(([title, kinds]) => {
    const found = kinds.map(([kind, text]) => {
      const href = `export?name=${encodeURIComponent(file)}&as=${kind}`;
      const link = element("a", { href, download: "", class: "export", "data-kind": kind }, text);
      if (title) link.setAttribute("aria-label", `${title}, ${text}`);
      link.onclick = (event) => {
        event.preventDefault();
        if (!link.ariaBusy) fetched(link, `${title} ${text}`.trim(), tell);
      };
      return link;
    });
    return element("span", { class: "exports" }, title, ...found);
  });
}

async function fetched(link: HTMLAnchorElement, what: string, tell: Tell): Promise<void> {
  link.ariaBusy = "true";
  tell(`${what}: being made`);
  try {
    const answer = await fetch(link.href);
    if (!answer.ok) return tell(await answer.text(), true);
    const name = /filename="(.+)"/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? "";
    const href = URL.createObjectURL(await answer.blob());
    element("a", { href, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(href), 60_000);
    tell(`${name} is made`);
  } catch {
    tell(`${what}: the server has gone`, true);
  } finally {
    link.ariaBusy = null;
  }
}
