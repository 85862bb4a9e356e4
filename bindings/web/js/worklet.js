// The audio thread's half: plays one engine, takes another one over without a gap, tells the page what contacts do.
import { Engine, SCOPE_NUMBERS } from './engine.js';

/** Bytes of a new engine copied in one block; a megabyte takes some tenths of a millisecond. */
const COPIED_A_BLOCK = 1 << 20;
/** How long one engine fades into the next, s. */
const FADE_S = 0.03;
/** How often the page is told what contacts do, and what was recorded, s. */
const TOLD_S = 0.016;
const LOG_TOLD_S = 0.5;

class AsperityProcessor extends AudioWorkletProcessor {
  constructor({ processorOptions }) {
    super();
    const { wasm, prepared, log } = processorOptions;
    this.module = wasm instanceof WebAssembly.Module ? wasm : new WebAssembly.Module(wasm);
    this.engine = null;
    this.old = null;
    this.fading = 0;
    this.coming = null;
    this.waiting = [];
    this.script = (log ?? []).slice();
    this.scripted = 0;
    this.rows = new Float32Array(64 * SCOPE_NUMBERS);
    this.row = 0;
    this.sinceTold = 0;
    this.sinceLog = 0;
    this.stamps = [];
    this.alive = true;
    this.port.onmessage = ({ data }) => this.hear(data);
    if (prepared) {
      this.take({ prepared });
      this.copy(Infinity);
    }
  }

  hear(message) {
    if (message.do === 'events') {
      // Where there is no engine yet they wait.
      if (this.engine === null || this.coming !== null) this.waiting.push(message);
      else this.report(message);
      return;
    }
    try {
      const answer = this[message.do](message);
      if (message.id !== undefined) this.port.postMessage({ answer, id: message.id });
    } catch (error) {
      this.port.postMessage({ error: error.message, id: message.id });
    }
  }

  report({ events, stamp }) {
    for (const event of events) {
      try {
        this.engine.report(event.t, event);
      } catch (error) {
        this.port.postMessage({ refused: error.message, event });
      }
    }
    if (stamp !== undefined) this.stamps.push(stamp);
  }

  /** Another engine, made elsewhere. */
  take({ prepared, id }) {
    const { image, told, picture, record } = prepared;
    this.coming = { engine: Engine.shell(this.module, image.length), image, told, picture, record, done: 0, id };
  }

  copy(bytes) {
    const { engine, image, done, told } = this.coming;
    const to = Math.min(image.length, done + bytes);
    engine.fill(image, done, to);
    this.coming.done = to;
    if (to < image.length) return;
    engine.know(told);
    if (this.engine !== null) {
      this.tellLog();
      [this.old, this.fading] = [this.engine, 0];
    }
    this.engine = engine;
    this.watches = this.coming.picture !== null;
    this.records = this.coming.record;
    this.coming = null;
    this.port.postMessage({ taken: true });
    for (const message of this.waiting.splice(0)) this.report(message);
  }

  apply({ scene, files, pictures }) {
    return this.engine.apply(scene, { files, pictures });
  }

  command({ what, value, index }) {
    this.engine?.do(what, value, index);
  }

  stats() {
    return { stats: {}, why_silent: [], ...this.engine?.stats(), memory: this.engine?.wasm.memory.buffer.byteLength };
  }

  /** The rest of the recording, at once. */
  log() {
    this.tellLog();
  }

  close() {
    this.alive = false;
  }

  tellLog() {
    this.sinceLog = 0;
    if (!this.records || this.engine === null) return;
    const lines = this.engine.recorded();
    this.engine.record();
    if (lines.length > 0) this.port.postMessage({ log: lines }, [lines.buffer]);
  }

  /** Lines of a script that are due in this block. */
  play(frames) {
    if (this.scripted === this.script.length) return;
    const until = (this.engine.position + frames) / sampleRate;
    while (this.scripted < this.script.length && this.script[this.scripted].t < until) {
      const line = this.script[this.scripted++];
      this.report({ events: [line] });
    }
  }

  process(_inputs, outputs) {
    const [audio, haptic] = outputs;
    const frames = audio[0].length;
    if (this.coming !== null) this.copy(COPIED_A_BLOCK);
    if (this.engine === null) return this.alive;
    this.play(frames);
    this.engine.render(frames);
    this.mix(audio, (index) => this.engine.audio(index, frames));
    if (haptic) haptic.forEach((channel, index) => this.lay(channel, this.engine.haptic(index, frames)));
    if (this.old !== null) this.fade(audio, frames);
    this.watch(frames);
    return this.alive;
  }

  lay(channel, signal) {
    if (signal !== null) channel.set(signal);
  }

  /** One bus is heard on both sides; of several each has a channel. */
  mix(channels, bus) {
    const { buses } = this.engine.told;
    channels.forEach((channel, index) => this.lay(channel, bus(buses === 1 ? 0 : index)));
  }

  /** The old engine leaves as the new one comes. */
  fade(audio, frames) {
    this.old.render(frames);
    const step = 1 / (FADE_S * sampleRate);
    for (const channel of audio) {
      const leaving = this.old.audio(0, frames);
      for (let i = 0; i < frames; i++) {
        const share = Math.min(1, this.fading + i * step);
        channel[i] = channel[i] * share + (leaving?.[i] ?? 0) * (1 - share);
      }
    }
    this.fading += frames * step;
    if (this.fading >= 1) this.old = null;
  }

  /** Tells the page what it draws. */
  watch(frames) {
    if (this.row < 64) this.rows.set(this.engine.scope(), this.row++ * SCOPE_NUMBERS);
    this.sinceTold += frames / sampleRate;
    this.sinceLog += frames / sampleRate;
    for (const stamp of this.stamps.splice(0)) this.port.postMessage({ heard: stamp, at: Date.now() });
    if (this.sinceTold < TOLD_S) return;
    this.sinceTold = 0;
    const rows = this.rows.slice(0, this.row * SCOPE_NUMBERS);
    this.row = 0;
    const tiles = this.watches ? this.engine.picture() : null;
    const moved = [rows.buffer];
    if (tiles !== null) moved.push(tiles.buffer);
    this.port.postMessage({ rows, levels: this.engine.levels(), tiles, time: currentTime }, moved);
    if (this.sinceLog > LOG_TOLD_S) this.tellLog();
  }
}

registerProcessor('asperity', AsperityProcessor);
