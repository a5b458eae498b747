export type Arrays = Record<string, { shape: number[]; values: Float32Array }>;

export interface Message {
  head: Record<string, unknown>;
  arrays: Arrays;
}

/** A header in JSON and arrays of 32-bit floats, as `ropewalk.studio.messages` packs them. */
export function unpacked(data: ArrayBuffer): Message {
  const size = new DataView(data).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
  const arrays: Arrays = {};
  let at = 4 + size;
  for (const [name, shape] of head.arrays as [string, number[]][]) {
    const count = shape.reduce((a, b) => a * b, 1);
    arrays[name] = { shape, values: new Float32Array(data, at, count) };
    at += 4 * count;
  }
  return { head, arrays };
}

/** What a text in base64 holds. */
export function bytesOf(text: string): ArrayBuffer {
  return Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
}
