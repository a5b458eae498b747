// The widget of notebooks in a page, as anywidget loads it; the model is a stub with what anywidget promises.
import { readFileSync } from "node:fs";

/** Show a state (JSON, bytes in base64) by a module in a page; `model`, `heard`, `leaked` and `close` are there then. */
export async function shown(page, module, state) {
  await page.setContent('<body style="font: 20px serif; margin: 8px"><h1>My notebook</h1><div id="cell"></div></body>');
  await page.evaluate(
    async ({ code, state }) => {
      document.body.dataset.jpThemeLight = "true";
      const views = (texts) =>
        texts.map((text) => {
          const bytes = Uint8Array.from(`xxx${atob(text)}`, (sign) => sign.charCodeAt(0)); // not at the beginning
          return new DataView(bytes.buffer, 3);
        });
      const values = { ...state, messages: views(state.messages), beside_messages: views(state.beside_messages) };
      const heard = new Map();
      const model = {
        get: (name) => values[name],
        on: (name, changed) => heard.set(name, changed),
        off: (name) => heard.delete(name),
        set: (name, value) => {
          values[name] = value;
          heard.get(`change:${name}`)?.();
        },
      };
      const module = await import(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
      const el = document.getElementById("cell");
      Object.assign(globalThis, { model, heard });
      el.parentElement.addEventListener("keydown", () => {
        globalThis.leaked = true;
      });
      globalThis.close = await module.default.render({ model, el });
    },
    { code: readFileSync(module, "utf8"), state: JSON.parse(readFileSync(state, "utf8")) },
  );
}
