// The audio thread's half without a browser: it plays block by block, with a part of the engine first.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { decode, prepare } from '../js/engine.js';
import { SURFACES, sceneOf } from '../page/surfaces.js';
import { marked, ran, trimmed } from '../split/split.mjs';
import { opened, taken } from '../split/visit.mjs';
import { DIST } from './native.mjs';

const BLOCK = 128;
let Processor;
Object.assign(globalThis, {
  AudioWorkletProcessor: class { port = { told: [], postMessage(message) { this.told.push(message); } }; },
  registerProcessor: (_name, made) => { Processor = made; },
  sampleRate: 48000,
  currentTime: 0,
});
await import('../js/worklet.js');

const bytes = readFileSync(join(DIST, 'page/asperity.wasm'));
const begin = { event: 'begin', contact: 1, surface: 'surface', actuator: 0, uv: [0.1, 0.5], normal_force_n: 0.8, closing_m_s: 0.04 };
const move = (n) => ({ event: 'move', contact: 1, uv: [0.1 + n / 100, 0.5], normal_force_n: 0.8 });
const blow = { event: 'impact', body: 'body', speed_m_s: 0.7, actuator: 0, ...SURFACES[0].blow };

/** The engine as far as a finger needs it that nothing else joins. */
function forAFinger() {
  const whole = new Uint8Array(bytes);
  const { bytes: instrumented, entries, points } = marked(whole);
  const module = new WebAssembly.Module(instrumented);
  const first = opened(module);
  const engine = taken(module, first);
  for (let block = 0; block < 300; block++) {
    if (block % 6 === 0) engine.report(500 + (block * BLOCK) / 48000, block === 0 ? begin : move(block / 6));
    engine.render(BLOCK);
    for (const look of [engine.scope(), engine.audio(0, BLOCK), engine.haptic(0, BLOCK), engine.position]) assert.ok(look !== null);
    if (block % 6 === 0) engine.levels();
    if (block % 100 === 99) { engine.recorded(); engine.record(); }
  }
  const opening = ran(first.wasm, points);
  const reached = ran(engine.wasm, points).map((is, i) => is | opening[i]);
  return trimmed(whole, { entries, reached, whole: new Set() }).bytes;
}

/** Plays a finger, and a blow in the middle; the whole engine comes at block `comes`. Answers samples, log and what was told. */
async function played(wasm, part, comes) {
  const { text, pictures, files } = sceneOf(SURFACES[0], 'x');
  const prepared = prepare(new WebAssembly.Module(bytes), { scene: text, pictures, files, rate: 48000, levels: 30 });
  const processor = new Processor({ processorOptions: { wasm, part, prepared } });
  const samples = [];
  for (let block = 0; block < 700; block++) {
    if (block === comes) {
      processor.hear({ do: 'complete', wasm: bytes, id: 1 });
      await new Promise((resolve) => setTimeout(resolve, 300));
    }
    if (block % 6 === 0 && block < 600) processor.hear({ do: 'events', events: [{ t: 500 + (block * BLOCK) / 48000, ...(block === 0 ? begin : move(block / 6)) }] });
    if (block === 200) processor.hear({ do: 'events', events: [{ t: 500 + (block * BLOCK) / 48000, ...blow }] });
    if (block === 600) processor.hear({ do: 'events', events: [{ t: 500 + (block * BLOCK) / 48000, event: 'end', contact: 1 }] });
    const outputs = [[new Float32Array(BLOCK), new Float32Array(BLOCK)], [new Float32Array(BLOCK)]];
    processor.process([], outputs);
    samples.push(outputs[0][0]);
    if (block % 50 === 0) await new Promise((resolve) => setTimeout(resolve));
  }
  processor.hear({ do: 'log', id: 2 });
  const { told } = processor.port;
  const log = told.filter((message) => message.log).map((message) => decode(message.log).replace(/^\{"version":1,/, '{')).join('');
  return { samples, log, told, stats: processor.stats().stats };
}

const unlike = (ours, theirs) => ours.findIndex((block, n) => block.some((x, i) => x !== theirs[n][i]));

test('a part of the engine that lacks something is silent until the whole one has come and caught up; what is played goes on, and the log is whole', async (t) => {
  const theirs = await played(bytes, false, -1);
  const ours = await played(forAFinger(), true, 240);
  assert.equal(ours.told.filter(({ lacking }) => lacking).length, 1);
  const first = unlike(ours.samples, theirs.samples);
  assert.ok(first >= 200 && first < 210, `block ${first} is the first that differs`);
  const after = 1 + ours.samples.findLastIndex((block, n) => unlike([block], [theirs.samples[n]]) === 0);
  t.diagnostic(`${first} to ${after} of 700: ${((after - 240) * BLOCK) / 48} ms after the whole engine had come`);
  assert.ok(after < 240 + 110, `block ${after}`);
  assert.equal(ours.log, theirs.log);
  assert.deepEqual(ours.stats, theirs.stats);
  assert.deepEqual(ours.told.filter(({ refused }) => refused), []);
});

test('a finger that never lets go hears nothing of the whole engine taking over', async () => {
  const [theirs, ours] = [await played(bytes, false, -1), await played(readFileSync(join(DIST, 'page/first.wasm')), true, 100)];
  assert.equal(ours.told.filter(({ lacking }) => lacking).length, 0);
  assert.ok(ours.told.some(({ id }) => id === 1), 'the whole engine plays');
  assert.equal(unlike(ours.samples, theirs.samples), -1);
  assert.equal(ours.log, theirs.log);
});
