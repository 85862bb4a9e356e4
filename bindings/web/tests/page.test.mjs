// The page in a real browser.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { SURFACES, sceneOf } from '../page/surfaces.js';
import { wav } from '../js/engine.js';
import { png } from '../page/save.js';
import { browser, drag, heard, host, line, open, ready, stats } from './host.mjs';
import { DIST, render, samples, seeded, stroke, text, unzip } from './native.mjs';

const require = createRequire(`${process.env.WORK}/node_modules/`);
const PICTURES = join(process.env.WORK, 'pictures');
mkdirSync(PICTURES, { recursive: true });
let [server, chromium] = [];
before(async () => { [server, chromium] = [await host(join(DIST, 'page')), await browser()]; });
after(async () => { await chromium?.close(); server?.close(); });

const sounding = (options, hash = '') => heard(chromium, server.url + hash, options);

test('a scripted stroke rendered by an OfflineAudioContext has the same digest twice, and the bits of the program', async () => {
  const { context, page, wrong } = await open(chromium, server.url);
  const surface = SURFACES.find(({ id }) => id === 'bell');
  const { text: scene, pictures } = sceneOf(surface, 'x');
  const log = text(stroke(surface));
  const plain = Object.fromEntries(Object.entries(pictures).map(([name, { width, height, samples: s }]) => [name, { width, height, samples: [...s] }]));
  const frames = 3 * 48000;
  const once = () => page.evaluate(async ({ scene, log, plain, frames }) => {
    const { createEngine } = await import('./asperity.js');
    const pictures = Object.fromEntries(Object.entries(plain).map(([name, p]) => [name, { ...p, samples: Uint16Array.from(p.samples) }]));
    const offline = new OfflineAudioContext({ numberOfChannels: 2, length: frames, sampleRate: 48000 });
    const engine = await createEngine(offline, { scene, pictures, log });
    engine.connect(offline.destination);
    const buffer = await offline.startRendering();
    const left = buffer.getChannelData(0);
    const digest = await crypto.subtle.digest('SHA-256', left);
    const bytes = new Uint8Array(left.buffer);
    let binary = '';
    for (let i = 0; i < bytes.length; i += 8192) binary += String.fromCharCode(...bytes.subarray(i, i + 8192));
    return { digest: [...new Uint8Array(digest)].join(), late: engine.told.latency_samples, samples: btoa(binary) };
  }, { scene, log, plain, frames });
  const [first, second] = [await once(), await once()];
  assert.equal(first.digest, second.digest);
  const beside = { 'x.toml': scene, 'x.jsonl': log };
  for (const [name, picture] of Object.entries(pictures)) beside[name] = await png(picture);
  const native = samples(render(beside, 'x.toml').audio);
  const ours = new Float32Array(Uint8Array.from(Buffer.from(first.samples, 'base64')).buffer);
  const count = Math.min(native.length, ours.length - first.late);
  assert.ok(count > 48000 && native.some((x) => Math.abs(x) > 0.01));
  assert.equal(native.subarray(0, count).findIndex((x, i) => x !== ours[i + first.late]), -1);
  assert.deepEqual(wrong, []);
  await context.close();
});

test('what is saved is rendered by the program to the same file, byte for byte', async () => {
  const { context, page, wrong } = await sounding();
  for (const id of ['sawtooth', 'sand', 'bell']) {
    await page.click(`[data-id=${id}]`);
    await ready(page, id);
    await drag(page, line(260, 30));
    await page.mouse.click(400, 300);
    await drag(page, line(300, 20).reverse());
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
    const files = unzip(readFileSync(await download.path()));
    const name = `asperity-${id}`;
    const native = render(files, `${name}.toml`);
    assert.ok(native.audio.equals(files[`${name}.wav`]), `${id}: audio differs`);
    assert.ok(native.haptic.equals(files[`${name}.haptic.wav`]), `${id}: haptic differs`);
    assert.ok(samples(native.audio).some((x) => Math.abs(x) > 1e-4), `${id} is silent`);
  }
  assert.deepEqual(wrong, []);
  await context.close();
});

