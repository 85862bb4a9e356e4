// The page of `asperity study` in a real browser, with simulated listeners.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { tmpdir } from 'node:os';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { browser } from './host.mjs';

const require = createRequire(`${process.env.WORK}/node_modules/`);
const PICTURES = join(process.env.WORK, 'pictures');
mkdirSync(PICTURES, { recursive: true });
const folder = mkdtempSync(join(tmpdir(), 'asperity-study-'));
const asperity = (...words) => execFileSync(process.env.ASPERITY_PROGRAM, words, { cwd: folder, encoding: 'utf8' });
let chromium;
before(async () => { chromium = await browser(); });
after(async () => { await chromium?.close(); });

/** A short tone of 16 bits. */
function tone(name, amplitude) {
  const [rate, count] = [8000, 800];
  const bytes = Buffer.alloc(44 + 2 * count);
  bytes.write('RIFF', 0); bytes.writeUInt32LE(36 + 2 * count, 4); bytes.write('WAVEfmt ', 8); bytes.writeUInt32LE(16, 16);
  bytes.writeUInt16LE(1, 20); bytes.writeUInt16LE(1, 22); bytes.writeUInt32LE(rate, 24); bytes.writeUInt32LE(2 * rate, 28);
  bytes.writeUInt16LE(2, 32); bytes.writeUInt16LE(16, 34); bytes.write('data', 36); bytes.writeUInt32LE(2 * count, 40);
  for (let n = 0; n < count; n++) bytes.writeInt16LE(Math.round(32767 * amplitude * Math.sin(0.3 * n)), 44 + 2 * n);
  writeFileSync(join(folder, name), bytes);
}
function study(name, head, stimuli) {
  const tables = stimuli.map((one) => `\n[[stimulus]]\n${Object.entries(one).map(([key, value]) => `${key} = ${JSON.stringify(value)}`).join('\n')}\n`);
  writeFileSync(join(folder, `${name}.toml`), head + tables.join(''));
  asperity('study', `${name}.toml`, '-o', name);
  return pathToFileURL(join(folder, name, 'index.html')).href;
}
/** Plays end at once, and the page notes what was played. */
function stub() {
  window.played = [];
  HTMLMediaElement.prototype.play = function play() {
    window.played.push(new URL(this.src).pathname.split('/').at(-1));
    setTimeout(() => this.dispatchEvent(new Event('ended')));
    return Promise.resolve();
  };
}
async function open(url, context) {
  const own = context ?? (await chromium.newContext({ acceptDownloads: true }));
  const page = await own.newPage();
  const wrong = [];
  page.on('pageerror', (error) => wrong.push(error.message));
  page.on('request', (request) => { if (!/^(file:|http:\/\/127\.0\.0\.1|data:|blob:)/.test(request.url())) wrong.push(`asks ${request.url()}`); });
  await page.addInitScript(stub);
  await page.goto(url);
  await page.waitForSelector('h1');
  return { context: own, page, wrong };
}
/** A listener who runs in the page: `answer(shown)` gets the stimuli that were played since the last answer, and names a button. */
async function listen(page, answer, most = 1e9) {
  await page.evaluate(async ({ source, most }) => {
    const answer = eval(source);
    const data = JSON.parse(document.getElementById('study').textContent);
    const buttons = () => [...document.querySelectorAll('#screen button')];
    const press = (text) => buttons().find((one) => one.textContent.replace(one.querySelector('kbd')?.textContent ?? '', '') === text).click();
    const pause = () => new Promise((resolve) => setTimeout(resolve));
    const until = async (test) => { while (!test()) await pause(); };
    const title = () => document.querySelector('h1').textContent;
    let trials = 0;
    while (title() !== 'Thank you' && trials < most) {
      if (!/^Trial/.test(title())) {
        const next = buttons().find((one) => /^(I agree|Continue|Start)/.test(one.textContent));
        const before = title();
        next.click();
        await until(() => title() !== before || !document.body.contains(next));
        continue;
      }
      const [before, check] = [document.querySelector('#screen').firstChild, /answer “(.*)”/.exec(document.querySelector('#screen').textContent)];
      if (check) press(check[1]);
      else {
        window.played.length = 0;
        for (const one of buttons().filter((one) => /Play|Reference/.test(one.textContent))) {
          const count = window.played.length;
          one.click();
          await until(() => window.played.length > count);
          await pause(); await pause();
        }
        const shown = window.played.map((file) => data.stimuli[Number(file.slice(0, 3))]);
        await until(() => !buttons().at(-1).disabled);
        press(answer(shown));
      }
      trials++;
      await until(() => document.querySelector('#screen').firstChild !== before);
    }
  }, { source: `(${answer})`, most });
}
const kept = (page) => page.evaluate(() => Object.values(localStorage).map((text) => JSON.parse(text)));
const COLUMNS = 'participant,trial,protocol,stimulus,shown,answer,correct,response_ms,time';
const csv = (runs) => `${COLUMNS}\n${runs.flatMap((run) => run.rows).map((row) => COLUMNS.split(',').map((name) => row[name] ?? '').join(',')).join('\n')}\n`;
function analysed(name, runs) {
  writeFileSync(join(folder, name), csv(runs));
  return JSON.parse(asperity('study', 'analyse', name, '--json'));
}

