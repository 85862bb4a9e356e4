// The engine as WebAssembly, without a browser: bits, budgets, wrong input.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { Engine, decode, encode, parseLog, prepare, renderLog } from '../js/engine.js';
import { SURFACES, sceneOf } from '../page/surfaces.js';
import { png } from '../page/save.js';
import { MOST_LETTERS, pack, unpack } from '../page/link.js';
import { solve } from '../page/shape.js';
import { bowl } from '../page/solid.js';
import { fit, photo } from '../page/tools.js';
import { DIST, fromMesh, fromPhoto, render, seeded, stroke, text, wasm } from './native.mjs';

const module = wasm();
/** Files of the page that are asked for when somebody brings or saves something. */
const LATER = ['save.js', 'tools.wasm', 'tools.js', 'own.js', 'listen.js', 'link.js', 'solid.js', 'shape.js', 'shape.wasm'];

for (const surface of SURFACES) {
  test(`a stroke over ${surface.id} has the bits of the program`, async () => {
    const { text: scene, pictures, files } = sceneOf(surface, 'x');
    const log = text(stroke(surface));
    const ours = renderLog(module, { scene, log, pictures, files });
    const beside = { 'x.toml': scene, 'x.jsonl': log };
    for (const [name, picture] of Object.entries(pictures)) beside[name] = await png(picture);
    const native = render(beside, 'x.toml');
    assert.ok(native.audio.equals(ours.audio), 'audio differs');
    assert.ok(native.haptic.equals(ours.haptic), 'haptic differs');
  });
}

test('a ball that rolls has the bits of the program, and sounds of another thing than a finger that slides', () => {
  const surface = SURFACES.find(({ id }) => id === 'granite');
  const { text: scene } = sceneOf(surface, 'x');
  const rolls = stroke(surface).map((line) => (line.uv ? { ...line, slip_m_s: 0, roll_radius_m: 0.012 } : line));
  const [ours, slid] = [rolls, stroke(surface)].map((log) => renderLog(module, { scene, log }));
  const native = render({ 'x.toml': scene, 'x.jsonl': text(rolls) }, 'x.toml');
  assert.ok(native.audio.equals(ours.audio) && native.haptic.equals(ours.haptic));
  assert.ok(!native.audio.equals(slid.audio));
});

test('an engine tells its level policy and what its limiters took', () => {
  const engine = new Engine(module);
  const { strike_gain, gain } = engine.open(sceneOf(SURFACES[0], 'x').text.replace(/^gain = .*$/m, ''), { pictures: sceneOf(SURFACES[0], 'x').pictures });
  assert.ok(strike_gain.length === 1 && strike_gain[0] > 0 && strike_gain[0] <= 1 && gain.length === 1);
  engine.render(1024);
  assert.equal(engine.stats().stats.limiter_db, 0);
  assert.throws(() => engine.report(0, { event: 'begin', contact: 1, surface: 'surface', actuator: 0, uv: [0, 0], normal_force_n: 1, slip_m_s: -1 }), /slip_m_s/);
});

/** Plays live in blocks of random size, with times that jitter; answers what left and the log. */
function live(prepared, surface, seed) {
  const engine = Engine.shell(module, prepared.image.length);
  engine.fill(prepared.image, 0, prepared.image.length);
  engine.know(prepared.told);
  const random = seeded(seed);
  const lines = stroke(surface);
  const left = [];
  for (let at = 0, next = 0; at < 2 * 48000; ) {
    const frames = 1 + Math.floor(random() * 300);
    while (next < lines.length && lines[next].t * 48000 < at + frames) {
      engine.report(500 + lines[next].t + 0.004 * random() * (lines[next].event === 'move'), lines[next++]);
    }
    engine.render(frames);
    left.push(engine.audio(0, frames).slice());
    at += frames;
  }
  return { left: left.flatMap((part) => [...part]), log: decode(engine.recorded()), late: prepared.told.latency_samples };
}