test('a touch reaches the samples within a block and 10 ms', async (t) => {
  const { context, page } = await sounding();
  const times = [];
  for (let i = 0; i < 40; i++) {
    await page.evaluate(() => { window.asperity.state.latency_ms = undefined; });
    await page.mouse.move(300 + 8 * i, 260);
    await page.mouse.down();
    times.push(await (await page.waitForFunction(() => window.asperity.state.latency_ms, null, { polling: 5, timeout: 5000 }).catch(() => null))?.jsonValue() ?? 0);
    await page.mouse.move(310 + 8 * i, 262);
    await page.mouse.up();
    await page.waitForTimeout(30);
  }
  times.sort((a, b) => a - b);
  const { stats: { ahead } } = await stats(page);
  t.diagnostic(`median ${times[20]} ms, nine of ten ${times[36]} ms; the last stamp lay ${(ahead / 48).toFixed(1)} ms ahead`);
  assert.ok(times[20] <= 128 / 48 + 10, `${times}`);
  await context.close();
});

test('a frozen page, a hidden one and another size leave no contact behind and no error', async () => {
  const { context, page, wrong } = await sounding();
  await page.mouse.move(300, 250);
  await page.mouse.down();
  await page.mouse.move(330, 250);
  await page.evaluate(() => { const until = performance.now() + 200; while (performance.now() < until); });
  await page.mouse.move(360, 250);
  await page.waitForTimeout(200);
  assert.equal((await stats(page)).stats.contacts, 1);
  // Hidden: the finger is let go, whatever the mouse does.
  await page.evaluate(() => { Object.defineProperty(document, 'hidden', { value: true, configurable: true }); document.dispatchEvent(new Event('visibilitychange')); });
  await page.waitForTimeout(700);
  assert.equal((await stats(page)).stats.contacts, 0);
  await page.evaluate(() => { delete document.hidden; document.dispatchEvent(new Event('visibilitychange')); });
  await page.mouse.up();
  for (const [width, height] of [[390, 700], [1600, 900], [320, 400], [1024, 720]]) {
    await page.setViewportSize({ width, height });
    await drag(page, line(150, 8, 60));
  }
  // Who has only stroked so far is told how to hit.
  await page.waitForFunction(() => document.getElementById('hint').textContent === 'now tap it', null, { timeout: 20000 });
  await page.mouse.click(300, 200);
  assert.ok(await page.evaluate(() => document.getElementById('hint').classList.contains('gone')));
  await page.waitForTimeout(400);
  const after = await stats(page);
  assert.deepEqual([after.stats.contacts, after.stats.refused, wrong.length], [0, 0, 0], wrong.join());
  await context.close();
});

test('a sound device that changes, goes and comes back under a finger leaves it stroking', async (t) => {
  const { context, page, wrong } = await sounding();
  await page.mouse.move(300, 250);
  await page.mouse.down();
  const stroked = async (from) => {
    const before = await page.evaluate(() => window.asperity.state.frames);
    for (const place of line(250, 10, from)) { await page.mouse.move(...place); await page.waitForTimeout(16); }
    await page.waitForFunction((frames) => window.asperity.state.frames > frames + 5 && window.asperity.state.touching, before, { timeout: 20000 });
  };
  await stroked(300);
  // Another device, and the usual one again, which a machine without a sound card does not have: Chromium begins its output anew.
  const sinks = await page.evaluate(async () => {
    const { context } = window.asperity.state;
    if (!context.setSinkId) return 'this browser cannot choose a device';
    await context.setSinkId({ type: 'none' });
    navigator.mediaDevices?.dispatchEvent(new Event('devicechange'));
    return context.sinkId.type;
  });
  t.diagnostic(`sink ${sinks}`);
  await stroked(400);
  await page.evaluate(async () => { await window.asperity.state.context.setSinkId?.('').catch(() => {}); navigator.mediaDevices?.dispatchEvent(new Event('devicechange')); });
  await stroked(500);
  await page.mouse.up();
  // The system takes the device away; the next touch asks for it again.
  await page.evaluate(() => window.asperity.state.context.suspend());
  await drag(page, line(150, 12));
  await page.waitForFunction(() => window.asperity.state.context.state === 'running', null, { timeout: 10000 });
  await page.waitForTimeout(400);
  const { stats: after } = await stats(page);
  assert.deepEqual([after.contacts, after.refused, after.quarantined], [0, 0, 0]);
  assert.deepEqual(wrong, []);
  await context.close();
});