test('twenty listeners with planted thresholds are found within ten percent, each within its interval nineteen times of twenty', async () => {
  const levels = Array.from({ length: 21 }, (_, i) => Number((10 ** (0.05 * i)).toPrecision(4)));
  levels.forEach((level, i) => tone(`level${i}.wav`, 0.08 * level));
  tone('level-none.wav', 0.08);
  const url = study('stairs', 'title = "Stairs"\nprotocol = "staircase"\ntrials = 80\nreversals = 16\nseed = 4\nattention = 2\ntraining = false\n', [
    { name: 'standard', wav: 'level-none.wav', role: 'reference' },
    ...levels.map((level, i) => ({ name: `l${i}`, wav: `level${i}.wav`, level })),
  ]);
  let [within, ratio] = [0, 0];
  for (let n = 0; n < 20; n++) {
    const planted = 2 * 2 ** (n / 19);
    const { context, page, wrong } = await open(`${url}?participant=p${n}`);
    await listen(page, `(shown) => {
      const target = shown.findIndex((one) => one.level !== undefined);
      const p = 0.5 + 0.49 / (1 + Math.exp(-6 * Math.log(shown[target].level / ${planted})));
      return (Math.random() < p) === (target === 1) ? 'second' : 'first';
    }`);
    const runs = await kept(page);
    const report = analysed(`stairs-${n}.csv`, runs);
    assert.equal(report.attention.asked, 2);
    const [low, high] = report.threshold.ci95;
    within += (low ?? 0) <= planted && planted <= (high ?? Infinity);
    ratio += Math.log(report.threshold.value / planted) / 20;
    assert.deepEqual(wrong, []);
    await context.close();
  }
  console.log(`thresholds: mean ratio ${Math.exp(ratio).toFixed(3)}, ${within} of 20 within their intervals`);
  assert.ok(Math.abs(ratio) < 0.1 && within >= 16);
});

test('a planted confusion comes back as the matrix, every stimulus asked equally often', async () => {
  for (const name of ['a', 'b', 'c']) tone(`${name}.wav`, 0.5);
  const url = study('names', 'title = "Names"\nprotocol = "identification"\ntrials = 40\nseed = 2\n', ['a', 'b', 'c'].map((name) => ({ name, wav: `${name}.wav` })));
  const { page, context } = await open(url);
  await listen(page, "([one]) => (one.name === 'b' && Math.random() < 0.4 ? 'c' : one.name)");
  const report = analysed('names.csv', await kept(page));
  const { counts } = report.confusion;
  assert.deepEqual(counts.map((row) => row.reduce((a, b) => a + b)), [40, 40, 40]);
  assert.deepEqual([counts[0][0], counts[2][2]], [40, 40]);
  assert.ok(counts[1][2] > 7 && counts[1][2] < 26, JSON.stringify(counts));
  await context.close();
});

test('X is each of the two equally often, and ratings are kept for every slider', async () => {
  const abx = study('abx', 'title = "ABX"\nprotocol = "abx"\ntrials = 8\nseed = 2\ntraining = false\n', ['a', 'b', 'c'].map((name) => ({ name, wav: `${name}.wav` })));
  const one = await open(abx);
  await listen(one.page, "([a, b, x]) => (a.name === x.name ? 'A' : 'B')");
  const rows = (await kept(one.page))[0].rows;
  assert.equal(rows.length, 24);
  assert.ok(rows.every((row) => row.correct === 1));
  for (const pair of ['a | b', 'a | c', 'b | c']) assert.equal(rows.filter((row) => row.stimulus === pair && row.shown === pair[0]).length, 4);
  await one.context.close();
  const rating = study('rating', 'title = "Rating"\nprotocol = "rating"\ntrials = 1\nseed = 2\ntraining = false\nscales = ["realism", "correspondence"]\n', [
    { name: 'full', wav: 'a.wav', role: 'reference' }, { name: 'made', wav: 'b.wav' },
  ]);
  const two = await open(rating);
  await listen(two.page, "() => 'Next'");
  const rated = (await kept(two.page))[0].rows;
  // The hidden reference, the made one and the anchor, on two scales each.
  assert.deepEqual(rated.map((row) => `${row.stimulus} ${row.shown}`).sort(), ['anchor correspondence', 'anchor realism', 'full correspondence', 'full realism', 'made correspondence', 'made realism']);
  await two.context.close();
});

