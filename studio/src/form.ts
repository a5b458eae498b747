import { button, choices, element, select } from "./dom";
import type { Editor } from "./editor";
import { Source } from "./edits";
import { type Field, fieldsOf, joined } from "./fields";
import type { Schema } from "./schema";

/** Something to be told at the key to which it belongs. */
export interface Remark {
  key: string;
  message: string;
  isDoubt?: boolean;
}

interface Row {
  element: HTMLElement;
  remarks: HTMLElement;
  field: Field;
  update?: (field: Field) => void;
}

let count = 0; // of rows made, for names that labels refer to

/** The scenario as a form, beside its text: both show the same, and a change here changes that one place there. */
export class Form {
  private schema?: Schema;
  private source = new Source("");
  private begun = new Set<string>();
  private rows = new Map<string, Row>();
  private before = new Map<string, Row>(); // rows of the text that was shown before
  private remarks: Remark[] = [];
  private wrong = element("p", { class: "error", role: "alert", hidden: "" });
  private fields = element("fieldset", { class: "form" });
  private names = element("datalist", { id: "form-lines" });

  constructor(
    place: HTMLElement,
    private editor: Editor,
  ) {
    const undo = button("Undo", () => editor.undo(), { title: "Undo (Ctrl+Z), also what was typed in the text" });
    const redo = button("Redo", () => editor.redo(), { title: "Redo (Ctrl+Y)" });
    place.append(element("div", { class: "row" }, undo, redo), this.wrong, this.names, this.fields);
    place.addEventListener("keydown", (event) => this.pressed(event));
  }

  learn(schema: Schema): void {
    this.schema = schema;
    this.show(this.source.text);
  }

  /** Show another text. */
  show(text: string): void {
    this.source = new Source(text);
    const { wrong } = this.source;
    this.wrong.hidden = !wrong;
    this.wrong.textContent = `The text cannot be read (${wrong}). Mend it under Text, or undo.`;
    this.fields.disabled = Boolean(wrong);
    if (wrong || !this.schema) return;
    for (const key of this.begun) if (this.isWritten(key)) this.begun.delete(key);
    const lines = ["lines", "overhead_lines", "nets"].flatMap((key) => this.source.keys([key]));
    this.names.replaceChildren(...choices(lines));
    [this.before, this.rows] = [this.rows, new Map()];
    this.fill(this.fields, fieldsOf(this.schema, this.source, this.begun));
    this.tell(this.remarks);
  }

  /** Mistakes and doubts at their fields. */
  tell(remarks: Remark[]): void {
    this.remarks = remarks;
    for (const row of this.rows.values()) {
      row.remarks.replaceChildren();
      for (const input of inputsOf(row)) input.removeAttribute("aria-invalid");
    }
    for (const remark of remarks) {
      const row = this.rowOf(remark.key);
      if (!row) continue;
      const told = remark.message.startsWith(`${remark.key}: `)
        ? remark.message.slice(remark.key.length + 2)
        : remark.message;
      row.remarks.append(element("p", { class: remark.isDoubt ? "doubt" : "error" }, told));
      if (!remark.isDoubt) for (const input of inputsOf(row)) input.setAttribute("aria-invalid", "true");
      this.unfold(row.element.parentElement);
    }
  }

  /** The innermost row that shows a key, or what it is in. */
  private rowOf(key: string): Row | undefined {
    const within = [...this.rows.values()].filter(({ field }) => `${key}.`.startsWith(`${field.path.join(".")}.`));
    return within.sort((a, b) => b.field.path.length - a.field.path.length)[0];
  }

  private unfold(inside: HTMLElement | null): void {
    for (let at = inside; at && at !== this.fields; at = at.parentElement)
      if (at instanceof HTMLDetailsElement) at.open = true;
  }

  /** Go to the field of a key, which is begun where it is not written; or to what it would be in. */
  goTo(key: string): void {
    const path = key.split(".");
    if (joined(this.begin(path)?.field.path ?? []) !== joined(path)) this.begun.delete(joined(path));
  }

  private isWritten(key: string): boolean {
    const path = key.split("\n");
    return path[path.length - 1] === ""
      ? this.source.kind(path.slice(0, -1)) === "block"
      : this.source.kind(path) !== "nothing";
  }

  private change(make: () => string): void {
    try {
      const text = make();
      const { wrong } = new Source(text);
      if (wrong) throw new Error(wrong);
      this.editor.change(text);
    } catch (error) {
      this.wrong.hidden = false;
      this.wrong.textContent = `This cannot be: ${(error as Error).message}.`;
    }
  }

  /** Begin a key, and go to its field or to what it would be in. */
  private begin(path: readonly string[]): Row | undefined {
    this.begun.add(joined(path));
    this.show(this.source.text);
    const row = this.rowOf(path.filter(Boolean).join("."));
    this.unfold(row?.element ?? null);
    row?.element.querySelector<HTMLElement>("input, select")?.focus();
    return row;
  }

