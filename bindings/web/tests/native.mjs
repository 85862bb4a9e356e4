// The program `asperity` of this machine, to compare with.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { inflateSync } from 'node:zlib';

export const PROGRAM = process.env.ASPERITY_PROGRAM;
export const DIST = new URL('../dist/', import.meta.url).pathname;

export const wasm = () => new WebAssembly.Module(readFileSync(join(DIST, 'page/asperity.wasm')));

/** Renders files (name → bytes or text) by the program, portable; answers both WAV files. */
export function render(files, scene) {
  const folder = mkdtempSync(join(tmpdir(), 'asperity-web-'));
  for (const [name, content] of Object.entries(files)) writeFileSync(join(folder, name), content);
  execFileSync(PROGRAM, ['render', join(folder, scene), '-o', join(folder, 'native'), '--kernel', 'portable']);
  return { audio: readFileSync(join(folder, 'native.audio.wav')), haptic: readFileSync(join(folder, 'native.haptic.wav')) };
}

/** What the program makes of a photograph so wide: its report, and the map of heights. */
export function fromPhoto(photo, width_m) {
  const folder = mkdtempSync(join(tmpdir(), 'asperity-web-'));
  writeFileSync(join(folder, 'photo.png'), photo);
  execFileSync(PROGRAM, ['texture', 'from-photo', join(folder, 'photo.png'), '-o', join(folder, 'made'), '--width-m', String(width_m)]);
  return { report: JSON.parse(readFileSync(join(folder, 'made/report.json'))), displacement: grey16(readFileSync(join(folder, 'made/displacement.png'))) };
}

/** The modes file that the program makes of the text of an OBJ file. */
export function fromMesh(obj, material, most) {
  const folder = mkdtempSync(join(tmpdir(), 'asperity-web-'));
  writeFileSync(join(folder, 'body.obj'), obj);
  execFileSync(PROGRAM, ['modes', join(folder, 'body.obj'), '--material', material, '--max-modes', String(most), '-o', join(folder, 'body.modes.json')]);
  return JSON.parse(readFileSync(join(folder, 'body.modes.json')));
}

/** Samples of a grey PNG of 16 bits. */
function grey16(bytes) {
  const [parts, [width, height]] = [[], [bytes.readUInt32BE(16), bytes.readUInt32BE(20)]];
  for (let at = 8; at < bytes.length; at += 12 + bytes.readUInt32BE(at)) {
    if (bytes.toString('latin1', at + 4, at + 8) === 'IDAT') parts.push(bytes.subarray(at + 8, at + 8 + bytes.readUInt32BE(at)));
  }
  const raw = inflateSync(Buffer.concat(parts));
  const [stride, rows] = [2 * width, []];
  for (let y = 0; y < height; y++) {
    const [filter, row, above] = [raw[y * (stride + 1)], Buffer.from(raw.subarray(y * (stride + 1) + 1, (y + 1) * (stride + 1))), rows.at(-1) ?? Buffer.alloc(stride)];
    for (let i = 0; i < stride; i++) {
      const [left, up, corner] = [row[i - 2] ?? 0, above[i], above[i - 2] ?? 0];
      const guess = left + up - corner;
      const paeth = [left, up, corner].reduce((best, each) => (Math.abs(guess - each) < Math.abs(guess - best) ? each : best));
      row[i] = (row[i] + [0, left, up, (left + up) >> 1, paeth][filter]) & 255;
    }
    rows.push(row);
  }
  return rows.flatMap((row) => Array.from({ length: width }, (_, x) => row.readUInt16BE(2 * x)));
}

/** Files of an archive without compression. */
export function unzip(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const files = {};
  for (let at = 0; view.getUint32(at, true) === 0x04034b50; ) {
    const [size, name] = [view.getUint32(at + 18, true), view.getUint16(at + 26, true)];
    const start = at + 30 + name;
    files[new TextDecoder().decode(bytes.subarray(at + 30, start))] = bytes.subarray(start, start + size);
    at = start + size;
  }
  return files;
}

/** The samples of a WAV file of this project. */
export const samples = (bytes) => new Float32Array(Uint8Array.from(bytes).buffer, 68);

/** A seeded generator: 0 to 1. */
export function seeded(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Lines of a stroke there and back, a second finger, and two blows, at 60 reports a second. */
export function stroke({ size_m, clamps, blow }) {
  const lines = [];
  const uv = (x, y) => (clamps ? [0.3 + x, 0.4 + y] : [0.1 + x / size_m[0], 0.3 + y / size_m[1]]);
  for (const [contact, from, speed] of [[1, 0.1, 0.08], [2, 0.9, 0.3]]) {
    for (let n = 0; n <= 48; n++) {
      const t = n / 60;
      const x = speed * (n < 24 ? t : 0.8 - t);
      const event = n === 0 ? { event: 'begin', contact, surface: 'surface', actuator: 0, closing_m_s: 0.03 } : { event: n === 48 ? 'end' : 'move', contact };
      lines.push({ t: from + t, ...event, ...(n === 48 ? {} : { uv: uv(x, 0.2 * x), normal_force_n: 0.6 + 0.1 * Math.sin(n) }) });
    }
  }
  for (const t of [0.05, 1.2]) lines.push({ t, event: 'impact', body: 'body', speed_m_s: 0.7, actuator: 0, ...(blow ?? { striker: 'wood', mass_kg: 0.01, radius_m: 0.01 }) });
  return lines.sort((a, b) => a.t - b.t);
}

export const text = (lines) => lines.map((line) => `${JSON.stringify(line)}\n`).join('');
