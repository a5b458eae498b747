import { Source } from "./edits";

/** The part of JSON schema that the scenario's schema uses. */
export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string | string[];
  properties?: Record<string, Schema>;
  additionalProperties?: Schema | boolean;
  anyOf?: Schema[];
  oneOf?: Schema[];
  enum?: string[];
  const?: string;
  required?: string[];
  items?: Schema;
  minItems?: number;
  maxItems?: number;
  description?: string;
  unit?: string;
  default?: unknown;
}

export interface Option {
  label: string;
  type: string;
  detail?: string;
  info?: string;
  apply?: string;
}

/** What may stand at the end of some YAML text: keys of the block, or choices of the key that is begun. */
export function completions(root: Schema, before: string): Option[] {
  const lines = before.split("\n");
  const last = lines[lines.length - 1];
  const value = /^\s*(?:[\w-]+:\s*\{?.*?,?\s*)?([\w-]+):\s+$/.exec(last);
  const path = pathOf(lines, indentOf(last));
  const inline = /^\s*([\w-]+):\s*\{/.exec(last);
  if (inline) path.push(inline[1]);
  const blocks = walk(root, root, path, new Source(before).value([...path, "kind"]));
  if (value) {
    const words = new Set<string>();
    for (const block of blocks)
      for (const one of variants(root, block.properties?.[value[1]])) {
        for (const word of one.enum ?? []) words.add(word);
        if (one.const) words.add(one.const);
      }
    return [...words].map((label) => ({ label, type: "enum" }));
  }
  if (last.trim() && !inline) return [];
  const found = new Map<string, Option>();
  for (const block of blocks)
    for (const [label, entry] of Object.entries(block.properties ?? {}))
      found.set(label, { label, type: "property", detail: entry.unit, info: entry.description, apply: `${label}: ` });
  return [...found.values()];
}

function indentOf(line: string): number {
  return line.length - line.trimStart().length;
}

/** The keys that lead to a line of this indentation. */
function pathOf(lines: string[], indent: number): string[] {
  const path: string[] = [];
  let inside = indent;
  for (let i = lines.length - 2; i >= 0 && inside > 0; i--) {
    const found = /^(\s*)([\w-]+):/.exec(lines[i]);
    if (!found || found[1].length >= inside) continue;
    path.unshift(found[2]);
    inside = found[1].length;
  }
  return path;
}

/** What a value may be, references followed. */
export function variants(root: Schema, schema: Schema | undefined): Schema[] {
  if (!schema) return [];
  if (schema.$ref) return variants(root, root.$defs?.[schema.$ref.split("/").pop() ?? ""]);
  const some = schema.anyOf ?? schema.oneOf;
  return some ? some.flatMap((one) => variants(root, one)) : [schema];
}

function walk(root: Schema, schema: Schema, path: string[], kind?: string): Schema[] {
  let blocks = [schema];
  for (const key of path)
    blocks = blocks.flatMap((block) => {
      const inner = block.properties?.[key];
      if (inner) return variants(root, inner);
      return typeof block.additionalProperties === "object" ? variants(root, block.additionalProperties) : [];
    });
  const own = kind ? blocks.filter((block) => block.properties?.kind?.const === kind) : [];
  return own.length ? own : blocks;
}
