// A WebAssembly module as bytes: its sections, its functions, their instructions.

const MAGIC = 8;
export const SECTION = { global: 6, export: 7, code: 10, data: 11 };

/** A number as LEB128. */
export function leb(number) {
  const bytes = [];
  for (let rest = number; ; rest >>>= 7) {
    if (rest < 0x80) return [...bytes, rest];
    bytes.push((rest & 0x7f) | 0x80);
  }
}

/** Reads a module from front to back. */
export class Reader {
  constructor(bytes, at = 0) {
    Object.assign(this, { bytes, at });
  }

  byte() {
    return this.bytes[this.at++];
  }

  /** An unsigned LEB128; signed ones are only passed over, which is the same. */
  leb() {
    for (let [number, shift] = [0, 0]; ; shift += 7) {
      const byte = this.byte();
      if (shift < 32) number += (byte & 0x7f) * 2 ** shift;
      if (byte < 0x80) return number;
    }
  }

  skip(bytes) {
    this.at += bytes;
  }

  memarg() {
    const align = this.leb();
    if (align & 0x40) this.leb();
    this.leb();
  }

  /** Passes an instruction. */
  instruction() {
    const code = this.byte();
    if (code >= 0x02 && code <= 0x04) this.leb();
    else if (code === 0x10 || code === 0x12 || code === 0xd2) this.leb();
    else if (code === 0x0c || code === 0x0d || (code >= 0x20 && code <= 0x26)) this.leb();
    else if (code === 0x0e) for (let n = this.leb() + 1; n > 0; n--) this.leb();
    else if (code === 0x11 || code === 0x13) { this.leb(); this.leb(); }
    else if (code === 0x1c) for (let n = this.leb(); n > 0; n--) this.leb();
    else if (code >= 0x28 && code <= 0x3e) this.memarg();
    else if ((code >= 0x3f && code <= 0x42) || code === 0xd0) this.leb();
    else if (code === 0x43) this.skip(4);
    else if (code === 0x44) this.skip(8);
    else if (code === 0xfc) this.prefixed();
    else if (code === 0xfd) this.vector();
    else if (code >= 0xc5) throw new Error(`instruction ${code.toString(16)}: is unknown; split/binary.mjs has to learn it`);
  }

  /** Conversions that saturate, and bulk memory. */
  prefixed() {
    const code = this.leb();
    const numbers = code < 8 ? 0 : [8, 10, 12, 14].includes(code) ? 2 : 1;
    for (let n = 0; n < numbers; n++) this.leb();
  }

  vector() {
    const code = this.leb();
    if (code <= 11 || code === 92 || code === 93) this.memarg();
    else if (code === 12 || code === 13) this.skip(16);
    else if (code >= 21 && code <= 34) this.skip(1);
    else if (code >= 84 && code <= 91) { this.memarg(); this.skip(1); }
  }
}

/** Sections in their order: `{ id, content }`. */
export function sections(bytes) {
  const reader = new Reader(bytes, MAGIC);
  const all = [];
  while (reader.at < bytes.length) {
    const id = reader.byte();
    const size = reader.leb();
    all.push({ id, content: bytes.subarray(reader.at, reader.at + size) });
    reader.skip(size);
  }
  return all;
}

/** The module of these sections. */
export function assemble(bytes, all) {
  const parts = [bytes.subarray(0, MAGIC)];
  for (const { id, content } of all) parts.push(Uint8Array.of(id, ...leb(content.length)), content);
  return Uint8Array.from(Buffer.concat(parts));
}

/** Bodies of the code section: each with where its instructions begin, after its locals. */
export function bodies({ content }) {
  const reader = new Reader(content);
  return Array.from({ length: reader.leb() }, () => {
    const size = reader.leb();
    const body = content.subarray(reader.at, reader.at + size);
    reader.skip(size);
    const locals = new Reader(body);
    for (let n = locals.leb(); n > 0; n--) { locals.leb(); locals.byte(); }
    return { body, begin: locals.at };
  });
}

/** A code section of bodies. */
export function code(all) {
  return { id: SECTION.code, content: Uint8Array.from(Buffer.concat([Uint8Array.from(leb(all.length)), ...all.flatMap((body) => [Uint8Array.from(leb(body.length)), body])])) };
}

/** A module whose data name no folder of the machine that built it: what a panic would say of them nobody hears in a page. */
export function withoutPaths(bytes, folders) {
  const escaped = folders.map((folder) => folder.replace(/[^\w/]/g, '\\$&'));
  const path = new RegExp(`(?:${escaped.join('|')})/[\\w.+/-]*?\\.rs`, 'g');
  const all = sections(bytes).map(({ id, content }) => {
    if (id !== SECTION.data) return { id, content };
    const blank = Buffer.from(content);
    for (const { index, 0: { length } } of blank.toString('latin1').matchAll(path)) blank.fill(0, index, index + length);
    return { id, content: Uint8Array.from(blank) };
  });
  return assemble(bytes, all);
}

/** How many things a vector section holds. */
export const count = ({ content }) => new Reader(content).leb();

/** A vector section with more behind what it holds. */
export function append(section, entries) {
  const reader = new Reader(section.content);
  const held = reader.leb();
  return { id: section.id, content: Uint8Array.from(Buffer.concat([Uint8Array.from(leb(held + entries.length)), section.content.subarray(reader.at), ...entries.map((entry) => Uint8Array.from(entry))])) };
}
