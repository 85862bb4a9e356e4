// What is felt, on what this device has: a pad's waveform where its actuator takes one (playPCM of the W3C's draft), else its two motors, else the motor of
// a phone.

/** Level at which a motor turns, as a share of its full level. */
const FLOOR = 0.02;
/** Time between two calls, and the length of one, ms. */
const CALL_MS = 30;
const LASTS_MS = 80;
// The newest samples that are at hand, and by how much a pad's waveform lags: each call takes the place of the one before, so it holds what is needed
// until the next, and some more.
const SAMPLES = 4096;
const LAG_S = 0.064;

export const gamepads = () => [...(navigator.getGamepads?.() ?? [])].filter(Boolean);

export class Actuators {
  /** `full`: level of a channel at which a motor turns fully; `phone`: false leaves a phone's motor alone. */
  constructor({ full = 0.5, phone = true } = {}) {
    Object.assign(this, { full, phone, called: 0, on: false });
    /** Pads whose playPCM was refused, until they come back. */
    this.refused = new Set();
    addEventListener('gamepaddisconnected', ({ gamepad }) => this.refused.delete(gamepad.id));
  }

  /** Takes the waveform for pads from a running engine's channel 0. */
  listen(engine) {
    this.tap ??= new AnalyserNode(engine.context, { fftSize: SAMPLES, channelCount: 1, channelCountMode: 'explicit', channelInterpretation: 'discrete' });
    this.samples = new Float32Array(SAMPLES);
    engine.connectHaptic(this.tap);
  }

  /** The newest levels of the heavy and the light motor, as the event `frame` has them. */
  feel([heavy, light]) {
    const now = performance.now();
    if (now - this.called < CALL_MS) return;
    const [strong, weak] = [heavy, light].map((level) => Math.min(1, level / this.full));
    const was = this.on;
    this.on = strong > FLOOR || weak > FLOOR;
    if (!this.on && !was) return;
    this.called = now;
    const wave = this.wave(now, was);
    const reached = gamepads().filter((pad) => this.drive(pad, wave, strong, weak));
    // On and off only: long where much is felt.
    if (reached.length > 0 || !this.phone || !navigator.userActivation?.hasBeenActive) return;
    navigator.vibrate?.(Math.round(LASTS_MS * Math.min(1, strong + weak)));
  }

  drive({ id, vibrationActuator: actuator }, wave, strong, weak) {
    if (wave !== null && actuator?.playPCM && !this.refused.has(id)) {
      const refuse = () => this.refused.add(id);
      actuator.playPCM(wave).then((result) => { if (result === 'not-supported') refuse(); }, refuse);
      return true;
    }
    actuator?.playEffect?.('dual-rumble', { duration: LASTS_MS, strongMagnitude: strong, weakMagnitude: weak }).catch(() => {});
    return Boolean(actuator?.playEffect);
  }

  /** What follows where a pad has got to in the call before, by the page's clock: audio comes in blocks, and their edges would be felt. */
  wave(now, goesOn) {
    if (!this.tap) return null;
    const { sampleRate: rate, currentTime } = this.tap.context;
    const [newest, got] = [Math.round(currentTime * rate), Math.round(now / 1000 * rate)];
    let left = newest - (got + this.ahead);
    if (!goesOn || !(left > rate * LAG_S / 2 && left <= SAMPLES)) {
      left = Math.round(rate * LAG_S);
      this.ahead = newest - left - got;
    }
    this.tap.getFloatTimeDomainData(this.samples);
    const wave = new AudioBuffer({ length: left, sampleRate: rate });
    wave.copyToChannel(this.samples.subarray(SAMPLES - left), 0);
    return wave;
  }
}
