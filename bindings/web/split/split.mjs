// Which places in a module control reaches, and the module without the others.
import { Reader, SECTION, append, assemble, bodies, code, count, leb, sections } from './binary.mjs';

const [TRAP, BLOCK, LOOP, IF, ELSE, END, BR_IF, CALL] = [0x00, 0x02, 0x03, 0x04, 0x05, 0x0b, 0x0d, 0x10];
const GLOBAL = 0x03; // a kind of export
const MUTABLE_I32_OF_0 = [0x7f, 0x01, 0x41, 0x00, 0x0b];
const UNREACHABLE = Uint8Array.of(TRAP);
const STUB = Uint8Array.of(0x00, TRAP, END);

/**
 * Walks a body from point to point: places that control may reach in its own right (a function's start, a branch, what follows a block or a
 * conditional branch). Tells `run(bytes)` every stretch of instructions and asks `point()` at every point; where that answers false, everything up to
 * the end of the construct around is passed over, and its points are only counted, by `passed()`.
 */
function walk({ body, begin }, { run, point, passed }) {
  const reader = new Reader(body, begin);
  let from = begin;
  let depth = 0;
  let dead = -1; // The depth of the construct that is passed over.
  const reach = () => {
    if (dead >= 0) { passed(); return; }
    run(body.subarray(from, reader.at));
    from = reader.at;
    if (!point()) dead = depth;
  };
  reach();
  while (reader.at < body.length) {
    const code = body[reader.at];
    if (code === END || code === ELSE) {
      if (code === END) depth--;
      if (dead >= 0 && dead > (code === END ? depth : depth - 1)) { dead = -1; from = reader.at; }
    }
    reader.instruction();
    if (code === BLOCK || code === LOOP || code === IF) depth++;
    if (code === LOOP || code === IF || code === ELSE || code === BR_IF || (code === END && reader.at < body.length)) reach();
  }
  if (dead < 0) run(body.subarray(from, reader.at));
}

/** The module with a mark a point, `ran0`, `ran1`, …, which is 1 once control was there; and the first point of every function. */
export function marked(bytes) {
  const all = sections(bytes);
  const at = (id) => all.findIndex((section) => section.id === id);
  const first = count(all[at(SECTION.global)]);
  let points = 0;
  const entries = [];
  const rewritten = bodies(all[at(SECTION.code)]).map((one) => {
    const parts = [one.body.subarray(0, one.begin)];
    entries.push(points);
    walk(one, { run: (part) => parts.push(part), point: () => parts.push(Uint8Array.of(0x41, 0x01, 0x24, ...leb(first + points++))) });
    return Buffer.concat(parts);
  });
  const told = Array.from({ length: points }, (_, i) => { const name = [...Buffer.from(`ran${i}`)]; return [name.length, ...name, GLOBAL, ...leb(first + i)]; });
  all[at(SECTION.global)] = append(all[at(SECTION.global)], Array(points).fill(MUTABLE_I32_OF_0));
  all[at(SECTION.export)] = append(all[at(SECTION.export)], told);
  all[at(SECTION.code)] = code(rewritten);
  return { bytes: assemble(bytes, all), entries, points };
}

/** Functions that a body calls and that come back: what is called for a panic stops anyway. */
export function calls({ body, begin }) {
  const reader = new Reader(body, begin);
  const called = new Set();
  while (reader.at < body.length) {
    const code = body[reader.at];
    const operand = new Reader(body, reader.at + 1);
    reader.instruction();
    if (code === CALL && body[reader.at] !== TRAP) called.add(operand.leb());
  }
  return called;
}

/** Which points an instance of a marked module has reached. */
export function ran(exports, points) {
  return Uint8Array.from({ length: points }, (_, i) => exports[`ran${i}`].value);
}

/**
 * The module without what is not needed: functions in `whole` stay as they are, of others those points stay that `reached` has,
 * and everything else stops when control gets there.
 */
export function trimmed(bytes, { entries, reached, whole }) {
  const all = sections(bytes);
  const at = all.findIndex(({ id }) => id === SECTION.code);
  const kept = { whole: 0, parts: 0 };
  all[at] = code(bodies(all[at]).map((one, i) => {
    if (whole.has(i)) { kept.whole++; return one.body; }
    if (!reached[entries[i]]) return STUB;
    kept.parts++;
    const parts = [one.body.subarray(0, one.begin)];
    let point = entries[i];
    walk(one, {
      run: (part) => parts.push(part),
      point: () => { const is = reached[point++] === 1; if (!is) parts.push(UNREACHABLE); return is; },
      passed: () => { point++; },
    });
    return Buffer.concat(parts);
  }));
  return { bytes: assemble(bytes, all), kept };
}
