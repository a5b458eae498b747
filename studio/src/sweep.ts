import type { Sweep } from "./cases";
import { type Connection, wrongOf } from "./connection";
import { element } from "./dom";
import { links, OF_SWEEPS } from "./exports";
import { SweepMap } from "./map";

/** What a sweep needs of the page around it. */
export interface Page {
  tell: (text: string, bad?: boolean) => void;
  see: (text: string, title: string) => void; // compute a scenario and show it
  open: (text: string) => void; // put a scenario into the editor
}

/** Sweeps in the page: computed here or opened, as a map whose cases can be seen. */
export class SweepTab {
  private exports = element("div", { class: "row" });
  private shown = element("div");
  readonly map: SweepMap;
  private file = "";
  private hint = element(
    "p",
    { class: "hint" },
    "Computes all cases of the block  sweep  of the scenario, and keeps them in the folder. Or open a sweep that is there.",
  );

  constructor(
    place: HTMLElement,
    private server: Connection,
    compute: HTMLElement,
    private page: Page,
  ) {
    this.map = new SweepMap(this.shown, {
      see: (row) => this.fetched(row, page.see),
      open: (row) => this.fetched(row, page.open),
    });
    place.append(element("div", { class: "row" }, compute), this.hint, this.exports, this.shown);
  }

  show(file: string, sweep: Sweep): void {
    this.file = file;
    this.hint.hidden = true;
    this.exports.replaceChildren(...links(file, OF_SWEEPS, this.page.tell));
    this.map.show(sweep);
  }

  private async fetched(row: number, then: (text: string, title: string) => void): Promise<void> {
    const { head } = await this.server.ask("case", { name: this.file, row });
    const wrong = wrongOf(head);
    if (wrong) this.page.tell(wrong, true);
    else then(String(head.text), String(head.title));
  }
}
