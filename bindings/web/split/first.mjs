// node split/first.mjs WHOLE.wasm FIRST.wasm: of the engine, what the first surface of the page needs.
//
// Opening the first surface takes the same way through the engine every time, so of that only those stretches stay that control reaches. What a visitor
// does with it varies: short functions that ran while a seeded visitor played stay whole, of long ones what was reached. Everything else stops when
// control gets there; whoever runs this part of the engine then takes the whole one, which is on its way by then (js/worklet.js). Memory,
// table and numbers of functions are those of the whole engine, so one goes on with the memory of the other.
import { readFileSync, writeFileSync } from 'node:fs';
import { SECTION, bodies, sections } from './binary.mjs';
import { marked, ran, trimmed } from './split.mjs';
import { opened, play, taken, trouble } from './visit.mjs';

/** A function of at most so many bytes stays whole, if it ever plays. */
const SHORT_BYTES = 500;
/** So does one of which so much was reached anyway. */
const MOST_OF_IT = 0.7;
const SEEDS = [1, 2];
const SECONDS = 6;
const VISITORS = 24;

const [from, to] = process.argv.slice(2);
const whole = new Uint8Array(readFileSync(from));
const { bytes, entries, points } = marked(whole);
const module = new WebAssembly.Module(bytes);
const reached = new Uint8Array(points);
const note = ({ wasm }) => { const now = ran(wasm, points); for (let i = 0; i < points; i++) reached[i] |= now[i]; return now; };

const first = opened(module);
const plays = new Set();
for (const seed of SEEDS) {
  const engine = taken(module, first);
  play(engine, seed, SECONDS);
  trouble(engine);
  play(engine, seed + 100, 2);
  const now = note(engine);
  entries.forEach((point, i) => { if (now[point] === 1) plays.add(i); });
}
note(first);
const sizes = bodies(sections(whole).find(({ id }) => id === SECTION.code)).map(({ body }) => body.length);
const left = bodies(sections(trimmed(whole, { entries, reached, whole: new Set() }).bytes).find(({ id }) => id === SECTION.code)).map(({ body }) => body.length);
const kept = new Set([...plays].filter((i) => sizes[i] <= SHORT_BYTES || left[i] >= MOST_OF_IT * sizes[i]));
let part = trimmed(whole, { entries, reached, whole: kept });

// More visitors, who need no marks and so go through it ten times as fast: where one stops, that function stays whole.
for (let seed = 1000; seed < 1000 + VISITORS; seed++) {
  for (;;) {
    const lacking = visit(new WebAssembly.Module(part.bytes), seed);
    if (lacking === null) break;
    if (kept.has(lacking)) throw new Error(`split/first.mjs: function ${lacking} stops although it is whole`);
    kept.add(lacking);
    part = trimmed(whole, { entries, reached, whole: kept });
  }
}
writeFileSync(to, part.bytes);
console.log(`the first surface needs ${part.kept.whole} functions and stretches of ${part.kept.parts} more, of ${sizes.length}`);

/** The function that stops a visitor, or null. */
function visit(module, seed) {
  const engine = taken(module, opened(module));
  try {
    play(engine, seed, 4);
    trouble(engine);
    play(engine, seed + 100, 1);
    return null;
  } catch (error) {
    const [, stopped] = /wasm-function\[(\d+)\]/.exec(error.stack) ?? [];
    if (stopped === undefined) throw error;
    return Number(stopped);
  }
}
