import {
  type Document,
  isAlias,
  isCollection,
  isMap,
  isScalar,
  isSeq,
  type Node,
  type Pair,
  parseDocument,
  type Scalar,
  visit,
} from "yaml";

/** Keys that lead to a value; entries of a list by their numbers. */
export type Path = readonly string[];

/** What is replaced in a text. */
export interface Change {
  from: number;
  to: number;
  insert: string;
}

type Value = Node | null | undefined;
/** A value, if it is there, and what it is in, from the outside to the inside; `depth`: how much of its path is there. */
type Found = { value: Value; pair?: Pair; depth: number; parents: Node[] };

/** The text of a scenario with the places of its values; changes of it leave comments and layout as they are. */
export class Source {
  private doc: Document;
  private json: boolean;

  constructor(readonly text: string) {
    this.doc = parseDocument(text, { prettyErrors: false });
    this.json = text.trimStart().startsWith("{");
  }

  /** Why it cannot be read; empty if it can. */
  get wrong(): string {
    const error = this.doc.errors[0];
    let lost = "";
    visit(this.doc, {
      Alias: (_, alias) => {
        if (!alias.resolve(this.doc)) lost = alias.source;
      },
    });
    if (lost) return `*${lost} refers to nothing`;
    return error ? `line ${this.text.slice(0, error.pos[0]).split("\n").length}: ${error.message}` : "";
  }

  /** What stands there: nothing, one value, a list, a block, or a name for what stands elsewhere (`*name`). */
  kind(path: Path): "nothing" | "scalar" | "list" | "block" | "alias" {
    const { value } = this.find(path);
    if (!value || (isScalar(value) && value.value === null)) return "nothing";
    if (isAlias(value)) return "alias";
    return isMap(value) ? "block" : isSeq(value) ? "list" : "scalar";
  }

  /** What a block takes over from another one by `<<: *name`; empty where it has or finds none. */
  merged(path: Path, key: string): string {
    const { value } = this.find([...path, "<<"]);
    const other = isAlias(value) ? value.resolve(this.doc) : undefined;
    const found = isMap(other) ? other.get(key) : undefined;
    return found === undefined ? "" : `${found}`;
  }

  /** Keys of a block, or numbers of the entries of a list. */
  keys(path: Path): string[] {
    const { value } = this.find(path);
    return isMap(value) ? value.items.map(keyOf) : isSeq(value) ? value.items.map((_, i) => `${i}`) : [];
  }

  /** A value as it is read; lists and blocks as they are written. */
  value(path: Path): string {
    const { value } = this.find(path);
    if (isScalar(value)) return value.value === null ? "" : `${value.source ?? value.value}`;
    return value ? this.text.slice(...spanOf(value)) : "";
  }

  /** The text with another value; what leads to it is made where it is not there. `raw`: lists and blocks, as written. */
  set(path: Path, value: string, { raw = false, words = false } = {}): string {
    const { value: old, pair, depth, parents } = this.find(path);
    const quoted = isScalar(old) && (old.type === "QUOTE_DOUBLE" || old.type === "QUOTE_SINGLE");
    const parent = parents[parents.length - 1];
    const style = this.json || quoted ? "quoted" : isFlow(parent) ? "flow" : "block";
    const fresh = raw ? this.list(value) : scalar(value, style, words);
    if (depth < path.length) return this.add(path, depth, fresh);
    if (isSeq(old) && !old.flow && raw) {
      const parts = parseDocument(value).contents;
      if (isSeq(parts) && parts.items.length === old.items.length && parts.items.every((part) => isScalar(part))) {
        const values = parts.items.map((part) => `${(part as Scalar).source}`);
        return values.reduce<Source>((now, one, i) => new Source(now.set([...path, `${i}`], one)), this).text;
      }
    }
    if (pair && isMap(parent) && (!old || isEmpty(old) || (isCollection(old) && !old.flow))) {
      const colon = this.text.indexOf(":", spanOf(pair.key as Node)[1]) + 1;
      return this.put(colon, isEmpty(old) ? colon : spanOf(old as Node)[1], ` ${fresh}`);
    }
    return this.put(...spanOf(old as Node), fresh);
  }

  /** The text without a value, and without the blocks that this leaves empty. */
  remove(path: Path): string {
    const { pair, value, depth, parents } = this.find(path);
    const parent = parents[parents.length - 1];
    if (depth < path.length || !isCollection(parent)) return this.text;
    if (parent.items.length === 1 && path.length > 1) return this.remove(path.slice(0, -1));
    const spans = parent.items.map((item) => this.spanOfItem(item as Pair | Node));
    const k = parent.items.indexOf((pair && isMap(parent) ? pair : value) as never);
    const [from, to] = spans[k];
    if (parent.flow)
      return k + 1 < spans.length ? this.put(from, spans[k + 1][0], "") : this.put(k ? spans[k - 1][1] : from, to, "");
    const begin = this.lineStart(from);
    const end = this.lineEnd(to);
    if (!/^[\s-]*$/.test(this.text.slice(begin, from)) || (isMap(parent) && /-/.test(this.text.slice(begin, from))))
      return this.put(from, k + 1 < spans.length ? spans[k + 1][0] : end, "");
    return end < this.text.length ? this.put(begin, end + 1, "") : this.put(Math.max(begin - 1, 0), end, "");
  }

  /** The text with another name for a key. */
  rename(path: Path, name: string): string {
    const { pair, depth } = this.find(path);
    if (depth < path.length || !pair) return this.text;
    return this.put(...spanOf(pair.key as Node), scalar(name, this.json ? "quoted" : "flow", true));
  }

