import type { Path, Source } from "./edits";
import { type Schema, variants } from "./schema";

/** A key of the scenario as a form shows it. */
export interface Field {
  path: Path;
  name: string;
  about: string;
  unit: string;
  isRequired: boolean;
  isThere: boolean;
  shape: "text" | "choice" | "vector" | "list" | "raw" | "block" | "names" | "locked";
  value: string; // as the text has it
  preset: string; // what holds where nothing is written
  words: string[]; // one of which it is
  places: string[]; // of the components of a vector
  components: string[];
  kinds: string[]; // of a block, where there are several
  kind: string;
  keysOf: Record<string, string[]>; // of each kind
  canBeBlock: boolean; // or a value: a number, or a table
  isWords: boolean; // read as text, whatever it looks like
  fields: Field[]; // of a block, or one for each name
  more: { name: string; about: string }[]; // keys that it may have besides
}

const AXES: Record<number, string[]> = { 2: ["x", "z"], 3: ["x", "y", "z"] };

/** A path as one word. */
export function joined(path: Path): string {
  return path.join("\n");
}

/**
 * The scenario as fields: what is written, what must be, and what somebody has begun to write.
 *
 * `begun`: joined paths; with an empty last part where a block is to come in place of a value.
 */
export function fieldsOf(root: Schema, source: Source, begun: ReadonlySet<string>): Field {
  return field({ root, source, begun }, { ...root, description: "" }, [], true);
}

interface From {
  root: Schema;
  source: Source;
  begun: ReadonlySet<string>;
}

function field(from: From, schema: Schema, path: Path, isRequired: boolean): Field {
  const { root, source, begun } = from;
  const kind = source.kind(path);
  const options = variants(root, schema);
  const blocks = options.filter((option) => option.properties);
  const plain = options.filter((option) => !option.properties);
  const named = plain.find((option) => typeof option.additionalProperties === "object" && option.type === "object");
  const open = plain.find((option) => option.additionalProperties === true);
  const numbers = plain.find((option) => option.type === "array");
  const words = plain.flatMap((option) => option.enum ?? (option.type === "boolean" ? ["true", "false"] : []));
  const simple = plain.filter((option) => option !== numbers && !option.enum && option.type !== "boolean");
  const key = joined(path);
  const found: Field = {
    path,
    name: path[path.length - 1] ?? "",
    about: schema.description ?? "",
    unit: unitOf(options),
    isRequired,
    isThere: kind !== "nothing",
    shape: "text",
    value: source.value(path),
    preset: schema.default === undefined ? "" : presetOf(schema.default),
    words,
    places: [],
    components: [],
    kinds: [],
    kind: "",
    keysOf: {},
    canBeBlock: blocks.length > 0 && plain.length > 0,
    isWords: simple.length > 0 && simple.every((option) => option.type === "string"),
    fields: [],
    more: [],
  };
  const isLong = found.value.includes("\n");
  if (kind === "alias") return { ...found, shape: "locked" };
  if (blocks.length && (!plain.length || kind === "block" || begun.has(`${key}\n`)))
    return block(from, blocks, { ...found, shape: "block" });
  if (named || open) {
    const inner: Schema = named ? (named.additionalProperties as Schema) : {};
    const names = source.keys(path);
    for (const other of begun) {
      const [name] = other.startsWith(`${key}\n`) ? other.slice(key.length + 1).split("\n") : "";
      if (name && !names.includes(name)) names.push(name);
    }
    const fields = names.map((name) => field(from, inner, [...path, name], false));
    return { ...found, shape: "names", fields };
  }
  const size = source.keys(path).length || numbers?.minItems || 0;
  const vector =
    numbers?.maxItems && numbers.maxItems <= 3 && plain.length === 1 && numbers.items && !numbers.items.items;
  if (vector && AXES[size] && kind !== "scalar") {
    const places = AXES[size].map((_, i) => `${i}`);
    const components = places.map((i) => source.value([...path, i]));
    return { ...found, shape: "vector", places: numbers.items?.unit === undefined ? places : AXES[size], components };
  }
  const nested = kind === "list" && source.keys(path).some((k) => source.kind([...path, k]) !== "scalar");
  if (kind === "block" || nested || (numbers && (!numbers.items || numbers.items.items)) || !plain.length)
    return { ...found, shape: isLong ? "locked" : "raw" };
  if (numbers && (kind === "list" || plain.length === 1)) {
    const items = source.keys(path).map((k) => source.value([...path, k]));
    return { ...found, shape: "list", value: items.join(", ") };
  }
  if (isLong) return { ...found, shape: "locked" };
  return { ...found, shape: words.length && !simple.length && !numbers ? "choice" : "text" };
}

function block(from: From, blocks: Schema[], found: Field): Field {
  const { source, begun } = from;
  const { path } = found;
  const kindOf = (one: Schema) => one.properties?.kind?.const ?? "";
  const kinds = blocks.length > 1 ? blocks.map(kindOf) : [];
  const usual = blocks.find((one) => !one.required?.includes("kind"));
  const written = source.value([...path, "kind"]) || source.merged(path, "kind");
  const kind = kinds.length ? written || (usual ? kindOf(usual) : "") : "";
  const own = kinds.length ? blocks.find((one) => kindOf(one) === kind) : blocks[0];
  const fields: Field[] = [];
  const more: Field["more"] = [];
  const known = own?.properties ?? {};
  const keys = source.keys(path);
  const takesOver = keys.includes("<<");
  for (const [name, schema] of Object.entries(known)) {
    if (schema.const !== undefined && (kinds.length || source.kind([...path, name]) === "nothing")) continue;
    const key = joined([...path, name]);
    const isRequired = !takesOver && (own?.required?.includes(name) ?? false);
    const isBegun = begun.has(key) || [...begun].some((other) => other.startsWith(`${key}\n`));
    if (source.kind([...path, name]) !== "nothing" || isRequired || isBegun)
      fields.push(field(from, schema, [...path, name], isRequired));
    else more.push({ name, about: schema.description ?? "" });
  }
  for (const name of keys)
    if (!(name in known) && !(name === "kind" && kinds.length)) {
      const about = name === "<<" ? "All that another block has." : own ? "There is no such key here." : "";
      const shape = name === "<<" ? "locked" : "raw";
      fields.push({ ...field(from, { description: about }, [...path, name], false), shape });
    }
  const keysOf = Object.fromEntries(blocks.map((one) => [kindOf(one), Object.keys(one.properties ?? {})]));
  return { ...found, kinds, kind, keysOf, fields, more };
}

function unitOf(options: Schema[]): string {
  for (let one of options) {
    while (one.items) one = one.items;
    if (one.unit) return one.unit === "dimensionless" ? "" : one.unit;
  }
  return "";
}

function presetOf(value: unknown): string {
  if (Array.isArray(value)) return value.map(presetOf).join(", ");
  return typeof value === "object" && value ? String((value as { kind?: string }).kind ?? "") : String(value);
}
