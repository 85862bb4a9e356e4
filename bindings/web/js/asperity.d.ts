/** asperity in the browser: contact events in, vibration and modal sound out. Every number is in SI units; the unit is part of its name. */

/** Heights or roughness, row after row from the top: whole numbers count as 0 to 1, floating point as it is. */
export interface Picture {
  width: number;
  height: number;
  samples: Uint8Array | Uint16Array | Float32Array;
}

/** What a contact is like at one moment. */
export interface Sample {
  /** 1 spans the surface's width and height; may run on beyond 0 to 1. */
  uv: [number, number];
  /** Along u and v; missing: estimated from the places. */
  velocity_m_s?: [number, number];
  normal_force_n?: number;
  /** Approach speed at landing. */
  closing_m_s?: number;
  /** How deep the tip stands in what gives way, instead of a force. */
  depth_m?: number;
  /** Place in the body's frame. */
  at_m?: [number, number, number];
  /** How fast what touches slides on the ground there; missing: as fast as it moves, a stroke; 0: it rolls. */
  slip_m_s?: number;
  /** Radius of what rolls; missing: of the probe's tip, at least 8 mm. */
  roll_radius_m?: number;
  /** Factor of what is felt and heard, 0 to 1000. */
  gain?: number;
  importance?: number;
}

/** A rigid striker hits a body. */
export interface Blow {
  speed_m_s?: number;
  mass_kg?: number;
  radius_m?: number;
  /** A material by name: steel, wood, rubber, … */
  striker?: string;
  restitution?: number;
  position?: number;
  at_m?: [number, number, number];
  direction?: [number, number, number];
  actuator?: number;
  probe?: string;
  holder?: string;
  other?: string;
  gain?: number;
}

/** A line of a contact log; `t` in seconds. */
export type Event =
  | ({ t?: number; event: 'begin'; contact: number; surface: string; actuator?: number; probe?: string; holder?: string } & Sample)
  | ({ t?: number; event: 'move'; contact: number } & Sample)
  | { t?: number; event: 'end'; contact: number }
  | ({ t?: number; event: 'impact'; body: string } & Blow);

/** What there is in an open scene. */
export interface Told {
  surfaces: { name: string; body: string | null; width_m: number; height_m: number }[];
  bodies: string[];
  probes: string[];
  materials: string[];
  buses: number;
  haptic_channels: number;
  sample_rate_hz: number;
  /** By how many samples all that leaves lags behind the times of its events. */
  latency_samples: number;
  full_scale: number[];
  gain: number[];
  /** Of each body: gain of its impacts beside strokes. */
  strike_gain: number[];
  tail_s: number;
}

/** What a scene is made of: the text of a scene file, and what it names. */
export interface SceneParts {
  scene: string;
  files?: Record<string, string | Uint8Array>;
  pictures?: Record<string, Picture>;
}

/** An engine that was opened elsewhere and waits to be taken over. */
export interface Prepared {
  image: Uint8Array;
  told: Told;
  relief: { width: number; height: number; heights: Float32Array } | null;
  picture: { columns: number; rows: number; cell_m: number } | null;
  record: boolean;
}

export interface PrepareOptions extends SceneParts {
  /** Rate of the outputs, Hz; 0: the scene's own. */
  rate?: number;
  /** Times of reports follow the audio (the default); otherwise they are exact. */
  live?: boolean;
  record?: boolean;
  /** Levels for motors a second; 0: none. */
  levels?: number;
  /** Points of the longer side of a grid of the first surface's heights; 0: none. */
  relief?: number;
  /** A surface that changes, to be watched. */
  watch?: string | null;
}

/** Opens a scene; for a worker, whose answer another thread takes over. Throws the engine's own sentence. */
export function prepare(module: WebAssembly.Module, options: PrepareOptions): Prepared;

/** Renders a contact log into WAV files, byte for byte those of `asperity render --kernel portable`. */
export function renderLog(module: WebAssembly.Module, options: SceneParts & { log: string | Event[]; rate?: number }): { audio: Uint8Array; haptic: Uint8Array };

/** The lines of a contact log. */
export function parseLog(text: string): Event[];

/** A WAV file of 32-bit floating point. */
export function wav(channels: Float32Array[], rate: number): Uint8Array;

/** Counts since the scene was opened. */
export interface Stats extends Record<string, unknown> {
  contacts: number;
  events: number;
  impacts: number;
  refused: number;
  /** The most that limiters took away. */
  limiter_db: number;
}