test('what was heard live is what its log renders, to the bit, after the engine was taken over from another instance', () => {
  for (const surface of SURFACES.filter(({ id }) => ['sawtooth', 'granite', 'sand', 'bell'].includes(id))) {
    const { text: scene, pictures } = sceneOf(surface, 'x');
    const { left, log, late } = live(prepare(module, { scene, pictures, rate: 48000 }), surface, 7);
    const engine = new Engine(module);
    engine.open(scene, { pictures });
    const [again] = engine.renderLog(log).audio;
    const count = Math.min(again.length, left.length - late);
    assert.ok(count > 48000);
    const differing = Array.from({ length: count }, (_, i) => again[i] !== left[i + late]).indexOf(true);
    assert.equal(differing, -1, `${surface.id}: sample ${differing}`);
  }
});

test('five minutes of random play leave the memory as it was, no contact and no refusal', (t) => {
  const surface = SURFACES.find(({ id }) => id === 'granite');
  const { text: scene } = sceneOf(surface, 'x');
  const engine = new Engine(module);
  engine.open(scene, { rate: 48000, live: true });
  engine.record();
  engine.openLevels(0, 30);
  const random = seeded(3);
  const touching = new Set();
  let [name, before] = [0, 0];
  const minutes = Number(process.env.ASPERITY_WEB_MINUTES ?? 5);
  for (let block = 0; block < (minutes * 60 * 48000) / 1024; block++) {
    const t = (block * 1024) / 48000;
    if (random() < 0.05 && touching.size < 5) {
      touching.add(++name);
      engine.report(t, { event: 'begin', contact: name, surface: 'surface', actuator: 0, uv: [random(), random()], normal_force_n: 2 * random() });
    }
    for (const contact of touching) {
      if (random() < 0.03) { touching.delete(contact); engine.report(t, { event: 'end', contact }); }
      else engine.report(t, { event: 'move', contact, uv: [random() * 3, random()], normal_force_n: 3 * random() });
    }
    if (random() < 0.03) engine.report(t, { event: 'impact', body: 'body', speed_m_s: 2 * random(), striker: 'steel', mass_kg: 0.01, radius_m: 0.005 });
    engine.render(1024);
    engine.levels();
    // The recording goes to the page twice a second.
    if (block % 24 === 0) { engine.recorded(); engine.record(); }
    if (block === 3000) before = engine.wasm.memory.buffer.byteLength;
  }
  for (let block = 0; block < 100; block++) engine.render(1024);
  const { stats } = engine.stats();
  t.diagnostic(`${(engine.wasm.memory.buffer.byteLength / 1e6).toFixed(1)} MB, ${stats.events} events`);
  assert.equal(engine.wasm.memory.buffer.byteLength, before);
  assert.deepEqual([stats.contacts, stats.refused, stats.quarantined, stats.dropped], [0, 0, 0, 0]);
});

