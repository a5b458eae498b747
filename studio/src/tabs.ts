import { button, element } from "./dom";

/**
 * Give panels a bar of tabs, of which one is shown; arrow keys, Home and End choose among them.
 *
 * `opened` is called with the key of the panel that is to be shown.
 */
export function tabbed<Key extends string>(
  panels: Record<Key, HTMLElement>,
  opened: (key: Key) => void,
): { bar: HTMLElement; show: (key: Key) => void } {
  const bar = element("div", { class: "tabs", role: "tablist", "aria-label": "Panels" });
  const keys = Object.keys(panels) as Key[];
  const buttons = keys.map((key) => {
    const made = button(key[0].toUpperCase() + key.slice(1), () => show(key), {
      role: "tab",
      id: `tab-${key}`,
      "aria-controls": key,
    });
    const about = { id: key, role: "tabpanel", "aria-labelledby": `tab-${key}`, tabindex: "0" };
    for (const [name, value] of Object.entries(about)) panels[key].setAttribute(name, value);
    return made;
  });
  function show(shown: Key): void {
    keys.forEach((key, i) => {
      panels[key].hidden = key !== shown;
      buttons[i].setAttribute("aria-selected", `${key === shown}`);
      buttons[i].tabIndex = key === shown ? 0 : -1;
    });
    opened(shown);
  }
  bar.onkeydown = (event) => {
    const now = buttons.indexOf(event.target as HTMLButtonElement);
    const next = { ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: -1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    event.stopPropagation(); // elsewhere the same keys step through time
    const chosen = buttons.at(next % keys.length);
    chosen?.click();
    chosen?.focus();
  };
  bar.append(...buttons);
  return { bar, show };
}
