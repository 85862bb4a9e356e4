// The engine in one WebAssembly instance: what an AudioWorklet, a worker and node call alike.
//
// Everything an engine is lies in its linear memory. So a worker may open a scene, which takes milliseconds, and hand the memory over; whoever
// takes it over (`Engine.shell`, then `fill`) goes on where the worker stopped, without making anything.

const KINDS = { begin: 1, move: 2, end: 3, impact: 4 };
/** Places of a row of numbers; src/events.rs says what each holds. */
const NUMBERS = {
  contact: 2, actuator: 4, normal_force_n: 11, closing_m_s: 12, depth_m: 13, gain: 20, importance: 21,
  speed_m_s: 22, mass_kg: 23, radius_m: 24, restitution: 25, position: 27, slip_m_s: 29, roll_radius_m: 30,
};
const VECTORS = { uv: 7, velocity_m_s: 9, at_m: 14, direction: 17 };
const THINGS = {
  surface: [3, 'surfaces'], body: [3, 'bodies'], probe: [5, 'probes'], holder: [6, 'bodies'],
  striker: [26, 'materials'], other: [28, 'bodies'],
};
const PAGE = 65536;
const COMMANDS = { mute: 0, pause: 1, resume: 2, fadeAll: 3, reset: 4, audioGain: 5, hapticGain: 6, timeScale: 7 };
export const SCOPE_NUMBERS = 16;
/** Bytes of a WAV file before its samples, and what says that they are floating point. */
const HEADER = 68;
const FLOAT_GUID = [3, 0, 0, 0, 0, 0, 16, 0, 128, 0, 0, 170, 0, 56, 155, 113];

/** UTF-8 by hand: an AudioWorklet has no TextEncoder. */
export function encode(text) {
  const bytes = [];
  for (const letter of text) {
    const code = letter.codePointAt(0);
    if (code < 0x80) bytes.push(code);
    else if (code < 0x800) bytes.push(0xc0 | (code >> 6), 0x80 | (code & 63));
    else if (code < 0x10000) bytes.push(0xe0 | (code >> 12), 0x80 | ((code >> 6) & 63), 0x80 | (code & 63));
    else bytes.push(0xf0 | (code >> 18), 0x80 | ((code >> 12) & 63), 0x80 | ((code >> 6) & 63), 0x80 | (code & 63));
  }
  return Uint8Array.from(bytes);
}

/** The reverse of `encode`; what is not UTF-8 is shown as �. */
export function decode(bytes) {
  let text = '';
  for (let i = 0; i < bytes.length; ) {
    const first = bytes[i++];
    const more = first < 0x80 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    let code = more === 0 ? first : first & (0x3f >> more);
    for (let k = 0; k < more; k++) code = (code << 6) | (bytes[i++] & 63);
    text += code <= 0x10ffff ? String.fromCodePoint(code) : '\ufffd';
  }
  return text;
}

export class Engine {
  /** An instance without a scene, of a compiled module. */
  constructor(module) {
    this.wasm = new WebAssembly.Instance(module).exports;
    this.told = null;
    this.numbers = {};
    this.views = null;
  }

  /** An instance that will take over an engine of so many bytes. */
  static shell(module, bytes) {
    const engine = new Engine(module);
    const lacking = bytes - engine.wasm.memory.buffer.byteLength;
    if (lacking > 0) engine.wasm.memory.grow(Math.ceil(lacking / PAGE));
    return engine;
  }

  /** Copies bytes `from` to `to` of another engine's memory into this one's. */
  fill(image, from, to) {
    new Uint8Array(this.wasm.memory.buffer).set(image.subarray(from, to), from);
  }

  /** A copy of everything this engine is. */
  image() {
    this.wasm.asp_forget_boxes();
    return new Uint8Array(this.wasm.memory.buffer.slice(0));
  }

  /** Keeps what the engine has told of itself, and by which numbers its things are called. */
  know(told) {
    this.told = told;
    const names = (list) => new Map(list.map((thing, index) => [thing.name ?? thing, index]));
    const materials = told.materials ?? [];
    this.numbers = {
      surfaces: names(told.surfaces), bodies: names(told.bodies), probes: names(told.probes), materials: names(materials),
    };
  }

  put(...parts) {
    const bytes = parts.reduce((sum, part) => sum + part.length, 0);
    let at = this.wasm.asp_inbox(bytes);
    for (const part of parts) {
      new Uint8Array(this.wasm.memory.buffer, at, part.length).set(part);
      at += part.length;
    }
  }

  /** What the last call has answered: a copy. */
  answer() {
    return new Uint8Array(this.wasm.memory.buffer, this.wasm.asp_outbox(), this.wasm.asp_outbox_bytes()).slice();
  }

  check(done) {
    if (!done) throw new Error(decode(this.answer()));
  }

  /** A file that scenes name; `content` is text or bytes. */
  addFile(name, content) {
    const [path, bytes] = [encode(name), typeof content === 'string' ? encode(content) : content];
    this.put(path, bytes);
    this.check(this.wasm.asp_file(path.length));
  }

