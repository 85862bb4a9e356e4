// Minutes of random play in a real browser; it needs no program to compare with, and little of the processor, so other tests run beside it.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { SURFACES } from '../page/surfaces.js';
import { browser, drag, heard, host, ready, stats } from './host.mjs';
import { DIST, seeded } from './native.mjs';

test('minutes of random play leave the memory flat, nothing stuck, no error', async (t) => {
  const [server, chromium] = [await host(join(DIST, 'page')), await browser()];
  t.after(async () => { await chromium.close(); server.close(); });
  const { page, wrong } = await heard(chromium, server.url);
  const random = seeded(9);
  const minutes = Number(process.env.ASPERITY_WEB_PLAY_MINUTES ?? 3);
  const until = Date.now() + minutes * 60000;
  const ids = SURFACES.map(({ id }) => id);
  const memory = () => page.evaluate(async () => { globalThis.gc?.(); const s = await window.asperity.state.engine.stats(); return [performance.memory.usedJSHeapSize, s.memory]; });
  const sizes = [];
  for (let round = 0; Date.now() < until; round++) {
    const at = () => [40 + 900 * random(), 80 + 350 * random()];
    if (round % 12 === 11) await page.click(`[data-id=${ids[Math.floor(random() * ids.length)]}]`);
    else if (round % 12 === 5) await page.keyboard.press('Space');
    else await drag(page, Array.from({ length: 12 }, at), 8);
    if (round % 40 === 39) sizes.push((await memory())[0]);
  }
  await page.click('[data-id=sawtooth]');
  await ready(page, 'sawtooth');
  await page.waitForTimeout(1000);
  const [heap, engine] = await memory();
  t.diagnostic(`page ${sizes.map((bytes) => (bytes / 1e6).toFixed(0)).join(' ')} → ${(heap / 1e6).toFixed(0)} MB, engine ${(engine / 1e6).toFixed(1)} MB`);
  assert.ok(heap < 150e6 && engine < 30e6);
  const after = await stats(page);
  assert.deepEqual([after.stats.contacts, after.stats.refused], [0, 0]);
  assert.equal(await page.evaluate(() => window.asperity.hand.fingers.size), 0);
  assert.deepEqual(wrong, []);
});
