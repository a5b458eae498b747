import { unpacked } from "./messages";
import { Viewer } from "./viewer";

function bytes(text: string): ArrayBuffer {
  return Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
}

const given = JSON.parse(document.getElementById("data")?.textContent ?? "null") as {
  messages: string[];
  ended: Record<string, unknown>;
};
document.title = String(given.ended.title);
const viewer = new Viewer({ messages: given.messages.map((text) => unpacked(bytes(text))), ended: given.ended });
document.body.append(...viewer.parts);
addEventListener("keydown", (event) => viewer.key(event));