test('what is wrong is said in words, and the engine goes on', () => {
  const engine = new Engine(module);
  assert.throws(() => engine.stats(), /no scene is open/);
  assert.throws(() => engine.open('[[surface]]\nname = 3'), /name/);
  assert.throws(() => engine.open('\u0000\u{1F600}'), /scene\.toml/);
  assert.throws(() => engine.open('[[surface]]\nname = "a"\ndisplacement = "gone.png"\nrelief_m = 1e-3\nwidth_m = 1.0\nheight_m = 1.0'), /gone\.png/);
  assert.throws(() => engine.addPicture('p.png', { width: 4, height: 4, samples: new Uint8Array(3) }), /p\.png/);
  assert.throws(() => engine.addPicture('p.png', { width: 4e9, height: 4e9, samples: new Uint16Array(2) }), /p\.png/);
  engine.open(sceneOf(SURFACES[5], 'x').text, { rate: 48000 });
  const good = { event: 'begin', contact: 1, surface: 'surface', actuator: 0, uv: [0, 0], normal_force_n: 1 };
  for (const [bad, words] of [
    [{ ...good, surface: 'moon' }, /moon.*must be one of surface/], [{ ...good, event: 'dance' }, /begin, move, end or impact/],
    [{ ...good, normal_force_n: NaN }, /normal_force_n/], [{ ...good, uv: [NaN, 0] }, /uv/], [{ ...good, contact: -1 }, /contact/],
    [{ ...good, actuator: 9 }, /actuator/], [{ ...good, colour: 'red' }, /colour/], [{ event: 'impact', body: 'body', speed_m_s: -1 }, /speed_m_s/],
    [{ event: 'impact', body: 'body', striker: 'cheese' }, /cheese.*steel/],
  ]) assert.throws(() => engine.report(0, bad), words, JSON.stringify(bad));
  assert.throws(() => engine.do('explode'), /mute/);
  assert.throws(() => engine.do('audioGain', NaN), /gain/);
  assert.throws(() => engine.relief('nowhere', 8), /nowhere/);
  assert.throws(() => engine.openPicture('surface'), /never changes|change/);
  assert.throws(() => parseLog('{"t":1}\nnonsense'), /log:2/);
  assert.throws(() => parseLog('{"t":1,"event":"end","contact":1}\n{"t":0,"event":"end","contact":1}'), /backwards/);
  engine.report(0, good);
  for (let n = 1; n < 10; n++) {
    engine.report(n / 50, { event: 'move', contact: 1, uv: [n / 100, 0], normal_force_n: 1 });
    engine.render(1024);
  }
  assert.ok(engine.haptic(0, 1024).some((x) => x !== 0));
});

test('rows that JavaScript never writes do no harm', () => {
  const engine = new Engine(module);
  engine.open(sceneOf(SURFACES[5], 'x').text, { rate: 48000 });
  const random = seeded(11);
  const odd = [NaN, Infinity, -Infinity, 0, -0, 1, 2, 3, 4, -1, 0.5, 1e9, 1e308, 2 ** 53, 65536, 5e-324];
  for (let i = 0; i < 20000; i++) {
    const row = engine.row();
    for (let k = 0; k < row.length; k++) row[k] = random() < 0.5 ? odd[Math.floor(random() * odd.length)] : random() * 4;
    engine.wasm.asp_report();
    if (i % 16 === 0) engine.render(Math.floor(random() * 3000));
    const out = engine.audio(0, 128);
    assert.ok(out === null || out.every(Number.isFinite));
  }
  for (const number of [0, 1, 15, 16, 99, 2 ** 31, 2 ** 32 - 1]) {
    engine.wasm.asp_audio(number);
    engine.wasm.asp_haptic(number);
    engine.wasm.asp_open_levels(number, number);
    engine.wasm.asp_open_picture(number);
    engine.wasm.asp_do(number, number, number);
    engine.wasm.asp_file(number);
    engine.wasm.asp_picture(number, number, number, number);
  }
});

test('text goes through UTF-8 and back', () => {
  for (const words of ['', 'µm ≤ 10⁻⁶ 😀', '\u{10ffff}\u07ff\u0800']) {
    assert.deepEqual(encode(words), new TextEncoder().encode(words));
    assert.equal(decode(encode(words)), words);
  }
});

test('all that the first surface loads is at most 600 kB gzipped', (t) => {
  const files = readdirSync(join(DIST, 'page')).filter((name) => !LATER.includes(name));
  // As servers keep them, by gzip itself; node's own finds 0.7 % less to leave out.
  const bytes = Object.fromEntries(files.map((name) => [name, execFileSync('gzip', ['-9', '-c', join(DIST, 'page', name)]).length]));
  const all = Object.values(bytes).reduce((sum, n) => sum + n, 0);
  t.diagnostic(`${all} bytes gzipped, ${bytes['asperity.wasm']} of them the engine`);
  assert.ok(all <= 600_000, JSON.stringify(bytes));
});

