// A static host on the loopback address, and a headless Chromium that looks at it.
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { extname, join, normalize } from 'node:path';
import { gzipSync } from 'node:zlib';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };
const { chromium } = createRequire(`${process.env.WORK ?? process.cwd()}/node_modules/`)('playwright-core');

/** Serves a folder; tells what was asked for, in that order, and how many bytes each took, gzipped. */
export async function host(folder) {
  const sent = [];
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://host').pathname)).replace(/\/$/, '/index.html');
    const asked = { path, bytes: 0 };
    sent.push(asked);
    try {
      const body = gzipSync(await readFile(join(folder, path)), { level: 9 });
      asked.bytes = body.length;
      // Ten minutes: what static hosts say who are told nothing, GitHub's pages among them.
      response.writeHead(200, { 'content-type': TYPES[extname(path)] ?? 'application/octet-stream', 'content-encoding': 'gzip', 'cache-control': 'max-age=600' });
      response.end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { url: `http://127.0.0.1:${server.address().port}`, sent, close: () => server.close() };
}

export function browser() {
  const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find((path) => existsSync(path));
  return chromium.launch({
    executablePath,
    args: ['--no-sandbox', '--autoplay-policy=no-user-gesture-required', '--enable-precise-memory-info', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
}

/** A page that notes every error and every request to somebody else. */
export async function open(chromium, url, options = {}) {
  const context = await chromium.newContext({ viewport: { width: 1024, height: 720 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  const wrong = [];
  page.on('console', (message) => { if (message.type() === 'error') wrong.push(message.text()); });
  page.on('pageerror', (error) => wrong.push(error.message));
  page.on('request', (request) => { if (!/^(http:\/\/127\.0\.0\.1|data:|blob:)/.test(request.url())) wrong.push(`asks ${request.url()}`); });
  await page.goto(url);
  return { context, page, wrong };
}

/** A drag of the mouse along places, `ms` from one to the next. */
export async function drag(page, places, ms = 16) {
  await page.mouse.move(...places[0]);
  await page.mouse.down();
  for (const place of places.slice(1)) {
    await page.mouse.move(...place);
    await page.waitForTimeout(ms);
  }
  await page.mouse.up();
}

/** Waits until a surface, or any, is there to be touched. */
export const ready = (page, id) => page.waitForFunction((wanted) => {
  const { ready } = document.getElementById('surfaces').dataset;
  return wanted ? ready === wanted : ready;
}, id, { timeout: 60000 });

/** Places in a row. */
export const line = (y, count = 40, from = 200, step = 10) => Array.from({ length: count }, (_, i) => [from + step * i, y]);

export const stats = (page) => page.evaluate(async () => (await window.asperity.state.engine.stats()));

/** The page, and sound that has begun. */
export async function heard(chromium, url, options) {
  const opened = await open(chromium, url, options);
  await ready(opened.page);
  await drag(opened.page, line(250, 6));
  await opened.page.waitForFunction(() => window.asperity.state.engine && window.asperity.state.frames > 3, null, { timeout: 30000 });
  return opened;
}
