// node split/first.mjs WHOLE.wasm FIRST.wasm: of the engine, what the first surface of the page needs.
//
// Opening the first surface takes the same way through the engine every time, so of that only those stretches stay that control reaches. What a visitor
// does with it varies: what was reached while some dozens of seeded visitors played stays, and as many of those functions whole, with the little they call, as
// there is room for; those that lack least come first. Everything else stops when control gets there; the whole one then does what was done and goes on
// (js/worklet.js). Memory, table and numbers of functions are those of the whole engine, so one goes on with the memory of the other.
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { SECTION, bodies, sections } from './binary.mjs';
import { calls, marked, ran, trimmed } from './split.mjs';
import { opened, taken, trouble, visit } from './visit.mjs';

/** What the part may take, gzipped: with the rest of the page 250 kB. */
const MOST_BYTES = 219_000;
const SEEDS = [1, 2, 3, 6, 7, 8, 9, 10, 11, 12];
/** The whole engine is asked for after a second of sound. */
const SECONDS = 3;
const VISITORS = 120;
/** Who is called by a function that stays whole stays whole too, where he lacks so little; what is longer is another way through the engine. */
const SMALL = 300;

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
const visitor = (engine, seed) => visit(engine, seed, SECONDS);
for (const seed of SEEDS) watched((engine) => { visitor(engine, seed); trouble(engine); visit(engine, seed + 100, 1); }, seed);
note(first);
const functions = (bytes) => bodies(sections(bytes).find(({ id }) => id === SECTION.code));

// More visitors, who need no marks and so go through it ten times as fast; where one stops, he is watched.
const least = () => trimmed(whole, { entries, reached, whole: new Set() });
let part = least();
for (let seed = 1000; seed < 1000 + VISITORS; seed++) {
  if (!stops(new WebAssembly.Module(part.bytes), seed)) continue;
  watched(visitor, seed);
  part = least();
  if (stops(new WebAssembly.Module(part.bytes), seed)) throw new Error(`split/first.mjs: visitor ${seed} stops where he was watched`);
}

const all = functions(whole);
const smallest = gzipSync(part.bytes, { level: 9 }).length;
const left = functions(part.bytes).map(({ body }) => body.length);
const lacks = (i) => all[i].body.length - left[i];
const wholes = [...plays].map((i) => withCalled(i)).sort((a, b) => a.bytes - b.bytes);
// As many of them as fit, by halves.
let [fits, most] = [0, wholes.length + 1];
while (most - fits > 1) {
  const tried = (fits + most) >> 1;
  if (gzipSync(generous(tried).bytes, { level: 9 }).length <= MOST_BYTES) fits = tried;
  else most = tried;
}
part = generous(fits);
// It opens the surface itself; the visitors took over what the marked one had opened, which is the same memory.
opened(new WebAssembly.Module(part.bytes));
writeFileSync(to, part.bytes);
console.log(`the first surface needs ${part.kept.whole} functions (${fits} of ${wholes.length} that play) and stretches of ${part.kept.parts} more, of ${all.length}; at least ${smallest} bytes gzipped`);

/** A function with the little it calls as far as that is not there, and how many bytes that lacks. */
function withCalled(i) {
  const together = new Set([i]);
  for (const one of together) if (lacks(one) > 0) for (const called of calls(all[one])) if (lacks(called) > 0 && lacks(called) <= SMALL) together.add(called);
  return { together, bytes: [...together].reduce((sum, one) => sum + lacks(one), 0) };
}

/** The part with so many functions that play, whole. */
function generous(count) {
  const kept = new Set(wholes.slice(0, count).flatMap(({ together }) => [...together]));
  return trimmed(whole, { entries, reached, whole: kept });
}

/** Whether something that the part lacks stops a visitor. */
function stops(module, seed) {
  try {
    visitor(taken(module, first), seed);
    return false;
  } catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError)) throw error;
    return true;
  }
}