  private remove(field: Field): void {
    for (const key of this.begun) if (`${key}\n`.startsWith(`${joined(field.path)}\n`)) this.begun.delete(key);
    if (field.isThere) this.change(() => this.source.remove(field.path));
    else this.show(this.source.text);
  }

  /** Rows of the fields of a block, and of what may be added; those that stay are not made anew. */
  private fill(inside: HTMLElement, field: Field): void {
    const key = [joined(field.path), field.shape, "add", ...field.more.map(({ name }) => name)].join("|");
    const adder = this.before.get(key) ?? { element: this.adder(field), remarks: element("div"), field };
    settle(inside, [...field.fields.map((one) => this.row(one)), adder.element]);
    this.rows.set(key, adder);
  }

  private row(field: Field): HTMLElement {
    const { path, shape, kinds, words, components, isRequired, canBeBlock } = field;
    const key = [joined(path), shape, kinds, words, components.length, isRequired, canBeBlock].join("|");
    const isBlock = shape === "block" || shape === "names";
    const row = this.before.get(key) ?? (isBlock ? this.section(field) : this.line(field));
    this.rows.set(key, row);
    row.field = field;
    row.update?.(field);
    if (isBlock) this.fill(row.element.lastElementChild as HTMLElement, field);
    return row.element;
  }

  /** A block: its kind, its fields, and what it may have besides. */
  private section(field: Field): Row {
    const inside = element("div", { class: "inside" });
    const title = element("span", { class: "name" }, field.name);
    const told = element("span", { class: "kind" });
    const tools = element("div", { class: "row tools" });
    const remarks = element("div", { class: "remarks", role: "status" });
    const about = element("p", { class: "help" }, field.about);
    const open = field.path.length < 4 || !field.isThere ? { open: "" } : {};
    const summary = element("summary", { title: field.about }, title, told);
    const made = element("details", { class: "block", ...open }, summary, tools, remarks, about, inside);
    const row: Row = { element: made, remarks, field };
    let kind: HTMLSelectElement | undefined;
    if (field.kinds.length) {
      const choose = (value: string) => this.change(() => this.withKind(row.field, value));
      kind = select(`Kind of ${field.name}`, [["", "choose a kind"], ...field.kinds], choose);
      tools.append(kind);
    }
    if (field.canBeBlock) tools.append(this.button("One value", `${field.name} as one value`, () => this.single(row)));
    if (isName(field)) tools.append(this.button("Rename", `Rename ${field.name}`, () => this.renamed(row.field)));
    const remove = this.button("Remove", `Remove ${field.path.join(" ")}`, () => this.remove(row.field));
    if (!field.isRequired) tools.append(remove);
    row.update = (now) => {
      told.textContent = now.kind;
      remove.hidden = now.shape === "names" && now.fields.length > 0; // the names can be removed one by one
      if (kind) kind.value = now.kind;
    };
    return row;
  }

  /** One value. */
  private line(field: Field): Row {
    const id = `form-${++count}`;
    const named = { for: id, title: field.about, class: field.isRequired ? "required" : "" };
    const label = element("label", named, field.name);
    const help = element("p", { class: "help", id: `${id}-help` }, helpOf(field));
    const remarks = element("div", { class: "remarks", role: "status", id: `${id}-remarks` });
    const about = { "aria-describedby": `${id}-help ${id}-remarks` };
    const required = field.isRequired ? { "aria-required": "true" } : {};
    const row: Row = { element: label, remarks, field };
    const inputs: (HTMLInputElement | HTMLSelectElement)[] = [];
    const places = field.shape === "vector" ? field.places : [""];
    places.forEach((place, i) => {
      const named = { id: i ? `${id}-${i}` : id, ...(place ? { "aria-label": `${field.name} ${axis(place)}` } : {}) };
      if (field.shape === "choice") {
        const words = choices([["", "–"], ...field.words]);
        inputs.push(element("select", { ...named, ...about, ...required }, ...words));
      } else {
        const list = field.name === "on" ? "form-lines" : field.words.length ? `${id}-words` : undefined;
        const preset = field.shape === "vector" ? axis(place) : field.preset;
        const text = { type: "text", autocomplete: "off", spellcheck: "false", placeholder: preset, list };
        inputs.push(element("input", { ...named, ...about, ...required, ...text }));
      }
    });
    for (const [i, input] of inputs.entries()) input.onchange = () => this.entered(row.field, inputs, i);
    const box = element("div", { class: "entry" }, ...inputs);
    if (field.words.length && field.shape !== "choice")
      box.append(element("datalist", { id: `${id}-words` }, ...choices(field.words)));
    if (field.unit)
      box.append(element("span", { class: "unit", title: "SI unit; write any other, as 5 km/h" }, field.unit));
    const table = () => this.begin([...row.field.path, ""]);
    if (field.canBeBlock) box.append(this.button("Table", `${field.name} as a table`, table));
    if (!field.isRequired) {
      const drop = this.button("×", `Remove ${field.name}`, () => this.remove(row.field));
      drop.classList.add("drop");
      box.append(drop);
    }
    row.element = element("div", { class: "field" }, label, box, help, remarks);
    row.update = (now) => {
      inputs.forEach((input, i) => {
        const value = now.shape === "vector" ? now.components[i] : now.value;
        if (input.dataset.value !== value) input.value = value;
        input.dataset.value = value;
        if (now.shape === "locked" && input instanceof HTMLInputElement) input.readOnly = true;
      });
    };
    return row;
  }

