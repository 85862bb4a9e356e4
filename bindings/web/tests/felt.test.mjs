// What a pad and a phone are told by the page in Chromium: stand-ins note each call.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, drag, host, line, open, ready } from './host.mjs';
import { DIST } from './native.mjs';

let [server, chromium] = [];
before(async () => { [server, chromium] = [await host(join(DIST, 'page')), await browser()]; });
after(async () => { await chromium?.close(); server?.close(); });

/** One gesture on a page whose pad has these functions; the calls. */
async function felt(functions, options = {}) {
  const { context, page, wrong } = await open(chromium, 'about:blank', options);
  await page.addInitScript((functions) => {
    const calls = window.calls = { playPCM: [], playEffect: [], vibrate: [] };
    const answer = { plays: async () => 'complete', lacks: async () => 'not-supported', refuses: async () => { throw new DOMException('no', 'NotSupportedError'); } };
    const actuator = {};
    if (functions.playPCM) {
      actuator.playPCM = (buffer) => {
        calls.playPCM.push({ t: performance.now(), rate: buffer.sampleRate, channels: buffer.numberOfChannels, samples: [...buffer.getChannelData(0)] });
        return answer[functions.playPCM]();
      };
    }
    if (functions.playEffect) {
      actuator.playEffect = (kind, effect) => { calls.playEffect.push({ kind, ...effect }); return answer[functions.playEffect](); };
    }
    const pad = functions.pad === false ? [] : [{ id: 'stand-in', vibrationActuator: functions.playPCM || functions.playEffect ? actuator : undefined }];
    navigator.getGamepads = () => [null, ...pad];
    navigator.vibrate = (ms) => { calls.vibrate.push(ms); return true; };
  }, functions);
  await page.goto(server.url);
  await ready(page, undefined);
  // Rough ground for a second and more, then nothing.
  await drag(page, line(250, 90, 100, 8));
  await page.waitForFunction(() => window.asperity.state.engine, null, { timeout: 30000 });
  await drag(page, line(260, 90, 100, 8));
  await page.waitForTimeout(800);
  const calls = await page.evaluate(() => window.calls);
  const count = Object.values(calls).flat().length;
  await page.waitForTimeout(300);
  assert.equal(await page.evaluate(() => Object.values(window.calls).flat().length), count, 'calls without a touch');
  const told = await page.evaluate(() => document.getElementById('feel').textContent);
  assert.deepEqual(wrong, []);
  await context.close();
  return { calls, told };
}

test('a pad that plays PCM gets the waveform without a seam, and nothing else does', async (t) => {
  const { calls: { playPCM, playEffect, vibrate }, told } = await felt({ playPCM: 'plays', playEffect: 'plays' });
  assert.ok(playPCM.length > 20 && playEffect.length === 0 && vibrate.length === 0, `${playPCM.length} buffers`);
  assert.ok(told.includes('stand-in: the waveform itself'));
  assert.ok(playPCM.some(({ samples }) => samples.some((x) => Math.abs(x) > 0.01)));
  assert.ok(playPCM.every(({ channels, samples }) => channels === 1 && samples.every((x) => Math.abs(x) <= 1)));
  // Where the one before has got to by the clock, the next one begins: with the same samples.
  let [joined, apart] = [0, 0];
  playPCM.slice(1).forEach((next, index) => {
    const [before, { rate }] = [playPCM[index], next];
    const at = Math.round((next.t - before.t) / 1000 * rate);
    if (at + 200 > before.samples.length || !next.samples.slice(0, 200).some((x) => x !== 0)) return;
    const same = Array.from({ length: 129 }, (_, k) => at + k - 64).some((from) => next.samples.slice(0, 200).every((x, i) => x === before.samples[from + i]));
    if (same) joined++; else apart++;
  });
  t.diagnostic(`${joined} buffers go on where the one before had got to, within 64 samples; ${apart} do not`);
  assert.ok(joined > 10 && apart <= joined / 10);
});

test('a pad whose playPCM is refused or lacking turns its motors', async () => {
  for (const playPCM of ['refuses', 'lacks', undefined]) {
    const { calls } = await felt({ playPCM, playEffect: 'plays' });
    assert.ok(calls.playPCM.length <= (playPCM ? 2 : 0) && calls.playEffect.length > 20 && calls.vibrate.length === 0, `${playPCM}`);
    assert.ok(calls.playEffect.every(({ kind, duration, strongMagnitude, weakMagnitude }) => kind === 'dual-rumble' && duration > 0 && [strongMagnitude, weakMagnitude].every((x) => x >= 0 && x <= 1)));
    assert.ok(calls.playEffect.some(({ strongMagnitude, weakMagnitude }) => strongMagnitude + weakMagnitude > 0.05));
  }
});

test('a phone vibrates where no pad is felt, and a desktop does not', async () => {
  for (const pad of [false, true]) {
    const phone = await felt({ pad }, { hasTouch: true, isMobile: true });
    const times = phone.calls.vibrate;
    assert.ok(times.filter((ms) => ms > 0).length > 10 && times.every((ms) => ms >= 0 && ms <= 80), `${times}`);
  }
  const desktop = await felt({ pad: true });
  assert.equal(desktop.calls.vibrate.length, 0);
});