test('six plates by keyboard alone, without a serious finding of axe on any screen', async () => {
  asperity('study', '--example', 'six-plates', '-o', 'plates');
  asperity('study', 'plates/study.toml', '-o', 'plates/page');
  const { page, context, wrong } = await open(pathToFileURL(join(folder, 'plates/page/index.html')).href);
  const axe = readFileSync(require.resolve('axe-core'), 'utf8');
  const look = async (name) => {
    await page.screenshot({ path: join(PICTURES, `study-${name}.png`), fullPage: true });
    await page.evaluate(axe);
    const { violations } = await page.evaluate(() => window.axe.run(document));
    const serious = violations.filter((one) => ['serious', 'critical'].includes(one.impact));
    assert.deepEqual(serious.map((one) => `${name}: ${one.id} ${one.nodes[0].html}`), []);
  };
  const title = () => page.textContent('h1');
  await look('consent');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelector('h1').textContent === 'Levels');
  await look('levels');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelector('h1').textContent === 'Training');
  await look('training');
  await page.keyboard.press('Enter');
  let looked = false;
  for (let n = 1; n <= 20; n++) {
    await page.waitForFunction((n) => document.querySelector('h1').textContent === `Trial ${n} of 20`, n);
    const check = /answer “(.*)”/.exec(await page.textContent('#screen'))?.[1];
    if (!check) {
      await page.keyboard.press('p');
      await page.waitForFunction(() => !document.querySelector('.answers button').disabled);
      if (!looked) await look('trial');
      looked = true;
    }
    const names = await page.$$eval('.answers button', (all) => all.map((one) => one.textContent.slice(1)));
    await page.keyboard.press(String(check ? names.indexOf(check) + 1 : 1));
  }
  await page.waitForFunction(() => document.querySelector('h1').textContent === 'Thank you');
  assert.equal(await title(), 'Thank you');
  await look('thanks');
  const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('Tab').then(() => page.keyboard.press('Enter'))]);
  const lines = readFileSync(await download.path(), 'utf8').trim().split('\n');
  assert.equal(lines[0], COLUMNS);
  assert.equal(lines.length, 21);
  assert.deepEqual(wrong, []);
  await context.close();
});

test('a closed tab loses no answer, and two windows do not mix', async () => {
  const url = pathToFileURL(join(folder, 'names/index.html')).href;
  const { page, context } = await open(`${url}?participant=one`);
  await listen(page, '([one]) => one.name', 5);
  await page.close();
  const again = await open(url, context);
  const [before] = await kept(again.page);
  assert.deepEqual([before.participant, before.rows.length], ['one', 5]);
  await again.page.click('text=Go on as one (5 answered)');
  const other = await open(`${url}?participant=two`, context);
  // Who answers in one window cannot be gone on with in another.
  await other.page.click('text=Go on as one');
  await other.page.waitForFunction(() => /another window/.test(document.getElementById('said').textContent));
  await listen(other.page, '([one]) => one.name', 3);
  await listen(again.page, '([one]) => one.name', 2);
  // Each in its own window: a busy machine shows one window's answers to another a moment later.
  const own = async ({ page }, participant) => (await kept(page)).find((run) => run.participant === participant).rows;
  const runs = { one: await own(again, 'one'), two: await own(other, 'two') };
  assert.deepEqual([runs.one.length, runs.two.length], [7, 3]);
  assert.deepEqual(runs.one.map((row) => row.trial), [1, 2, 3, 4, 5, 6, 7]);
  assert.ok(runs.two.every((row) => row.participant === 'two'));
  // The order goes on where it was: every stimulus once in a round of three.
  for (const round of [0, 3]) assert.equal(new Set(runs.one.slice(round, round + 3).map((row) => row.stimulus)).size, 3);
  await context.close();
});

