import type { Doubt } from "./doubts";
import { Film } from "./film";
import { type Message, unpacked } from "./messages";
import { element, numbersOf, Player } from "./player";
import { Plots } from "./plots";
import { Stage } from "./stage";
import "./style.css";

function bytes(text: string): ArrayBuffer {
  return Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
}

const given = JSON.parse(document.getElementById("data")?.textContent ?? "null") as {
  messages: string[];
  ended: Record<string, unknown>;
};
const messages: Message[] = given.messages.map((text) => unpacked(bytes(text)));
const film = new Film(messages[0].head);
for (const message of messages.slice(1)) film.add(message.arrays);

const canvas = element("canvas", { tabindex: "0", role: "img", "aria-label": `Film of ${given.ended.title}` });
const plotted = element("div", { class: "plots" });
const stage = new Stage(canvas);
const plots = new Plots(plotted, (path) => player.go(path));
const player = new Player(stage, plots);
const numbers = element("dl", { class: "numbers" });
player.isOver = true;
player.shown = (shown, frame) => {
  numbers.replaceChildren(
    ...numbersOf(shown, frame).flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]),
  );
};
const doubts = (given.ended.doubts as Doubt[]) ?? [];
stage.doubted = doubts.map((doubt) => doubt.key);
player.mark(doubts);
document.title = String(given.ended.title);
document.body.append(
  element(
    "header",
    {},
    element("h1", {}, String(given.ended.title)),
    element("span", { class: "outcome" }, String(given.ended.outcome)),
  ),
  element(
    "main",
    {},
    element("section", { class: "stage" }, canvas, player.bar, plotted),
    element(
      "aside",
      {},
      ...doubts.map(({ text }) => element("p", { class: "doubt" }, text)),
      numbers,
      element("pre", { class: "summary" }, String(given.ended.summary)),
    ),
  ),
);
addEventListener("keydown", (event) => {
  if (event.target instanceof HTMLSelectElement || event.target instanceof HTMLButtonElement) return;
  if (event.key === " ") player.toggle();
  else if (event.key === "ArrowRight") player.step(1);
  else if (event.key === "ArrowLeft") player.step(-1);
  else return;
  event.preventDefault();
});
player.load(film);