  /** A decoded picture under the name of its file: `{ width, height, samples }`, samples a Uint8Array, Uint16Array or Float32Array. */
  addPicture(name, { width, height, samples }) {
    const path = encode(name);
    const bytes = new Uint8Array(samples.buffer, samples.byteOffset, samples.byteLength);
    this.put(path, bytes);
    this.check(this.wasm.asp_picture(path.length, width, height, samples.BYTES_PER_ELEMENT));
  }

  /** Opens the text of a scene file. `live`: times of reports follow the audio; otherwise they are exact. */
  open(scene, { rate = 0, live = false, files = {}, pictures = {} } = {}) {
    for (const [name, content] of Object.entries(files)) this.addFile(name, content);
    for (const [name, picture] of Object.entries(pictures)) this.addPicture(name, picture);
    this.put(encode(scene));
    this.check(this.wasm.asp_open(rate, live ? 1 : 0));
    this.know(JSON.parse(decode(this.answer())));
    return this.told;
  }

  /** Makes of the scene that runs the one that `scene` says. Answers what has changed and what waits. */
  apply(scene, { files = {}, pictures = {} } = {}) {
    for (const [name, content] of Object.entries(files)) this.addFile(name, content);
    for (const [name, picture] of Object.entries(pictures)) this.addPicture(name, picture);
    this.put(encode(scene));
    this.check(this.wasm.asp_apply());
    const { done, waiting, names } = JSON.parse(decode(this.answer()));
    this.know({ ...this.told, ...names });
    return { done, waiting };
  }

  /** Reports an event, with the keys of a line of a contact log, at `time` seconds. */
  report(time, event) {
    const row = this.row();
    row.fill(NaN);
    row[0] = time;
    row[1] = KINDS[event.event] ?? NaN;
    for (const key in event) {
      const value = event[key];
      if (value === undefined || value === null || key === 'event' || key === 't' || key === 'version') continue;
      if (key in NUMBERS) row[NUMBERS[key]] = value;
      else if (key in VECTORS) for (let i = 0; i < value.length; i++) row[VECTORS[key] + i] = value[i];
      else if (key in THINGS) row[THINGS[key][0]] = this.number(key, value);
      else throw new Error(`${key}: is no key of an event; must be one of docs/formats/log.md`);
    }
    this.check(this.wasm.asp_report());
  }

  number(key, name) {
    const known = this.numbers[THINGS[key][1]];
    const number = known?.get(name);
    if (number === undefined) {
      throw new Error(`${key}: "${name}" is unknown; must be one of ${[...(known?.keys() ?? [])].join(', ')}`);
    }
    return number;
  }

  row() {
    return this.view().row;
  }

  /** Views of the memory, anew when it has grown. */
  view() {
    const { buffer } = this.wasm.memory;
    if (this.views?.buffer !== buffer) {
      const row = new Float64Array(buffer, this.wasm.asp_event(), 32);
      this.views = { buffer, row, floats: new Float32Array(buffer) };
    }
    return this.views;
  }

  /** Renders the next frames; `audio`, `haptic` and `scope` are of these until the next call. */
  render(frames) {
    return this.wasm.asp_render(frames);
  }

  /** Frames of bus `index`, a view. */
  audio(index, frames) {
    return this.signal(this.wasm.asp_audio(index), frames);
  }

  /** Frames of haptic channel `index`, a view. */
  haptic(index, frames) {
    return this.signal(this.wasm.asp_haptic(index), frames);
  }

  signal(at, frames) {
    return at === 0 ? null : this.view().floats.subarray(at >> 2, (at >> 2) + frames);
  }

  /** What contacts did in the last block; src/blocks.rs says what each number is. */
  scope() {
    return this.signal(this.wasm.asp_scope(), SCOPE_NUMBERS);
  }

  /** mute, pause, resume, fadeAll, reset, audioGain, hapticGain, timeScale. */
  do(what, value = 0, index = 0) {
    if (!(what in COMMANDS)) throw new Error(`${what}: is unknown; must be one of ${Object.keys(COMMANDS).join(', ')}`);
    this.check(this.wasm.asp_do(COMMANDS[what], index, Number(value)));
  }

  record() {
    this.check(this.wasm.asp_record_start());
  }

  /** Ends the recording; answers the log as bytes. */
  recorded() {
    this.check(this.wasm.asp_record_stop());
    return this.answer();
  }

  /**
   * Renders a whole log, as `asperity render` does: `{ audio, haptic, rate }`, a Float32Array for each bus and each actuator. The engine was opened
   * with exact times, and is used up.
   */
  renderLog(log) {
    const lines = typeof log === 'string' ? parseLog(log) : log;
    const { sample_rate_hz: rate, latency_samples: late, buses, haptic_channels, tail_s } = this.told;
    const total = Math.ceil(((lines.at(-1)?.t ?? 0) + Math.max(0, tail_s)) * rate) + late;
    const signals = (count) => Array.from({ length: count }, () => new Float32Array(total));
    const [audio, haptic] = [signals(buses), signals(haptic_channels)];
    let next = 0;
    for (let at = 0; at < total; ) {
      const frames = Math.min(512, total - at);
      // Where a block ends changes no sample; what happens within it has to be known before.
      while (next < lines.length && lines[next].t * rate < at + frames) this.report(lines[next].t, lines[next++]);
      this.render(frames);
      audio.forEach((signal, index) => signal.set(this.audio(index, frames), at));
      haptic.forEach((signal, index) => signal.set(this.haptic(index, frames), at));
      at += frames;
    }
    return { audio: audio.map((signal) => signal.subarray(late)), haptic: haptic.map((signal) => signal.subarray(late)), rate };
  }

