import { bytesOf, unpacked } from "./messages";
import { Viewer } from "./viewer";

let ended: Record<string, unknown> | undefined;
let viewer: Viewer | undefined;

/** Take the block of data before the script that calls: the page is shown while the rest of it is still being read. */
function next(): void {
  const block = document.currentScript?.previousElementSibling as HTMLElement;
  const text = block.textContent ?? "";
  block.remove();
  if (!ended) {
    ended = JSON.parse(text) as Record<string, unknown>;
    document.title = String(ended.title);
    return;
  }
  const message = unpacked(bytesOf(text));
  if (viewer) return viewer.more(message);
  viewer = new Viewer({ messages: [message], ended });
  document.body.append(...viewer.parts);
  addEventListener("keydown", (event) => viewer?.key(event));
}

Object.assign(globalThis, { ropewalk: next });
