// The first touch of a page that nobody has seen before; nothing else runs beside it.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { browser, drag, host, line, open, ready } from './host.mjs';
import { DIST } from './native.mjs';

test('sound begins within a second of the first touch and 620 kB, with no error and no request to anybody else', async (t) => {
  const [server, chromium] = [await host(join(DIST, 'page')), await browser()];
  t.after(async () => { await chromium.close(); server.close(); });
  const { page, wrong } = await open(chromium, server.url);
  await ready(page);
  await page.evaluate(() => {
    const { state } = window.asperity;
    window.first = new Promise((resolve) => {
      document.getElementById('surface').addEventListener('pointerdown', () => { window.began = performance.now(); }, { once: true, capture: true });
      const look = () => {
        const heard = state.analyser && (() => { const x = new Float32Array(1024); state.analyser.getFloatTimeDomainData(x); return x.some((s) => Math.abs(s) > 1e-5); })();
        if (heard) resolve(performance.now() - window.began);
        else setTimeout(look, 4);
      };
      look();
    });
  });
  await drag(page, line(250, 60));
  const took = await page.evaluate(() => window.first);
  const sent = server.sent.reduce((bytes, { bytes: more }) => bytes + more, 0);
  t.diagnostic(`${took.toFixed(0)} ms, ${sent} bytes: ${server.sent.map(({ path }) => path).join(' ')}`);
  assert.ok(took < 1000, `${took} ms`);
  assert.ok(sent > 400_000 && sent <= 620_000, `${sent} bytes`);
  assert.deepEqual(wrong, []);
});
