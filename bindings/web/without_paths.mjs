// node without_paths.mjs FROM.wasm TO.wasm: the module without the names of folders on the machine that built it, and without the lines of the
// sources where it could panic, which no browser shows. They are in no page's interest, take 8 kB gzipped, and would make its bytes those of one
// folder. Only data hold them, and what is blanked keeps its length.
import { readFileSync, realpathSync, writeFileSync } from 'node:fs';
import { homedir } from 'node:os';

const [from, to] = process.argv.slice(2);
const cargo = process.env.CARGO_HOME ?? `${homedir()}/.cargo`;
const folders = [realpathSync(new URL('../../', import.meta.url)).replace(/\/$/, ''), `${cargo}/registry/src`, '/rustc', '/rust/deps'];
const escaped = folders.map((folder) => folder.replace(/[^\w/]/g, '\\$&'));
const path = new RegExp(`(?:${escaped.join('|')})/[\\w.+/-]*?\\.rs|src/[\\w/]*\\.rs`, 'g');
const bytes = readFileSync(from);
const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);

function number(at) {
  let [value, shift, byte] = [0, 0, 0];
  do {
    byte = bytes[at++];
    value |= (byte & 127) << shift;
    shift += 7;
  } while (byte & 128);
  return [value >>> 0, at];
}

// Parts of the data: place in memory, place in the file, length.
function* parts() {
  for (let at = 8; at < bytes.length;) {
    const id = bytes[at];
    let [length, start] = number(at + 1);
    at = start + length;
    if (id !== 11) continue;
    let [count, next] = number(start);
    for (; count > 0; count--) {
      // Memory 0, `i32.const`, the place, `end`.
      const [place, after] = number(next + 2);
      [length, start] = number(after + 1);
      yield { place, start, length };
      next = start + length;
    }
  }
}

// A line of a source: the name's place and length, line, column.
const LOCATION_BYTES = 16;
const data = [...parts()];
const names = new Map();
for (const { index, 0: { length } } of bytes.toString('latin1').matchAll(path)) {
  const part = data.find(({ start, length }) => index >= start && index < start + length);
  if (!part) continue;
  names.set(part.place + index - part.start, length);
  bytes.fill(0, index, index + length);
}
for (const { start, length } of data) {
  for (let at = start; at + LOCATION_BYTES <= start + length; at += 4) {
    if (names.get(view.getUint32(at, true)) === view.getUint32(at + 4, true)) bytes.fill(0, at, at + LOCATION_BYTES);
  }
}
writeFileSync(to, bytes);