test('everything is reached and done by the keyboard alone', async () => {
  const { context, page, wrong } = await open(chromium, server.url);
  await ready(page);
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'mute');
  const reached = new Set();
  await page.evaluate(() => { document.getElementById('more').open = true; });
  for (let i = 0; i < 48; i++) {
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.dataset.id || document.activeElement.tagName));
    await page.keyboard.press('Tab');
  }
  for (const id of ['mute', 'stroke', 'hit', 'SUMMARY', 'force', 'blow', 'save', 'share', 'own', 'listen', 'map', 'surface', ...SURFACES.map((s) => s.id)]) assert.ok(reached.has(id), `${id} is not reached: ${[...reached]}`);
  await page.evaluate(() => { document.getElementById('more').open = false; });
  await page.focus('#surface');
  await page.keyboard.down('ArrowRight');
  await page.waitForFunction(() => window.asperity.state.touching && window.asperity.state.speed > 0.02, null, { timeout: 20000 });
  await page.keyboard.up('ArrowRight');
  await page.keyboard.press('Space');
  await page.waitForFunction(async () => (await window.asperity.state.engine.stats()).stats.impacts > 0, null, { timeout: 10000 });
  await page.keyboard.press('6');
  await ready(page, 'granite');
  await page.keyboard.press('m');
  assert.equal(await page.getAttribute('#mute', 'aria-pressed'), 'true');
  assert.deepEqual(wrong, []);
  await context.close();
});

test('axe-core finds nothing serious, light and dark, shut and open', async (t) => {
  const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
  for (const colorScheme of ['light', 'dark']) {
    const { context, page } = await open(chromium, server.url, { colorScheme });
    await ready(page);
    await page.evaluate(axe);
    for (const isOpen of [false, true]) {
      await page.evaluate((is) => { document.getElementById('more').open = is; }, isOpen);
      const { violations } = await page.evaluate(() => window.axe.run());
      const serious = violations.filter(({ impact }) => ['serious', 'critical'].includes(impact));
      t.diagnostic(`${colorScheme}: ${violations.map(({ id, impact }) => `${id} (${impact})`).join(', ') || 'nothing'}`);
      assert.deepEqual(serious.map(({ id, nodes }) => `${id}: ${nodes.map((n) => n.html)}`), []);
    }
    await context.close();
  }
});

test('pictures of the page', async () => {
  for (const colorScheme of ['light', 'dark']) {
    for (const [width, height, id] of [[390, 844, 'bumps'], [1024, 768, 'brick'], [1920, 1080, 'granite']]) {
      const { context, page } = await sounding({ colorScheme, viewport: { width, height } }, `/#s=${id}`);
      await drag(page, line(250, 30, 40, 8));
      await page.mouse.move(200, 300);
      await page.mouse.down();
      for (const place of line(300, 12, 120, 6)) { await page.mouse.move(...place); await page.waitForTimeout(20); }
      await page.screenshot({ path: join(PICTURES, `${width}-${colorScheme}.png`) });
      await page.mouse.up();
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= width, `${wide} of ${width}`);
      await context.close();
    }
  }
});

test('a recorded hit rings and a photograph is stroked, and both are saved as the program renders them', async () => {
  const { context, page, wrong } = await sounding();
  const bring = async (name, mimeType, bytes, words) => {
    await page.setInputFiles('#file', { name, mimeType, buffer: Buffer.from(bytes) });
    await page.waitForFunction((words) => document.getElementById('status').textContent.includes(words), words, { timeout: 60000 });
  };
  const ring = Float32Array.from({ length: 48000 }, (_, i) => (i < 4800 ? 0 : 0.5 * Math.exp(-(i - 4800) / 8000) * Math.sin((i - 4800) / 9)));
  await bring('cup.wav', 'audio/wav', wav([ring], 48000), 'cup.wav rings now');
  const side = 96;
  const lit = Uint16Array.from({ length: side * side }, (_, i) => 32768 + 20000 * Math.sin((i % side) / 4) * Math.cos(Math.floor(i / side) / 5));
  await bring('wall.png', 'image/png', await png({ width: side, height: side, samples: lit }), 'found from light and shade');
  await ready(page, 'own');
  await drag(page, line(260, 30));
  await page.mouse.click(400, 300);
  await page.waitForTimeout(300);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  const files = unzip(readFileSync(await download.path()));
  const native = render(files, 'asperity-own.toml');
  assert.ok(native.audio.equals(files['asperity-own.wav']), 'audio differs');
  assert.ok(samples(native.audio).some((x) => Math.abs(x) > 1e-4), 'it is silent');
  assert.deepEqual(wrong, []);
  await context.close();
});