test('the page names no folder of the machine that built it', () => {
  for (const name of ['asperity.wasm', 'tools.wasm', 'shape.wasm']) {
    assert.ok(!/\/registry\/src\/|\/rustc\/[0-9a-f]{40}/.test(readFileSync(join(DIST, 'page', name), 'latin1')), name);
  }
});

test('a bowl solved in the page has the modes that the program finds, within 2 %', (t) => {
  const solver = new WebAssembly.Module(readFileSync(join(DIST, 'page/shape.wasm')));
  const began = process.cpuUsage();
  const { modes, unknowns } = solve(solver, { name: 'bowl.obj', bytes: encode(bowl()) });
  t.diagnostic(`${unknowns} unknowns in ${(process.cpuUsage(began).user / 1e6).toFixed(1)} s`);
  const [ours, theirs] = [JSON.parse(modes), fromMesh(bowl(), 'ceramic', 10)];
  theirs.modes.forEach(({ frequency_hz, decay_per_s }, i) => {
    assert.ok(Math.abs(ours.modes[i].frequency_hz / frequency_hz - 1) < 0.02, `mode ${i}: ${ours.modes[i].frequency_hz} and ${frequency_hz} Hz`);
    assert.ok(Math.abs(ours.modes[i].decay_per_s / decay_per_s - 1) < 0.02);
    assert.ok(Math.abs(ours.shapes.gains[i] / theirs.shapes.gains[i] - 1) < 0.05, `gain ${i}`);
  });
  for (const bytes of [encode(''), encode('v 0 0'), encode('f 1 2 3'), new Uint8Array(1000)]) assert.throws(() => solve(solver, { name: 'x.obj', bytes }), /x\.obj/);
  assert.throws(() => solve(solver, { name: 'x.ply', bytes: encode('ply') }), /x\.ply: is no whole PLY/);
  assert.throws(() => solve(solver, { name: 'x.pdf', bytes: encode('%PDF') }), /\.obj, \.stl/);
});

test('a stroke goes into a link and comes back as it was played, however long it was', async () => {
  const lines = stroke(SURFACES[0]);
  const back = await unpack(await pack(lines));
  assert.equal(back.length, lines.length);
  lines.forEach((line, i) => {
    assert.equal(back[i].event, line.event);
    assert.ok(Math.abs(back[i].t - (line.t - lines[0].t)) < 1e-4);
    (line.uv ?? []).forEach((x, k) => assert.ok(Math.abs(back[i].uv[k] - x) < 1e-5));
    if (line.normal_force_n) assert.ok(Math.abs(back[i].normal_force_n - line.normal_force_n) < 0.006);
  });
  const random = seeded(4);
  const long = Array.from({ length: 20000 }, (_, i) => ({ t: i / 200, event: i === 0 ? 'begin' : 'move', contact: 1, uv: [random(), random()], velocity_m_s: [random(), random()], normal_force_n: random() }));
  const text = await pack(long.map((line, i) => (i % 400 === 0 ? { ...line, event: 'begin' } : i % 400 === 399 ? { t: line.t, event: 'end', contact: 1 } : line)));
  const kept = await unpack(text);
  assert.ok(text.length <= MOST_LETTERS && kept.length > 100, `${text.length} letters, ${kept.length} events`);
  assert.equal(await pack([]), '');
});

test('a stroke in a link that somebody has changed is refused in words or plays', async () => {
  const good = await pack(stroke(SURFACES[0]));
  const random = seeded(8);
  for (let i = 0; i < 1000; i++) {
    const letters = [...good];
    for (let k = 0; k < 1 + 3 * random(); k++) letters[Math.floor(random() * letters.length)] = 'ABCxyz019-_'[Math.floor(11 * random())];
    const changed = letters.slice(0, random() < 0.3 ? Math.floor(random() * letters.length) : letters.length).join('');
    const events = await unpack(changed).catch((error) => { assert.match(error.message, /^the stroke in the link /); return []; });
    assert.ok(events.every(({ t, uv }) => Number.isFinite(t) && (uv ?? [0]).every(Number.isFinite)));
  }
  for (const text of ['!', 'A'.repeat(MOST_LETTERS + 1), 'AAAA', '====', '%00']) await assert.rejects(unpack(text), /the stroke in the link/);
});

