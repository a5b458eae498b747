type Attributes = Partial<Record<string, string>>;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  given: Attributes = {},
  ...inside: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(given)) if (value !== undefined) made.setAttribute(name, value);
  made.append(...inside);
  return made;
}

/** A button, with what it does and further attributes. */
export function button(text: string, act?: () => unknown, given: Attributes = {}) {
  const made = element("button", { type: "button", ...given }, text);
  if (act) made.onclick = () => act();
  return made;
}

type Choices = (string | readonly [value: string, text: string])[];

export function choices(options: Choices): HTMLOptionElement[] {
  return options.map((one) => {
    const [value, text] = typeof one === "string" ? [one, one] : one;
    return element("option", { value }, text);
  });
}

/** A list of options, with what is done with the one that is chosen and further attributes, its `value` among them. */
export function select(label: string, options: Choices, chosen: (value: string) => void, given: Attributes = {}) {
  const made = element("select", { "aria-label": label, ...given }, ...choices(options));
  made.value = given.value ?? made.value;
  made.onchange = () => chosen(made.value);
  return made;
}

/** Names and values, for a list of them. */
export function pairs(rows: (readonly [string, string])[]): HTMLElement[] {
  return rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]);
}

/** The colours of the style at an element, by the names of their variables. */
export function coloursOf(place: Element): (name: string) => string {
  const style = getComputedStyle(place);
  return (name) => style.getPropertyValue(name).trim();
}

/** A summary: its first ten lines, the others folded. */
export function folded(text: string): HTMLElement[] {
  const lines = text.split("\n");
  const block = (some: string[]) => element("pre", { class: "summary", tabindex: "0" }, some.join("\n"));
  if (lines.length <= 12) return [block(lines)];
  const more = element("summary", {}, `${lines.length - 10} more lines`);
  return [block(lines.slice(0, 10)), element("details", {}, more, block(lines.slice(10)))];
}
