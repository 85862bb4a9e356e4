// What a stranger does first: the README's blocks, the package, the program's verb.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { Agent, get } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { DIST, PROGRAM, samples } from './native.mjs';

const README = readFileSync(new URL('../README.md', import.meta.url), 'utf8');
const fresh = () => mkdtempSync(join(tmpdir(), 'asperity-web-'));

test('the first program of the README runs with the package installed, and makes a sound', () => {
  const folder = fresh();
  execFileSync('npm', ['install', '--no-save', '--no-audit', '--no-fund', '--silent', '--install-links', join(DIST, 'package')], { cwd: folder });
  const program = README.match(/```js\n([^]*?)```/)[1];
  assert.equal(program, readFileSync(new URL('../example/stroke.mjs', import.meta.url), 'utf8'));
  writeFileSync(join(folder, 'stroke.mjs'), program);
  assert.match(execFileSync('node', ['stroke.mjs'], { cwd: folder, encoding: 'utf8' }), /wrote stroke.wav/);
  const peak = samples(readFileSync(join(folder, 'stroke.wav'))).reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  assert.ok(peak > 0.01 && peak <= 1, `${peak}`);
});

test('the package holds what it says and nothing else', () => {
  const [{ files }] = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json'], { cwd: join(DIST, 'package'), encoding: 'utf8' }));
  assert.deepEqual(files.map(({ path }) => path).sort(), ['LICENSE-APACHE', 'LICENSE-MIT', 'README.md', 'actuators.js', 'asperity.d.ts', 'asperity.js', 'asperity.wasm', 'engine.js', 'package.json', 'worklet.js']);
});

test('the worklet of the package needs no file beside it', () => {
  const worklet = readFileSync(join(DIST, 'package/worklet.js'), 'utf8');
  assert.match(worklet, /^class Engine /m);
  assert.doesNotMatch(worklet, /^(import|export) /m);
});

test('the types say what the modules export', async () => {
  const folder = fresh();
  mkdirSync(join(folder, 'node_modules'));
  cpSync(join(DIST, 'package'), join(folder, 'node_modules/asperity'), { recursive: true });
  writeFileSync(join(folder, 'use.ts'), `
    import { createEngine, prepare, renderLog, Engine, type Event, type Prepared } from 'asperity';
    const stroke: Event[] = [{ t: 0, event: 'begin', contact: 1, surface: 'a', uv: [0, 0], normal_force_n: 1 }, { t: 1, event: 'end', contact: 1 }];
    export async function play(context: AudioContext, module: WebAssembly.Module): Promise<string> {
      const prepared: Prepared = prepare(module, { scene: '', rate: context.sampleRate });
      const engine = await createEngine(context, { prepared });
      engine.connect(context.destination);
      engine.begin(1, 'a', { uv: [0, 0] });
      engine.impact('b', { striker: 'steel' });
      const { audio }: { audio: Uint8Array } = renderLog(module, { scene: '', log: stroke });
      return (await engine.log()) + audio.length + new Engine(module).position;
    }
    // @ts-expect-error: no such event
    const wrong: Event = { event: 'dance', contact: 1 };
    void wrong;`);
  const tsc = join(process.env.WORK, 'node_modules/typescript/bin/tsc');
  execFileSync('node', [tsc, '--noEmit', '--strict', '--target', 'es2022', '--module', 'nodenext', '--moduleResolution', 'nodenext', '--lib', 'es2022,dom', 'use.ts'], { cwd: folder, stdio: 'pipe' });
  const exported = Object.keys(await import('../js/engine.js'));
  const types = readFileSync(join(DIST, 'package/asperity.d.ts'), 'utf8');
  for (const name of ['Engine', 'prepare', 'renderLog', 'parseLog', 'wav']) assert.ok(exported.includes(name) && new RegExp(`export (class|function) ${name}\\b`).test(types), name);
});

test('the program writes the page and serves it on the loopback address, or says how it would', async (t) => {
  const folder = fresh();
  const written = spawnSync(PROGRAM, ['web', '-o', join(folder, 'page')], { encoding: 'utf8' });
  if (/built without the page/.test(written.stderr)) {
    t.diagnostic('this program was built without the feature web');
    assert.equal(written.status, 1);
    assert.match(written.stderr, /^error: .*bindings\/web\/build.*--features web\n$/);
    return;
  }
  assert.equal(written.status, 0, written.stderr);
  assert.deepEqual(readdirSync(join(folder, 'page')).sort(), readdirSync(join(DIST, 'page')).sort());
  // A browser that only writes down where it was sent.
  const [browser, sent] = [join(folder, 'browser'), join(folder, 'sent')];
  writeFileSync(browser, `#!/bin/sh\necho "$1" >'${sent}.part' && mv '${sent}.part' '${sent}'\n`, { mode: 0o755 });
  const server = spawn(PROGRAM, ['web', '--open'], { env: { ...process.env, BROWSER: browser } });
  try {
    const said = await new Promise((resolve) => server.stdout.once('data', (bytes) => resolve(String(bytes))));
    const [url] = said.match(/http:\/\/127\.0\.0\.1:\d+\//);
    for (let tries = 0; tries < 200 && !existsSync(sent); tries++) await new Promise((resolve) => setTimeout(resolve, 50));
    assert.equal(readFileSync(sent, 'utf8'), `${url}\n`);
    const page = await fetch(url);
    assert.match(page.headers.get('content-type'), /text\/html/);
    assert.equal(await page.text(), readFileSync(join(folder, 'page/index.html'), 'utf8'));
    const wasm = await fetch(`${url}asperity.wasm?x=1`);
    assert.equal(wasm.headers.get('content-type'), 'application/wasm');
    assert.deepEqual(new Uint8Array(await wasm.arrayBuffer()), new Uint8Array(readFileSync(join(folder, 'page/asperity.wasm'))));
    for (const path of ['../Cargo.toml', '%2e%2e/x', 'nothing']) assert.equal((await fetch(url + path)).status, 404);
    assert.equal((await fetch(url, { method: 'POST', body: 'x' })).status, 405);
    // As many connections at once as browsers open, all of which would like to stay open: one in some was never answered, and the page stayed white.
    const agent = new Agent({ keepAlive: true, maxSockets: 12 });
    for (let round = 0; round < 40; round++) {
      await Promise.all(['', 'app.js', 'look.js', 'style.css', 'engine.js', 'hand.js', 'feel.js', 'strips.js', 'worker.js', 'surfaces.js', 'pictures.js', 'asperity.js', 'actuators.js'].map((path) => new Promise((resolve, reject) => {
        const request = get(url + path, { agent, timeout: 20000 }, (response) => { response.resume().on('end', () => resolve(assert.equal(response.headers.connection, 'close'))); });
        request.on('timeout', () => request.destroy(new Error(`${path} is not answered`))).on('error', reject);
      })));
    }
    agent.destroy();
  } finally {
    server.kill();
  }
  const alone = spawn(PROGRAM, ['web', '--open'], { env: { ...process.env, BROWSER: join(folder, 'none') } });
  try {
    let words = '';
    for await (const bytes of alone.stdout) { words += bytes; if (words.split('\n').length > 2) break; }
    assert.match(words, /serving http.*\n.*none cannot be started .*: open the address in a browser\n/);
  } finally {
    alone.kill();
  }
});