test('every study of the sources starts and asks its first question', async () => {
  const studies = { 'six-plates': ['study'], 'seven-materials': ['study', 'ratings'], metamers: ['study'], heights: ['study'], dimension: ['study'] };
  for (const [name, files] of Object.entries(studies)) {
    asperity('study', '--example', name, '-o', name);
    for (const file of files) {
      asperity('study', `${name}/${file}.toml`, '-o', `${name}/${file}-page`);
      const { page, context, wrong } = await open(pathToFileURL(join(folder, name, `${file}-page/index.html`)).href);
      for (const word of ['I agree', 'Continue', 'Start']) await page.click(`button:has-text("${word}")`);
      await page.waitForFunction(() => /^Trial 1 of/.test(document.querySelector('h1').textContent));
      await page.waitForTimeout(200);
      const pictures = await page.$$eval('#screen img', (all) => all.map((one) => one.naturalWidth));
      assert.ok(pictures.every((width) => width > 0) && (file !== 'ratings' || pictures.length === 1), `${name} ${file}: ${pictures}`);
      await page.screenshot({ path: join(PICTURES, `study-${name}-${file}.png`), fullPage: true });
      assert.deepEqual(wrong, []);
      await context.close();
    }
  }
});

test('five names for six things come back as a matrix of five columns', async () => {
  const six = ['a', 'b', 'c', 'd', 'e', 'f'];
  for (const name of six) tone(`${name}.wav`, 0.5);
  const url = study('five', 'title = "Five"\nprotocol = "identification"\ntrials = 2\nseed = 2\ntraining = false\nlabels = ["a", "b", "c", "d", "e"]\n', six.map((name) => ({ name, wav: `${name}.wav`, label: name === 'f' ? 'e' : name })));
  const { page, context } = await open(url);
  await listen(page, "([one]) => (one.name === 'f' ? 'e' : one.name)");
  const report = analysed('five.csv', await kept(page));
  assert.equal(report.share_correct.value, 1);
  assert.deepEqual([report.confusion.labels, report.confusion.answers], [six, six.slice(0, 5)]);
  assert.deepEqual(report.confusion.counts, six.map((_, row) => [0, 1, 2, 3, 4].map((column) => (Math.min(row, 4) === column ? 2 : 0))));
  await context.close();
});

test('touch goes to the output that was chosen, sound to the usual one', async () => {
  const url = study('touch', 'title = "Touch"\nprotocol = "identification"\ntrials = 1\nseed = 2\nsenses = "both"\ntraining = false\n', ['a', 'b'].map((name) => ({ name, wav: `${name}.wav`, haptic_wav: `${name}.wav` })));
  const { page, context } = await open(url);
  await page.evaluate(() => {
    window.sinks = [];
    const outputs = ['speaker', 'actuator'].map((deviceId) => ({ kind: 'audiooutput', deviceId, label: deviceId }));
    Object.assign(navigator.mediaDevices, { getUserMedia: async () => new MediaStream(), enumerateDevices: async () => outputs });
    HTMLMediaElement.prototype.setSinkId = async function sink(id) { window.sinks.push([new URL(this.src).pathname.split('.').at(-2), id]); };
  });
  await page.click('button:has-text("I agree")');
  await page.click('button:has-text("Find outputs")');
  await page.waitForFunction(() => document.querySelectorAll('#output option').length === 2);
  await page.selectOption('#output', 'actuator');
  await page.screenshot({ path: join(PICTURES, 'study-outputs.png') });
  await page.click('button:has-text("Play")');
  await page.waitForFunction(() => window.played.length === 2);
  assert.deepEqual(await page.evaluate(() => window.sinks), [['touch', 'actuator']]);
  assert.deepEqual((await page.evaluate(() => window.played)).map((file) => file.split('.')[1]).sort(), ['sound', 'touch']);
  await context.close();
});

test('served, every answer lies on the disc before the next is asked', async () => {
  const program = spawn(process.env.ASPERITY_PROGRAM, ['study', 'names.toml', '--serve', '-o', 'served'], { cwd: folder });
  const address = await new Promise((resolve) => program.stdout.on('data', (data) => { const found = /serving (\S+)/.exec(data); if (found) resolve(found[1]); }));
  const { page, context, wrong } = await open(`${address}?participant=three`);
  await listen(page, '([one]) => one.name', 4);
  const [name] = readdirSync(join(folder, 'served/answers'));
  assert.equal(name, 'three.csv');
  assert.equal(readFileSync(join(folder, 'served/answers', name), 'utf8').trim().split('\n').length, 5);
  assert.deepEqual(wrong, []);
  await context.close();
  program.kill();
});