  stats() {
    this.check(this.wasm.asp_stats());
    return JSON.parse(decode(this.answer()));
  }

  /** Heights of a surface on a grid: `{ width, height, heights }`, metres. */
  relief(surface, longest) {
    this.check(this.wasm.asp_relief(this.number('surface', surface), longest));
    const bytes = this.answer();
    const [width, height] = new Uint32Array(bytes.buffer, 0, 2);
    return { width, height, heights: new Float32Array(bytes.buffer, 8) };
  }

  openLevels(channel, rate) {
    this.check(this.wasm.asp_open_levels(channel, rate));
  }

  levels() {
    return [this.wasm.asp_level(0), this.wasm.asp_level(1)];
  }

  /** Watches a surface that changes: `{ columns, rows, cell_m }`. */
  openPicture(surface) {
    this.check(this.wasm.asp_open_picture(this.number('surface', surface)));
    const [columns, rows, cell_m] = new Float32Array(this.answer().buffer);
    return { columns, rows, cell_m };
  }

  /** What has changed of it, or null; src/ports.rs says how it is laid out. */
  picture() {
    return this.wasm.asp_read_picture() === 0 ? null : new Float32Array(this.answer().buffer);
  }

  get position() {
    return this.wasm.asp_position();
  }
}

/** Opens a scene and answers all that another thread needs to go on with it: `{ image, told, relief, picture }`. For a worker. */
export function prepare(module, { scene, rate, live = true, record = true, levels = 0, files, pictures, relief = 0, watch = null }) {
  const engine = new Engine(module);
  const told = engine.open(scene, { rate, live, files, pictures });
  const heights = relief > 0 && told.surfaces.length > 0 ? engine.relief(told.surfaces[0].name, relief) : null;
  const picture = watch === null ? null : engine.openPicture(watch);
  if (levels > 0 && told.haptic_channels > 0) engine.openLevels(0, levels);
  if (record) engine.record();
  engine.wasm.asp_forget_files();
  return { image: engine.image(), told, relief: heights, picture, record };
}

/** A log and its scene, rendered into two WAV files as bytes, those of `asperity render --kernel portable`. For a worker. */
export function renderLog(module, { scene, log, rate = 0, files, pictures }) {
  const engine = new Engine(module);
  engine.open(scene, { rate, files, pictures });
  const render = engine.renderLog(log);
  return { audio: wav(render.audio, render.rate), haptic: wav(render.haptic, render.rate) };
}

/** The lines of a contact log; a line that is none is refused by its number. */
export function parseLog(text) {
  const lines = [];
  text.split('\n').forEach((line, index) => {
    if (line.trim() === '') return;
    let read;
    try {
      read = JSON.parse(line);
    } catch {
      throw new Error(`log:${index + 1}: is no JSON; must be one event a line`);
    }
    if (read.event === undefined && read.version === 1) return;
    if (!(read.t >= (lines.at(-1)?.t ?? 0) && read.t <= 86400)) {
      throw new Error(`log:${index + 1}: t: ${read.t} is refused; must not run backwards and be at most a day`);
    }
    lines.push(read);
  });
  return lines;
}

/** A WAV file of 32-bit floating point, byte for byte as the program writes it. */
export function wav(channels, rate) {
  const [count, frames] = [channels.length, channels[0]?.length ?? 0];
  const bytes = new Uint8Array(HEADER + 4 * count * frames);
  const view = new DataView(bytes.buffer);
  const text = (at, word) => [...word].forEach((letter, i) => view.setUint8(at + i, letter.charCodeAt(0)));
  const data = 4 * count * frames;
  text(0, 'RIFF');
  view.setUint32(4, HEADER - 8 + data, true);
  text(8, 'WAVEfmt ');
  // Extensible, because 32-bit floating point in many channels is only that.
  [40, 0xfffe | (count << 16), rate, 4 * count * rate, (4 * count) | (32 << 16), 22 | (32 << 16), 2 ** Math.min(count, 18) - 1]
    .forEach((word, i) => view.setUint32(16 + 4 * i, word, true));
  FLOAT_GUID.forEach((byte, i) => view.setUint8(44 + i, byte));
  text(60, 'data');
  view.setUint32(64, data, true);
  const samples = new Float32Array(bytes.buffer, HEADER);
  for (let c = 0; c < count; c++) for (let i = 0; i < frames; i++) samples[i * count + c] = channels[c][i];
  return bytes;
}
