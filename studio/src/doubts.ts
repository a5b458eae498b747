import { button, element } from "./dom";

/** A reason not to trust a run, as `ropewalk.studio.streams` tells it: when, and which key of the scenario is to blame. */
export interface Doubt {
  text: string;
  time: number | null; // s
  key: string;
}

/** What doubts lead to. */
export interface Ways {
  go: (time: number) => void;
  open: (key: string) => void;
}

/** Doubts and notes of a run as a list, with ways to when and where they arise. */
export function listed(doubts: Doubt[], notes: string[], ways: Ways): HTMLElement[] {
  return [
    ...doubts.map((doubt) => {
      const made = element("p", { class: "doubt" }, `Not to be trusted: ${doubt.text} `);
      const { time, key } = doubt;
      if (time !== null)
        made.append(
          button(`Go to ${time} s`, () => ways.go(time)),
          " ",
        );
      if (key) made.append(button(`Show ${key}`, () => ways.open(key)));
      return made;
    }),
    ...notes.map((text) => element("p", { class: "hint" }, `Note: ${text}`)),
  ];
}
