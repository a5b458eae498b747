import { element, folded } from "./dom";
import type { Doubt } from "./doubts";
import { Film } from "./film";
import type { Message } from "./messages";
import { Player } from "./player";
import "./style.css";

/**
 * A run as a page or a notebook is given it: the messages of `ropewalk.studio.streams.of_result`, the first of them at
 * least, and how it ended.
 */
export interface Run {
  messages: Message[];
  ended: Record<string, unknown>;
}

export function filmOf(run: Run): Film {
  const film = new Film(run.messages[0]);
  film.complete(run.ended);
  for (const message of run.messages.slice(1)) film.add(message);
  return film;
}

/** Shows a run that is over, and perhaps another one faintly over it, without a server. */
export class Viewer {
  readonly parts: HTMLElement[];
  private player: Player;
  private film: Film;

  constructor(run: Run, beside?: Run) {
    const { title, outcome, summary, doubts } = run.ended;
    this.player = new Player(`Film of ${title}`);
    const { canvas, bar, plotted, numbers, stage } = this.player;
    const own = (doubts as Doubt[]) ?? [];
    stage.doubted = own.map(({ key }) => key);
    const distrusted = [
      ...own.map(({ text }) => text),
      ...((beside?.ended.doubts as Doubt[]) ?? []).map(({ text }) => `${beside?.ended.title}: ${text}`),
    ];
    const over = beside ? [element("span", { class: "hint" }, `faint: ${beside.ended.title}`)] : [];
    const warnings = distrusted.map((text) => element("p", { class: "doubt" }, text));
    const section = element("section", { class: "stage" }, canvas, bar, plotted);
    this.parts = [
      element("header", {}, element("h1", {}, String(title)), element("span", {}, String(outcome)), ...over),
      element("main", {}, section, element("aside", {}, ...warnings, numbers, ...folded(String(summary)))),
    ];
    this.film = filmOf(run);
    this.player.load(this.film, beside && filmOf(beside));
    this.player.mark(own);
  }

  /** Another message of the run has come. */
  more(message: Message): void {
    this.film.add(message);
    this.player.more();
  }

  /** Play and step by keys; true if the key meant something. */
  key(event: KeyboardEvent): boolean {
    const isControl = event.target instanceof HTMLSelectElement || event.target instanceof HTMLButtonElement;
    if (isControl || !this.player.press(event.key)) return false;
    event.preventDefault();
    return true;
  }

  close(): void {
    this.player.leave();
    this.player.stage.close();
  }
}
