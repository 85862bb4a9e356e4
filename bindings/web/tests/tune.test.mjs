// `asperity play SCENE.toml --tune`: the panel over HTTP and in headless Chromium, while the scene plays unheard.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { request as ask } from 'node:http';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, drag, open } from './host.mjs';
import { PROGRAM } from './native.mjs';

const require = createRequire(`${process.env.WORK}/node_modules/`);
const SCENE = `# A bowl under a finger.
contacts = "stroke.jsonl"
tail_s = 0.5 # short

[[body]]
name = "bowl"
stock = "bowl" # the brass one
size_m = 0.12
material = "brass"

[[surface]]
name = "granite" # speckled
body = "bowl"
solid = "granite"
width_m = 0.14   # what uv spans
height_m = 0.14
micro_relief_m = 2e-5

[[actuator]]
full_scale = 1e-4 # of displacement

[audio]
gain = 0.05 # quiet
limit = true
`;
let chromium;
before(async () => { chromium = await browser(); });
after(async () => { await chromium?.close(); });

/** A scene that plays and is tuned. */
async function tuned() {
  const folder = mkdtempSync(join(tmpdir(), 'asperity-tune-'));
  const scene = join(folder, 'bowl.toml');
  writeFileSync(scene, SCENE);
  const lines = Array.from({ length: 60 }, (_, n) => ({ t: n / 60, event: n === 0 ? 'begin' : n === 59 ? 'end' : 'move', contact: 1, ...(n === 0 ? { surface: 'granite', actuator: 0 } : {}), ...(n === 59 ? {} : { uv: [0.1 + n / 100, 0.5], normal_force_n: 0.6 }) }));
  writeFileSync(join(folder, 'stroke.jsonl'), lines.map((line) => `${JSON.stringify(line)}\n`).join(''));
  const program = spawn(PROGRAM, ['play', scene, '--tune'], { stdio: ['ignore', 'pipe', 'pipe'] });
  let [out, err] = ['', ''];
  program.stderr.on('data', (bytes) => { err += bytes; });
  const url = await new Promise((resolve, reject) => {
    program.stdout.on('data', (bytes) => { out += bytes; const [found] = /http:\/\/127\.0\.0\.1:\d+\//.exec(out) ?? []; if (found) resolve(found); });
    program.on('exit', (code) => reject(new Error(`ended with ${code}: ${out}${err}`)));
  });
  const ended = new Promise((resolve) => program.on('exit', resolve));
  const post = async (path, body) => {
    const response = await fetch(url + path, { method: 'POST', body: typeof body === 'string' ? body : JSON.stringify(body) });
    return { status: response.status, ...(await response.json()) };
  };
  const state = async () => (await fetch(`${url}state`)).json();
  const text = () => readFileSync(scene, 'utf8');
  return { url, scene, text, post, state, end: async () => { await post('end', ''); assert.equal(await ended, 0); assert.equal(err, ''); } };
}

test('a number is turned while it sounds, heard, and kept with every comment where it was', async () => {
  const { state, post, text, end } = await tuned();
  const first = await state();
  const gain = first.settings.find(({ path, key }) => path === 'audio' && key === 'gain');
  assert.deepEqual([gain.value, gain.place, gain.changes, gain.low], [[0.05], 'audio', 'sounding', 0]);
  const width = first.settings.find(({ key }) => key === 'width_m');
  assert.deepEqual([width.path, width.place, width.unit, width.changes, width.range.length > 0, width.meaning.length > 0], ['surface.0', 'surface "granite"', 'm', 'anew', true, true]);
  assert.equal(first.changed, false);
  // It plays over and over.
  const until = Date.now() + 30000;
  let now = first;
  while (now.events < 70 && Date.now() < until) { await new Promise((resolve) => setTimeout(resolve, 100)); now = await state(); }
  assert.ok(now.events >= 70 && now.position_s > first.position_s, JSON.stringify([now.events, now.position_s]));
  let answer = await post('set', { path: 'audio', key: 'gain', value: [0.2] });
  assert.deepEqual([answer.said, answer.changed], [['audio 1: gain 0.2'], true]);
  answer = await post('set', { path: 'surface.0', key: 'micro_relief_m', value: [4e-5] });
  assert.deepEqual(answer.said, ['surface "granite": changed']);
  answer = await post('set', { path: 'body.0', key: 'size_m', value: [0.2] });
  assert.deepEqual(answer.said, ['body "bowl": changed']);
  assert.equal(text(), SCENE, 'nothing is written before it is kept');
  answer = await post('keep', '');
  assert.equal(answer.changed, false);
  assert.equal(text(), SCENE.replace('gain = 0.05', 'gain = 0.2').replace('micro_relief_m = 2e-5', 'micro_relief_m = 0.00004').replace('size_m = 0.12', 'size_m = 0.2'));
  await end();
});

test('what is wrong is refused in words, the scene goes on, and a file that somebody else wrote is not written over', async () => {
  const { url, scene, state, post, text, end } = await tuned();
  for (const [body, words] of [
    [{ path: 'surface.0', key: 'width_m', value: [-1] }, /width_m.*refused/], [{ path: 'surface.7', key: 'width_m', value: [1] }, /no table/],
    [{ path: 'surface.0', key: 'colour', value: [1] }, /no number/], [{ path: 'surface.0', key: 'width_m', value: [] }, /width_m/], ['nonsense', /request/], ['', /request/],
  ]) {
    const { status, error } = await post('set', body);
    assert.deepEqual([status, words.test(error)], [400, true], `${JSON.stringify(body)}: ${error}`);
  }
  assert.equal((await post('touch', '{"t":0,"event":"dance"}')).status, 400);
  assert.equal((await post('log', 'perhaps')).status, 400);
  assert.equal((await fetch(`${url}elsewhere`)).status, 404);
  // Another page, and another name for this machine, are nobody.
  assert.equal((await fetch(`${url}keep`, { method: 'POST', headers: { origin: 'http://evil.example' } })).status, 403);
  const { port } = new URL(url);
  const renamed = await new Promise((resolve) => ask({ host: '127.0.0.1', port, path: '/state', headers: { host: 'evil.example' } }, (response) => resolve(response.statusCode)).end());
  assert.equal(renamed, 403);
  assert.equal((await state()).changed, false);
  await post('set', { path: 'audio', key: 'gain', value: [0.5] });
  writeFileSync(scene, SCENE.replace('gain = 0.05', 'gain = 0.07'));
  assert.match((await post('keep', '')).error, /meanwhile/);
  assert.match(text(), /gain = 0.07/);
  const after = await post('revert', '');
  assert.deepEqual([after.changed, after.settings.find(({ key }) => key === 'gain').value], [false, [0.07]]);
  await end();
});

test('a finger touches the scene while its log plays', async () => {
  const { state, post, end } = await tuned();
  assert.equal((await state()).plays, true);
  const refused = [];
  // Over the log's second and its beginning anew.
  for (let n = 0; n < 100; n++) {
    const rest = { contact: 1_000_000, uv: [0.2 + n / 200, 0.4], normal_force_n: 0.6 };
    const { error } = await post('touch', { t: performance.now() / 1000, event: n === 0 ? 'begin' : 'move', ...(n === 0 ? { surface: 'granite', actuator: 0 } : {}), ...rest });
    if (error !== undefined) refused.push(error);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  assert.deepEqual(refused, []);
  // Nothing was lost, and nothing is said to be.
  assert.doesNotMatch(JSON.stringify(await state()), /refused/);
  await end();
});

test('the panel turns by slider and number, touches the scene, and keeps; axe-core finds nothing serious', async () => {
  const { url, state, text, end } = await tuned();
  const { context, page, wrong } = await open(chromium, url);
  await page.waitForSelector('.setting');
  await page.click('#log');
  const field = '[data-name="audio/gain"] input[type=number]';
  assert.equal(await page.inputValue(field), '0.05');
  await page.fill(field, '0.3');
  await page.press(field, 'Tab');
  await page.waitForFunction(() => document.getElementById('said').textContent.includes('gain 0.3'), null, { timeout: 10000 });
  await page.focus('[data-name="surface.0/micro_relief_m"] input[type=range]');
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => document.getElementById('said').textContent.includes('granite'), null, { timeout: 10000 });
  const before = (await state()).events;
  const box = await (await page.$('#pad')).boundingBox();
  await drag(page, Array.from({ length: 30 }, (_, i) => [box.x + 10 + 5 * i, box.y + 80]));
  await page.focus('#pad');
  await page.keyboard.press('Space');
  for (let tries = 0; tries < 50 && (await state()).events < before + 10; tries++) await page.waitForTimeout(100);
  assert.ok((await state()).events >= before + 10);
  await page.evaluate(readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8'));
  await page.click('#missing');
  const { violations } = await page.evaluate(() => window.axe.run());
  assert.deepEqual(violations.filter(({ impact }) => ['serious', 'critical'].includes(impact)).map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html)}`), []);
  if (process.env.WORK) await page.screenshot({ path: join(process.env.WORK, 'tune.png') });
  await page.click('#keep');
  await page.waitForFunction(() => document.getElementById('keep').disabled, null, { timeout: 10000 });
  assert.match(text(), /gain = 0\.3 # quiet/);
  assert.deepEqual(wrong, []);
  await context.close();
  await end();
});
