import { button, element } from "./dom";

/** A reason not to trust a run, as `ropewalk.studio.streams` tells it: when, and which key of the scenario is to blame. */
export interface Doubt {
  text: string;
  time: number | null; // s
  key: string;
}

/** Doubts and notes of a run as a list, with buttons that go to the time and open the key. */
export function listed(doubts: Doubt[], notes: string[], go: (time: number) => void, open: (key: string) => void) {
  return [
    ...doubts.map(({ text, time, key }) => {
      const made = element("p", { class: "doubt" }, `Not to be trusted: ${text} `);
      if (time !== null) made.append(button(`Go to ${time} s`, () => go(time)));
      const show = button(`Show ${key}`, () => open(key));
      if (key) made.append(" ", show);
      return made;
    }),
    ...notes.map((text) => element("p", { class: "hint" }, `Note: ${text}`)),
  ];
}
