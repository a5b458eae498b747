import { unpacked } from "./messages";
import { inShadow, themeOf } from "./shadow";
import { type Run, Viewer } from "./viewer";
import "./widget.css";

/** What anywidget hands over of the traits of `ropewalk.studio.widget.View`. */
interface Model {
  get(name: "messages" | "beside_messages"): DataView[];
  get(name: "ended" | "beside_ended"): Record<string, unknown>;
  get(name: "height"): number;
  on(name: string, changed: () => void): void;
  off(name: string, changed: () => void): void;
}

const STYLE = "ropewalk-style"; // the build puts the style here

function runOf(messages: DataView[], ended: Record<string, unknown>): Run {
  const own = (data: DataView) => data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength) as ArrayBuffer;
  return { messages: messages.map((data) => unpacked(own(data))), ended };
}

function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const root = el.shadowRoot ?? el.attachShadow({ mode: "open" });
  const style = document.createElement("style");
  style.textContent = inShadow(STYLE);
  const page = document.createElement("div");
  page.className = "page shared";
  const theme = themeOf(document.body);
  if (theme) el.dataset.theme = theme;
  const beside = model.get("beside_messages");
  const viewer = new Viewer(
    runOf(model.get("messages"), model.get("ended")),
    beside.length ? runOf(beside, model.get("beside_ended")) : undefined,
  );
  const size = () => {
    page.style.height = `${model.get("height")}px`;
  };
  size();
  model.on("change:height", size);
  page.addEventListener("keydown", (event) => viewer.key(event) && event.stopPropagation()); // else the notebook acts
  page.append(...viewer.parts);
  root.replaceChildren(style, page);
  return () => {
    model.off("change:height", size);
    viewer.close();
    root.replaceChildren();
  };
}

export default { render };
