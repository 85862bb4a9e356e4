// asperity in a web page: touch becomes sound and vibration, in an AudioWorklet.
import { Actuators } from './actuators.js';
import { Engine, decode, parseLog, prepare, renderLog } from './engine.js';

export { Actuators, Engine, parseLog, prepare, renderLog };

const WASM = new URL('./asperity.wasm', import.meta.url);
const WORKLET = new URL('./worklet.js', import.meta.url);
const compiled = new Map();
const added = new WeakMap();

/** The engine's bytes, and compiled; once for each address. */
export function load(url = WASM) {
  const key = String(url);
  if (!compiled.has(key)) {
    const loading = fetchBytes(url).then(async (bytes) => ({ bytes, module: await WebAssembly.compile(bytes) }));
    loading.catch(() => compiled.delete(key));
    compiled.set(key, loading);
  }
  return compiled.get(key);
}

async function fetchBytes(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: cannot be read (${response.status}); it must lie beside asperity.js`);
  return response.arrayBuffer();
}

/** Lets a context play engines; once for each context. */
export function addWorklet(context, url = WORKLET) {
  if (!added.has(context)) added.set(context, context.audioWorklet.addModule(url));
  return added.get(context);
}

/**
 * An engine that plays in `context`. `options`: `scene` (the text of a scene file), `files` and `pictures` that it names, or `prepared` (what
 * `prepare` has answered in a worker); `log` (a contact log to play by itself, with exact times); `wasm` (where the engine lies).
 */
export async function createEngine(context, options = {}) {
  const { bytes, module } = await load(options.wasm);
  const live = options.log === undefined;
  const log = typeof options.log === 'string' ? parseLog(options.log) : options.log;
  const prepared = options.prepared ?? prepare(module, { rate: context.sampleRate, live, ...options });
  await addWorklet(context, options.worklet);
  const haptic = Math.max(1, prepared.told.haptic_channels);
  const node = new AudioWorkletNode(context, 'asperity', {
    numberOfInputs: 0,
    numberOfOutputs: 2,
    outputChannelCount: [prepared.told.buses > 1 ? prepared.told.buses : 2, haptic],
    processorOptions: { wasm: bytes, prepared, log },
  });
  return new WebEngine(context, node, prepared, options);
}

/** A running engine. */
export class WebEngine extends EventTarget {
  constructor(context, node, prepared, options) {
    super();
    Object.assign(this, { context, node, told: prepared.told, scene: options.scene ?? '' });
    this.calls = new Map();
    this.names = 0;
    this.lines = [];
    node.port.onmessage = ({ data }) => this.hear(data);
    node.onprocessorerror = () => this.tell('error', new Error('the audio thread has stopped; make another engine'));
  }

  get surfaces() {
    return this.told.surfaces.map((surface) => surface.name);
  }

  get bodies() {
    return this.told.bodies;
  }

  /** What is heard. */
  connect(destination) {
    this.node.connect(destination, 0);
    return destination;
  }

  /** What is felt, as a signal: channel i is actuator i. */
  connectHaptic(destination) {
    this.node.connect(destination, 1);
    return destination;
  }

  /** Reports events with the keys of a contact log; `t` in seconds of any clock that runs evenly, now when missing. */
  report(...events) {
    const now = performance.now() / 1000;
    this.node.port.postMessage({ do: 'events', events: events.map((event) => ({ t: now, ...event })) });
  }

  begin(contact, surface, sample) {
    this.report({ event: 'begin', contact, surface, actuator: 0, ...sample });
  }

  move(contact, sample) {
    this.report({ event: 'move', contact, ...sample });
  }

  end(contact) {
    this.report({ event: 'end', contact });
  }

  impact(body, blow) {
    this.report({ event: 'impact', body, ...blow });
  }

  /** Another scene in the place of this one, prepared in a worker or here; the old one fades. */
  async take(options) {
    const { module } = await load(options.wasm);
    const prepared = options.prepared ?? prepare(module, { rate: this.context.sampleRate, ...options });
    this.told = prepared.told;
    this.scene = options.scene ?? this.scene;
    const taken = new Promise((resolve) => this.addEventListener('taken', resolve, { once: true }));
    const { image } = prepared;
    this.node.port.postMessage({ do: 'take', prepared }, [image.buffer]);
    await taken;
    this.lines = [];
  }

  /** Changes the scene that sounds into the one of this text: numbers of surfaces and bodies, their maps. */
  async apply(scene, { files, pictures } = {}) {
    const changes = await this.call({ do: 'apply', scene, files, pictures });
    this.scene = scene;
    return changes;
  }

  mute(muted) {
    return this.call({ do: 'command', what: 'mute', value: muted ? 1 : 0 });
  }

  pause() {
    return this.call({ do: 'command', what: 'pause' });
  }

  resume() {
    return this.call({ do: 'command', what: 'resume' });
  }

  fadeAll() {
    return this.call({ do: 'command', what: 'fadeAll' });
  }

  setAudioGain(bus, gain) {
    return this.call({ do: 'command', what: 'audioGain', index: bus, value: gain });
  }

  setHapticGain(channel, gain) {
    return this.call({ do: 'command', what: 'hapticGain', index: channel, value: gain });
  }

  stats() {
    return this.call({ do: 'stats' });
  }

  /** All that was reported since the engine or its scene was made, as a contact log. */
  async log() {
    await this.call({ do: 'log' });
    return this.lines.join('');
  }

  /** Ends for good. */
  close() {
    this.node.port.postMessage({ do: 'close' });
    this.node.disconnect();
  }

  call(message) {
    const id = ++this.names;
    this.node.port.postMessage({ ...message, id });
    return new Promise((resolve, reject) => this.calls.set(id, { resolve, reject }));
  }

  hear(data) {
    if (data.id !== undefined) {
      const { resolve, reject } = this.calls.get(data.id);
      this.calls.delete(data.id);
      if (data.error === undefined) resolve(data.answer);
      else reject(new Error(data.error));
    } else if (data.log !== undefined) this.keep(decode(data.log));
    else if (data.rows !== undefined) this.tell('frame', data);
    else if (data.refused !== undefined) this.tell('refused', data);
    else if (data.heard !== undefined) this.tell('heard', data);
    else if (data.taken !== undefined) this.tell('taken', data);
  }

  /** Every part of a recording begins with the version; the whole says it once. */
  keep(text) {
    this.lines.push(this.lines.length === 0 ? text : text.replace(/^\{"version":1,/, '{'));
  }

  tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
