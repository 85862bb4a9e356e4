// The audio thread's half without a browser: it plays block by block.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { Engine, decode, prepare } from '../js/engine.js';
import { SURFACES, sceneOf } from '../page/surfaces.js';
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

const FIRST_S = 500;

/** What is reported before block `block` of 700: a finger, and a blow in the middle. */
function reported(block) {
  const t = FIRST_S + (block * BLOCK) / 48000;
  const events = [];
  if (block % 6 === 0 && block < 600) events.push({ t, ...(block === 0 ? begin : move(block / 6)) });
  if (block === 200) events.push({ t, ...blow });
  if (block === 600) events.push({ t, event: 'end', contact: 1 });
  return events;
}

const prepared = () => {
  const { text, pictures, files } = sceneOf(SURFACES[0], 'x');
  return prepare(new WebAssembly.Module(bytes), { scene: text, pictures, files, rate: 48000, levels: 30 });
};

test('the audio thread plays what the engine renders, and tells the whole log', () => {
  const { image, told } = prepared();
  const engine = Engine.shell(new WebAssembly.Module(bytes), image.length);
  engine.fill(image, 0, image.length);
  engine.know(told);
  const processor = new Processor({ processorOptions: { wasm: bytes, prepared: prepared() } });
  let loudest = 0;
  for (let block = 0; block < 700; block++) {
    for (const event of reported(block)) {
      engine.report(event.t, event);
      processor.hear({ do: 'events', events: [event] });
    }
    const outputs = [[new Float32Array(BLOCK), new Float32Array(BLOCK)], [new Float32Array(BLOCK)]];
    processor.process([], outputs);
    engine.render(BLOCK);
    assert.deepEqual(outputs[0][0], engine.audio(0, BLOCK).slice(), `block ${block}`);
    assert.deepEqual(outputs[1][0], engine.haptic(0, BLOCK).slice(), `block ${block}`);
    loudest = Math.max(loudest, ...outputs[0][0].map(Math.abs));
  }
  assert.ok(loudest > 0.01, `${loudest}`);
  processor.hear({ do: 'log', id: 2 });
  const sent = processor.port.told.filter((message) => message.log).map((message) => decode(message.log).replace(/^\{"version":1,/, '{')).join('');
  assert.equal(sent, decode(engine.recorded()).replace(/^\{"version":1,/, '{'));
  assert.deepEqual(processor.stats().stats, engine.stats().stats);
  assert.deepEqual(processor.port.told.filter(({ refused }) => refused), []);
});

test('an event that the engine refuses is told to the page, and the sound goes on', () => {
  const processor = new Processor({ processorOptions: { wasm: bytes, prepared: prepared() } });
  processor.hear({ do: 'events', events: [{ t: FIRST_S, ...begin, normal_force_n: NaN }, { t: FIRST_S, ...begin }] });
  const refused = processor.port.told.filter((message) => message.refused);
  assert.equal(refused.length, 1);
  assert.match(refused[0].refused, /normal_force_n/);
  const outputs = [[new Float32Array(BLOCK), new Float32Array(BLOCK)], [new Float32Array(BLOCK)]];
  assert.ok(processor.process([], outputs));
});