  private find(path: Path): Found {
    let value: Value = this.doc.contents as Value;
    let pair: Pair | undefined;
    const parents: Node[] = [];
    for (const [depth, part] of path.entries()) {
      parents.push(value as Node);
      const inner = isMap(value) ? value.items.find((one) => keyOf(one) === part) : undefined;
      const item = isSeq(value) ? value.items[Number(part)] : undefined;
      if (!inner && item === undefined) return { value: undefined, pair, depth, parents };
      if (inner) pair = inner;
      value = (inner ? inner.value : item) as Value;
    }
    return { value, pair, depth: path.length, parents };
  }

  /** What is not there yet, put into the innermost block that is. */
  private add(path: Path, depth: number, value: string): string {
    const { value: block, pair, parents } = this.find(path.slice(0, depth));
    const keys = path.slice(depth).map((key) => scalar(key, this.json ? "quoted" : "flow", true));
    const flow = keys.reduceRight((inner, key, i) => (i ? `{${key}: ${inner}}` : `${key}: ${inner}`), value);
    const blockwise = (indent: string) =>
      keys.map((key, i) => `${indent}${"  ".repeat(i)}${key}:${i + 1 < keys.length ? "" : ` ${value}`}`).join("\n");
    if (isMap(block) && block.flow) {
      const last = block.items[block.items.length - 1];
      const at = last ? this.spanOfItem(last)[1] : spanOf(block)[0] + 1;
      return this.put(at, at, `${last ? ", " : ""}${flow}`);
    }
    if (isMap(block) && block.items.length) {
      const first = spanOf(block.items[0].key as Node)[0];
      const indent = this.text.slice(this.lineStart(first), first).replace(/[^ ]/g, " ");
      if (keys.length === 1 && keys[0] === "kind") return this.put(first, first, `${flow}\n${indent}`);
      const end = this.lineEnd(this.spanOfItem(block.items[block.items.length - 1])[1]);
      return this.put(end, end, `\n${blockwise(indent)}`);
    }
    if (!depth) {
      const end = this.text.trimEnd();
      return `${this.text}${end && !this.text.endsWith("\n") ? "\n" : ""}${blockwise("")}\n`;
    }
    const parent = parents[parents.length - 1];
    if (isEmpty(block) && pair && isMap(parent)) {
      const key = spanOf(pair.key as Node);
      const colon = this.text.indexOf(":", key[1]) + 1;
      if (parent.flow) return this.put(colon, colon, ` {${flow}}`);
      const indent = this.text.slice(this.lineStart(key[0]), key[0]).replace(/[^ ]/g, " ");
      const end = this.lineEnd(colon);
      return this.put(end, end, `\n${blockwise(`${indent}  `)}`);
    }
    return this.set(path.slice(0, depth), `{${flow}}`, { raw: true });
  }

  private spanOfItem(item: Pair | Node): [number, number] {
    if (!("key" in item)) return spanOf(item as Node);
    const key = spanOf(item.key as Node);
    const colon = this.text.indexOf(":", key[1]) + 1;
    const value = item.value as Value;
    return [key[0], !value || isEmpty(value) ? Math.max(colon, key[1]) : spanOf(value)[1]];
  }

  private list(value: string): string {
    const doc = parseDocument(value);
    if (doc.errors.length || !doc.contents) throw new Error("this is no list");
    return this.json ? JSON.stringify(doc.toJS()) : value;
  }

  private lineStart(at: number): number {
    return this.text.lastIndexOf("\n", at - 1) + 1;
  }

  private lineEnd(at: number): number {
    const end = this.text.indexOf("\n", this.text[at - 1] === "\n" ? at - 1 : at);
    return end < 0 ? this.text.length : end;
  }

  private put(from: number, to: number, insert: string): string {
    return this.text.slice(0, from) + insert + this.text.slice(to);
  }
}

/** The one stretch in which two texts differ. */
export function difference(before: string, after: string): Change {
  const most = Math.min(before.length, after.length);
  let from = 0;
  while (from < most && before[from] === after[from]) from++;
  let same = 0;
  while (same < most - from && before[before.length - 1 - same] === after[after.length - 1 - same]) same++;
  return { from, to: before.length - same, insert: after.slice(from, after.length - same) };
}

function keyOf(pair: Pair): string {
  return String(isScalar(pair.key) ? (pair.key.source ?? pair.key.value) : pair.key);
}

function isEmpty(value: Value): boolean {
  return !value || (isScalar(value) && value.value === null && !value.source);
}

function spanOf(node: Node): [number, number] {
  const range = node.range ?? [0, 0, 0];
  return [range[0], range[1]];
}

function isFlow(value: Value): boolean {
  return isCollection(value) && Boolean(value.flow);
}

/** One value as it is written: quoted where it would be read as something else. */
function scalar(value: string, style: "quoted" | "flow" | "block", words: boolean): string {
  if (style === "quoted")
    return !words && /^(true|false|-?\d+(\.\d+)?([eE][+-]?\d+)?)$/.test(value) ? value : JSON.stringify(value);
  const doc = parseDocument(style === "flow" ? `[${value}]` : `- ${value}`);
  const list = doc.contents;
  const one = isSeq(list) && list.items.length === 1 ? list.items[0] : undefined;
  const plain = !doc.errors.length && isScalar(one) && one.type === "PLAIN" && one.source === value && !one.comment;
  return plain && !(words && typeof one.value !== "string") ? value : JSON.stringify(value);
}
