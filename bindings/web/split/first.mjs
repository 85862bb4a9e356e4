// node split/first.mjs WHOLE.wasm FIRST.wasm: of the engine, what the first surface of the page needs.
//
// Opening the first surface takes the same way through the engine every time, so of that only those stretches stay that control reaches. What a visitor
// does with it varies: what was reached while some dozens of seeded visitors played stays, and as many whole functions of it as there is room
// for. Everything else stops when control gets there; the whole one then does what was done and goes on
// (js/worklet.js). Memory, table and numbers of functions are those of the whole engine, so one goes on with the memory of the other.
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { SECTION, bodies, sections } from './binary.mjs';
import { marked, ran, trimmed } from './split.mjs';
import { opened, taken, trouble, visit } from './visit.mjs';

/**
 * How generous the part is, from the most: functions of so many bytes stay whole if they ever play, and those of which such a share was reached. The
 * first that fits is taken.
 */
const GENEROUS = [[2000, 0.5], [1000, 0.6], [500, 0.7], [300, 0.8], [150, 0.9], [60, 0.95], [0, 1]];
/** What the part may take, gzipped: with the rest of the page 250 kB. */
const MOST_BYTES = 218_000;
const SEEDS = [1, 2, 3, 6];
const SECONDS = 5;
const VISITORS = 48;

const [from, to] = process.argv.slice(2);
const whole = new Uint8Array(readFileSync(from));
const { bytes, entries, points } = marked(whole);
const module = new WebAssembly.Module(bytes);
const reached = new Uint8Array(points);
const note = ({ wasm }) => { const now = ran(wasm, points); for (let i = 0; i < points; i++) reached[i] |= now[i]; return now; };

const first = opened(module);
const plays = new Set();
const watched = (visitor, seed) => {
  const engine = taken(module, first);
  visitor(engine, seed);
  const now = note(engine);
  entries.forEach((point, i) => { if (now[point] === 1) plays.add(i); });
};
const visitor = (engine, seed) => { visit(engine, seed, SECONDS); trouble(engine); visit(engine, seed + 100, 1); };
for (const seed of SEEDS) watched(visitor, seed);
note(first);
const lengths = (bytes) => bodies(sections(bytes).find(({ id }) => id === SECTION.code)).map(({ body }) => body.length);
const sizes = lengths(whole);

// More visitors, who need no marks and so go through it ten times as fast; where one stops, he is watched.
const least = () => trimmed(whole, { entries, reached, whole: new Set() });
let part = least();
for (let seed = 1000; seed < 1000 + VISITORS; seed++) {
  if (!stops(new WebAssembly.Module(part.bytes), seed)) continue;
  watched(visitor, seed);
  part = least();
  if (stops(new WebAssembly.Module(part.bytes), seed)) throw new Error(`split/first.mjs: visitor ${seed} stops where he was watched`);
}

const left = lengths(part.bytes);
for (const [short, share] of GENEROUS) {
  const kept = new Set([...plays].filter((i) => sizes[i] <= short || left[i] >= share * sizes[i]));
  part = trimmed(whole, { entries, reached, whole: kept });
  if (gzipSync(part.bytes, { level: 9 }).length <= MOST_BYTES) break;
}
writeFileSync(to, part.bytes);
console.log(`the first surface needs ${part.kept.whole} functions and stretches of ${part.kept.parts} more, of ${sizes.length}`);

/** Whether something that the part lacks stops a visitor. */
function stops(module, seed) {
  try {
    visitor(taken(module, opened(module)), seed);
    return false;
  } catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError)) throw error;
    return true;
  }
}