const tools = new WebAssembly.Module(readFileSync(join(DIST, 'page/tools.wasm')));

test('a recorded hit becomes the modes that it is made of, and the engine plays them', () => {
  const rate = 48000;
  const truth = [[440, 6, 0.4], [1113.7, 11, 0.25], [2975, 24, 0.15]];
  const random = seeded(2);
  const samples = Float64Array.from({ length: 1.5 * rate }, (_, i) => {
    const t = i / rate - 0.1;
    return 1e-5 * (random() - 0.5) + (t < 0 ? 0 : truth.reduce((sum, [hz, d, a]) => sum + a * Math.exp(-d * t) * Math.sin(2 * Math.PI * hz * t), 0));
  });
  const modes = fit(tools, { name: 'hit.wav', samples, rate });
  const found = JSON.parse(modes).modes;
  for (const [hz, decay] of truth) assert.ok(found.some((mode) => Math.abs(mode.frequency_hz / hz - 1) < 1e-4 && Math.abs(mode.decay_per_s / decay - 1) < 0.01), `${hz} Hz of ${modes}`);
  const { text: scene, pictures, files } = sceneOf(SURFACES[0], 'x', modes);
  const { audio } = renderLog(module, { scene, log: text(stroke(SURFACES[0])), pictures, files });
  const heard = new Float32Array(audio.slice(68).buffer);
  assert.ok(heard.every(Number.isFinite) && heard.some((x) => Math.abs(x) > 0.01));
});

test('what is no hit and no photograph is refused in words by the tools', () => {
  const noise = seeded(6);
  for (const samples of [new Float64Array(0), new Float64Array(48000), Float64Array.of(NaN, 1, 2), Float64Array.from({ length: 9 }, noise)]) {
    assert.throws(() => fit(tools, { name: 'x', samples, rate: 48000 }), (error) => !(error instanceof WebAssembly.RuntimeError) && error.message.length > 10);
  }
  assert.throws(() => fit(tools, { name: 'x', samples: Float64Array.from({ length: 48000 }, noise), rate: NaN }), Error);
  for (const [width, height, grey] of [[4, 4, new Float64Array(16)], [64, 64, new Float64Array(10)], [64, 64, new Float64Array(4096).fill(NaN)], [1e9, 1e9, new Float64Array(4)]]) {
    assert.throws(() => photo(tools, { width, height, grey, texel_m: 1e-4 }), (error) => !(error instanceof WebAssembly.RuntimeError) && error.message.length > 10);
  }
});

test('a photograph becomes the relief that the program makes of it', async () => {
  const side = 128;
  const random = seeded(12);
  const grain = Float64Array.from({ length: side * side }, random);
  const samples = Uint16Array.from({ length: side * side }, (_, i) => {
    const [x, y] = [i % side, Math.floor(i / side)];
    return Math.round(65535 * (0.45 + 0.3 * Math.cos(x / 5 + Math.sin(y / 11)) * Math.cos(y / 7) + 0.1 * grain[i]));
  });
  const grey = Float64Array.from(samples, (x) => x / 65535);
  const ours = photo(tools, { width: side, height: side, grey, texel_m: 0.12 / side });
  const { report, displacement } = fromPhoto(await png({ width: side, height: side, samples }), 0.12);
  assert.ok(Math.abs(ours.relief_m / report.relief_m - 1) < 1e-6, `${ours.relief_m} m and ${report.relief_m} m`);
  const apart = ours.displacement.samples.reduce((most, x, i) => Math.max(most, Math.abs(x - displacement[i])), 0);
  assert.ok(apart <= 2, `${apart} of 65535`);
});