/** A closed box in millimetres, as programs that draw bodies write it. */
const BOX = `${[0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${(i & 1) * 160} ${((i >> 1) & 1) * 40} ${(i >> 2) * 15}`).join('\n')}
${['1 3 4 2', '5 6 8 7', '1 2 6 5', '3 7 8 4', '1 5 7 3', '2 4 8 6'].map((face) => `f ${face}`).join('\n')}\n`;

test('a bowl is solved from its mesh, turned beside, rings otherwise where it is hit elsewhere, and is saved as the program renders it', async (t) => {
  const { context, page, wrong } = await sounding();
  const began = Date.now();
  await page.click('[data-id=bowl]');
  await ready(page, 'bowl');
  t.diagnostic(`there after ${Date.now() - began} ms: ${await page.textContent('#status')}`);
  // Its highest and its lowest place that is seen, and a place beside it.
  const { high, low, beside } = await page.evaluate(() => {
    const { left, top, width, height } = document.getElementById('surface').getBoundingClientRect();
    const found = [];
    for (let x = 0; x < width; x += 6) for (let y = 0; y < height; y += 6) { const hit = window.asperity.state.solid.hit([x, y]); if (hit) found.push([hit[2], left + x, top + y]); }
    found.sort((a, b) => a[0] - b[0]);
    return { high: found.at(-1).slice(1), low: found[0].slice(1), beside: [left + 40, top + 40] };
  });
  await page.click('#hit');
  for (const place of [high, low, high]) { await page.mouse.click(...place); await page.waitForTimeout(250); }
  const turned = () => page.evaluate(() => [...window.asperity.state.solid.turned]);
  const before = [await turned(), (await stats(page)).stats.events];
  await drag(page, Array.from({ length: 10 }, (_, i) => [beside[0] + 6 * i, beside[1] + 4 * i]));
  assert.notDeepEqual(await turned(), before[0]);
  assert.equal((await stats(page)).stats.events, before[1], 'beside the bowl nothing is touched');
  await page.click('#stroke');
  await drag(page, Array.from({ length: 20 }, (_, i) => [low[0] - 40 + 4 * i, low[1] - 60]));
  await page.waitForTimeout(300);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  const files = unzip(readFileSync(await download.path()));
  const native = render(files, 'asperity-bowl.toml');
  assert.ok(native.audio.equals(files['asperity-bowl.wav']) && native.haptic.equals(files['asperity-bowl.haptic.wav']), 'what is saved differs');
  const lines = new TextDecoder().decode(files['asperity-bowl.jsonl']).split('\n').filter(Boolean).map((line) => JSON.parse(line));
  assert.ok(lines.some(({ event, at_m }) => event === 'move' && at_m), 'a finger is on the body');
  const blows = lines.filter(({ event }) => event === 'impact');
  assert.equal(blows.length, 3);
  assert.deepEqual(blows[0].at_m, blows[2].at_m);
  assert.ok(blows[0].at_m[2] > 0.05 && blows[1].at_m[2] < 0.02, JSON.stringify(blows));
  // Each blow by itself: how its energy lies in the modes.
  const { modes } = JSON.parse(new TextDecoder().decode(files['asperity-bowl.modes.json']));
  const shares = blows.slice(0, 2).map((blow) => {
    const audio = samples(render({ ...files, 'asperity-bowl.jsonl': text([{ ...blow, t: 0.05 }]) }, 'asperity-bowl.toml').audio).subarray(2600, 16000);
    const levels = modes.map(({ frequency_hz }) => {
      const turn = (2 * Math.PI * frequency_hz) / 48000;
      const [re, im] = [Math.cos, Math.sin].map((wave) => audio.reduce((sum, x, i) => sum + x * wave(turn * i), 0));
      return Math.hypot(re, im);
    });
    const all = Math.hypot(...levels);
    return levels.map((level) => level / all);
  });
  const alike = shares[0].reduce((sum, x, i) => sum + x * shares[1][i], 0);
  t.diagnostic(`rim and bottom are alike by ${alike.toFixed(2)}`);
  assert.ok(alike < 0.8, `${JSON.stringify(shares)}`);
  // A body of one's own, in other units.
  await page.setInputFiles('#file', { name: 'bar.obj', mimeType: '', buffer: Buffer.from(BOX) });
  await page.waitForFunction(() => /bar\.obj is solved.*taken as 0\.15 m/.test(document.getElementById('status').textContent), null, { timeout: 60000 });
  await page.mouse.click(512, 250);
  await page.waitForTimeout(200);
  const { stats: after } = await stats(page);
  assert.deepEqual([after.impacts, after.refused], [1, 0]);
  assert.deepEqual(wrong, []);
  await context.close();
});

test('a link brings the strokes of whoever sent it', async () => {
  const { context, page, wrong } = await sounding();
  await drag(page, line(250, 20));
  await page.mouse.click(400, 300);
  await page.waitForTimeout(300);
  await page.evaluate(() => document.getElementById('share').click());
  await page.waitForFunction(() => location.hash.includes('stroke='), null, { timeout: 10000 });
  const link = await page.evaluate(() => location.href);
  assert.ok(link.length < 8000, `${link.length} letters`);
  await context.close();
  const other = await open(chromium, link);
  await ready(other.page);
  assert.match(await other.page.textContent('#status'), /stroke came with this link/);
  await other.page.click('#surface');
  await other.page.waitForFunction(() => window.asperity.state.touching && window.asperity.state.speed > 0.02, null, { timeout: 20000 });
  await other.page.waitForFunction(async () => {
    const { stats } = await window.asperity.state.engine.stats();
    return stats.impacts > 0 && stats.contacts === 0 && stats.events > 15;
  }, null, { timeout: 30000, polling: 300 });
  assert.equal((await stats(other.page)).stats.refused, 0);
  assert.deepEqual([wrong, other.wrong], [[], []]);
  await other.context.close();
});

test('hostile links and files are answered in words, and the engine goes on', async () => {
  const { context, page, wrong } = await open(chromium, `${server.url}/#s=%3Cscript%3E&force=1e99&x=%00&tool=axe`);
  await ready(page);
  assert.match(await page.textContent('#status'), /unknown/);
  await drag(page, line(250, 6));
  await page.waitForFunction(() => window.asperity.state.engine && window.asperity.state.frames > 3, null, { timeout: 30000 });
  const changed = await open(chromium, `${server.url}/#stroke=%00AAAA`);
  await ready(changed.page);
  await changed.page.click('#surface');
  await changed.page.waitForFunction(() => /the stroke in the link is none/.test(document.getElementById('status').textContent), null, { timeout: 30000 });
  await changed.context.close();
  const drop = async (name, type, bytes) => {
    await page.setInputFiles('#file', { name, mimeType: type, buffer: Buffer.from(bytes) });
    await page.waitForFunction(() => !/^(|.* is looked at …)$/.test(document.getElementById('status').textContent), null, { timeout: 60000 });
    const words = await page.textContent('#status');
    await page.evaluate(() => { document.getElementById('status').textContent = ''; });
    return words;
  };
  const random = seeded(5);
  const noise = Uint8Array.from({ length: 5000 }, () => 256 * random());
  assert.match(await drop('noise.png', 'image/png', noise), /no picture/);
  assert.match(await drop('half.png', 'image/png', (await png({ width: 9, height: 9, samples: new Uint16Array(81) })).subarray(0, 60)), /no picture/);
  assert.match(await drop('hit.wav', 'audio/wav', noise), /no recording/);
  assert.match(await drop('silence.wav', 'audio/wav', wav([new Float32Array(48000)], 48000)), /silence\.wav: ./);
  assert.match(await drop('short.wav', 'audio/wav', wav([Float32Array.of(0, 1, 0)], 48000)), /short\.wav: ./);
  assert.match(await drop('x.modes.json', 'application/json', '{"format":"other"}'), /modes/);
  assert.match(await drop('y.modes.json', 'application/json', '['.repeat(100000)), /modes/);
  assert.match(await drop('bomb.svg', 'image/svg+xml', '<svg xmlns="http://www.w3.org/2000/svg"/>'), /./);
  assert.match(await drop('noise.stl', '', noise), /noise\.stl: ./);
  assert.match(await drop('noise.obj', '', noise), /noise\.obj: ./);
  assert.match(await drop('open.obj', '', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n'), /open\.obj: ./);
  assert.match(await drop('odd.modes.json', '', '{"format":"asperity.modes","version":2,"shapes":{"points_m":[[0]],"triangles":[[7,8,9]]}}'), /modes/);
  const good = await png({ width: 64, height: 64, samples: Uint16Array.from({ length: 4096 }, (_, i) => (i % 9) * 7000) });
  await page.evaluate(() => { document.getElementById('map').checked = true; });
  assert.match(await drop('mine.png', 'image/png', good), /bright is high/);
  await ready(page, 'own');
  await drag(page, line(250, 20));
  const { stats: after } = await stats(page);
  assert.ok(after.events > 5 && after.refused === 0);
  assert.deepEqual(wrong, []);
  await context.close();
});
