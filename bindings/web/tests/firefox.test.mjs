// The page in headless Firefox, where Debian's is installed: it comes up without an error, and renders the bits of the program. Live sound is not heard here:
// without a sound device Firefox does not start a context that runs.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { test } from 'node:test';
import { SURFACES, sceneOf } from '../page/surfaces.js';
import { host } from './host.mjs';
import { DIST, render, samples, stroke, text } from './native.mjs';

const FIREFOX = '/usr/bin/firefox-esr';
const MODULES = `${process.env.WORK}/node_modules/`;
const lacking = !existsSync(FIREFOX) ? `no ${FIREFOX} here` : !existsSync(`${MODULES}puppeteer-core`) ? 'no puppeteer-core here' : false;

test('Firefox shows the page without an error and renders the bits of the program', { skip: lacking, timeout: 120000 }, async (t) => {
  const puppeteer = createRequire(MODULES)('puppeteer-core');
  const server = await host(join(DIST, 'page'));
  const firefox = await puppeteer.launch({ browser: 'firefox', executablePath: FIREFOX, headless: true });
  try {
    t.diagnostic(await firefox.version());
    const page = await firefox.newPage();
    const wrong = [];
    page.on('console', (message) => { if (message.type() === 'error') wrong.push(message.text()); });
    page.on('pageerror', (error) => wrong.push(error.message));
    await page.goto(server.url);
    await page.waitForFunction(() => document.getElementById('surfaces').dataset.ready, { timeout: 60000 });
    await page.click('[data-id=granite]');
    await page.waitForFunction(() => document.getElementById('surfaces').dataset.ready === 'granite', { timeout: 60000 });
    const surface = SURFACES.find(({ id }) => id === 'granite');
    const { text: scene } = sceneOf(surface, 'x');
    const log = text(stroke(surface));
    const { left, late } = await page.evaluate(async (scene, log) => {
      const { createEngine } = await import('./asperity.js');
      const offline = new OfflineAudioContext({ numberOfChannels: 2, length: 2 * 48000, sampleRate: 48000 });
      const engine = await createEngine(offline, { scene, log });
      engine.connect(offline.destination);
      const rendered = (await offline.startRendering()).getChannelData(0);
      return { left: [...rendered], late: engine.told.latency_samples };
    }, scene, log);
    const native = samples(render({ 'x.toml': scene, 'x.jsonl': log }, 'x.toml').audio);
    const count = left.length - late;
    assert.ok(count > 48000 && native.length >= count);
    assert.equal(Array.from({ length: count }, (_, i) => native[i] !== Math.fround(left[i + late])).indexOf(true), -1);
    assert.deepEqual(wrong, []);
  } finally {
    await firefox.close();
    server.close();
  }
});