  private entered(field: Field, inputs: (HTMLInputElement | HTMLSelectElement)[], i: number): void {
    const values = inputs.map((input) => input.value.trim());
    const value = values[i];
    const { path, shape } = field;
    if (value === inputs[i].dataset.value) return;
    if (shape === "vector") {
      if (field.isThere && value) this.change(() => this.source.set([...path, `${i}`], value));
      else if (field.isThere) inputs[i].value = field.components[i];
      else if (values.every(Boolean)) this.change(() => this.source.set(path, `[${values.join(", ")}]`, { raw: true }));
    } else if (!value) {
      if (field.isRequired) this.begun.add(joined(path)); // so that its row stays
      if (field.isThere) this.change(() => this.source.remove(path));
    } else if (shape === "list") {
      this.change(() => this.source.set(path, value.startsWith("[") ? value : `[${value}]`, { raw: true }));
    } else {
      const raw = !field.isWords && /^[[{]/.test(value);
      this.change(() => this.source.set(path, value, { raw, words: field.isWords }));
    }
  }

  /** The text with another kind of a block, without the keys that this kind does not have. */
  private withKind(field: Field, kind: string): string {
    if (!kind) return this.source.remove([...field.path, "kind"]);
    let text = this.source.set([...field.path, "kind"], kind);
    for (const key of this.source.keys(field.path))
      if (!field.keysOf[kind]?.includes(key)) text = new Source(text).remove([...field.path, key]);
    return text;
  }

  private single(row: Row): void {
    const { path, isThere } = row.field;
    this.begun.delete(joined([...path, ""]));
    this.begun.add(joined(path));
    if (isThere && this.source.kind(path) === "block") this.change(() => this.source.remove(path));
    else this.show(this.source.text);
  }

  private renamed(field: Field): void {
    const name = prompt(`Another name for ${field.name}`, field.name)?.trim();
    if (name && name !== field.name) this.change(() => this.source.rename(field.path, name));
  }

  /** A name that is to come, or what a block may have besides. */
  private adder(field: Field): HTMLElement {
    const { path, more } = field;
    const where = field.name || "the scenario";
    if (field.shape === "names") {
      const about = { type: "text", "aria-label": `Name of another one of ${where}`, placeholder: "name" };
      const input = element("input", about);
      const add = () => {
        const name = input.value.trim();
        if (!name || this.source.keys(path).includes(name)) return input.focus();
        input.value = "";
        this.begin([...path, name]);
      };
      input.onkeydown = ({ key }) => key === "Enter" && add();
      return element("div", { class: "row add" }, input, this.button("Add", `Add to ${where}`, add));
    }
    const keys = select(
      `Add a key to ${where}`,
      [["", `Add to ${where}…`]],
      (name) => name && this.begin([...path, name]),
    );
    keys.append(...more.map(({ name, about }) => element("option", { value: name, title: about }, name)));
    return element("div", { class: "row add", ...(more.length ? {} : { hidden: "" }) }, keys);
  }

  private button(text: string, label: string, act: () => void): HTMLButtonElement {
    return button(text, act, { "aria-label": label, title: label });
  }

  private pressed(event: KeyboardEvent): void {
    if (!(event.ctrlKey || event.metaKey) || !["z", "y", "Z"].includes(event.key)) return;
    const { target } = event;
    if (target instanceof HTMLInputElement && target.value !== (target.dataset.value ?? "")) return; // its own undo
    event.preventDefault();
    if (event.key === "z") this.editor.undo();
    else this.editor.redo();
  }
}

function axis(place: string): string {
  return /^\d$/.test(place) ? `${Number(place) + 1}` : place;
}

function isName(field: Field): boolean {
  return field.isThere && field.path.length === 2 && !field.isRequired && field.path[0].endsWith("s");
}

function helpOf(field: Field): string {
  const locked =
    field.shape === "locked" ? "It is written over several lines or elsewhere: change it under Text. " : "";
  const preset = field.preset && !field.isThere ? ` (${field.preset} where nothing is written)` : "";
  return `${locked}${field.about}${preset}`;
}

function inputsOf(row: Row): NodeListOf<HTMLElement> {
  return row.element.querySelectorAll<HTMLElement>(":scope > .entry > input, :scope > .entry > select");
}

/** Children in this order; those that stay are not touched, so that they keep the focus. */
function settle(parent: HTMLElement, wanted: HTMLElement[]): void {
  for (const one of [...parent.children]) if (!wanted.includes(one as HTMLElement)) one.remove();
  for (const [i, one] of wanted.entries())
    if (one !== parent.children[i]) parent.insertBefore(one, parent.children[i] ?? null);
}