/** One engine in one instance: in a worker, in an AudioWorklet of your own, in node. */
export class Engine {
  constructor(module: WebAssembly.Module);
  static shell(module: WebAssembly.Module, bytes: number): Engine;
  readonly told: Told | null;
  /** The next sample, counted from the opening of the scene. */
  readonly position: number;
  addFile(name: string, content: string | Uint8Array): void;
  addPicture(name: string, picture: Picture): void;
  open(scene: string, options?: { rate?: number; live?: boolean; files?: SceneParts['files']; pictures?: SceneParts['pictures'] }): Told;
  apply(scene: string, options?: { files?: SceneParts['files']; pictures?: SceneParts['pictures'] }): { done: string[]; waiting: string[] };
  report(time_s: number, event: Event): void;
  /** Renders up to 1024 frames; tells how many. */
  render(frames: number): number;
  /** A view of what was rendered last; null where there is no such bus. */
  audio(bus: number, frames: number): Float32Array | null;
  haptic(channel: number, frames: number): Float32Array | null;
  scope(): Float32Array;
  do(what: 'mute' | 'pause' | 'resume' | 'fadeAll' | 'reset' | 'audioGain' | 'hapticGain' | 'timeScale', value?: number, index?: number): void;
  record(): void;
  /** Ends the recording: the contact log, UTF-8. */
  recorded(): Uint8Array;
  renderLog(log: string | Event[]): { audio: Float32Array[]; haptic: Float32Array[]; rate: number };
  relief(surface: string, longest: number): { width: number; height: number; heights: Float32Array };
  openLevels(channel: number, rate_hz: number): void;
  /** Peaks of the slow and the fast motor, in the unit of the samples. */
  levels(): [number, number];
  openPicture(surface: string): { columns: number; rows: number; cell_m: number };
  /** Tiles that have changed: column, row, columns, rows, then heights, m; null when none has. */
  picture(): Float32Array | null;
  stats(): { stats: Stats; why_silent: string[] };
  image(): Uint8Array;
  fill(image: Uint8Array, from: number, to: number): void;
  know(told: Told): void;
}

export interface EngineOptions extends Partial<PrepareOptions> {
  prepared?: Prepared;
  /** A contact log to play by itself, with exact times. */
  log?: string | Event[];
  /** Where asperity.wasm and worklet.js lie, if not beside asperity.js. */
  wasm?: string | URL;
  worklet?: string | URL;
}

/** What `frame` tells, 60 times a second. */
export interface Frame {
  /**
   * 16 numbers a block, of its first contact: how many contacts touch; lowest and highest ground under it, m; lowest and highest skin, m; place along
   * u and v, m; velocity along u and v, m/s; force that presses, N; momentum sent to the body, N·s; its name.
   */
  rows: Float32Array;
  levels: [number, number];
  tiles: Float32Array | null;
  time: number;
}

/** A running engine: events `frame` (detail: Frame), `refused`, `error`, `taken`. */
export class WebEngine extends EventTarget {
  addEventListener(type: 'frame', listener: (event: CustomEvent<Frame>) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject | null, options?: boolean | AddEventListenerOptions): void;
  readonly context: BaseAudioContext;
  readonly node: AudioWorkletNode;
  readonly told: Told;
  readonly surfaces: string[];
  readonly bodies: string[];
  /** What is heard. */
  connect<T extends AudioNode>(destination: T): T;
  /** What is felt, as a signal: channel i is actuator i. */
  connectHaptic<T extends AudioNode>(destination: T): T;
  report(...events: Event[]): void;
  begin(contact: number, surface: string, sample: Sample & { actuator?: number; probe?: string }): void;
  move(contact: number, sample: Sample): void;
  end(contact: number): void;
  impact(body: string, blow: Blow): void;
  /** Another scene in the place of this one, without a gap. */
  take(options: Partial<PrepareOptions> & { prepared?: Prepared }): Promise<void>;
  /** Changes the scene that sounds: bodies, surfaces, gains. */
  apply(scene: string, options?: { files?: SceneParts['files']; pictures?: SceneParts['pictures'] }): Promise<{ done: string[]; waiting: string[] }>;
  mute(muted: boolean): Promise<void>;
  pause(): Promise<void>;
  resume(): Promise<void>;
  fadeAll(): Promise<void>;
  setAudioGain(bus: number, gain: number): Promise<void>;
  setHapticGain(channel: number, gain: number): Promise<void>;
  stats(): Promise<{ stats: Stats; why_silent: string[]; memory: number }>;
  /** All that was reported, as a contact log that `asperity render` plays again. */
  log(): Promise<string>;
  close(): void;
}

/** What is felt, on a pad's waveform (`playPCM` of the W3C's draft), else its two motors, else the motor of a phone. */
export class Actuators {
  /** `full`: level of a channel at which a motor turns fully, 0.5; `phone`: false leaves a phone's motor alone. */
  constructor(options?: { full?: number; phone?: boolean });
  /** Takes the waveform for pads from a running engine's channel 0. */
  listen(engine: WebEngine): void;
  /** The `levels` of each `frame`. */
  feel(levels: [number, number]): void;
}

/** An engine that plays in a context: an AudioContext, or an OfflineAudioContext with a `log`. */
export function createEngine(context: BaseAudioContext, options?: EngineOptions): Promise<WebEngine>;
/** The engine's bytes, and compiled. */
export function load(url?: string | URL): Promise<{ bytes: ArrayBuffer; module: WebAssembly.Module }>;
/** Lets a context play engines; `createEngine` does it too. */
export function addWorklet(context: BaseAudioContext, url?: string | URL): Promise<void>;
