// What can be felt: whatever this device has, and what it does not have is said.

/** Levels of a channel, as a share of full scale, at which a motor turns fully. */
const FULL = 0.5;
const PAD_MS = 40;
const PHONE_MS = 50;

export class Feel {
  constructor(list) {
    this.list = list;
    this.levels = [0, 0];
    this.pads = new Set();
    this.rumbled = 0;
    addEventListener('gamepadconnected', () => this.tell());
    addEventListener('gamepaddisconnected', () => this.tell());
    this.tell();
  }

  gamepads() {
    return [...(navigator.getGamepads?.() ?? [])].filter(Boolean);
  }

  tell(context) {
    const phone = 'vibrate' in navigator && matchMedia('(pointer: coarse)').matches;
    const pads = this.gamepads();
    const rumble = pads.filter((pad) => pad.vibrationActuator);
    const channels = context?.destination.maxChannelCount ?? null;
    const lines = [
      phone ? 'This phone’s motor: turns on and off with what is felt.' : 'A phone’s motor: this device has none a page may use.',
      rumble.length > 0 ? `${rumble.map((pad) => pad.id).join(', ')}: two motors, slow and fast, 25 times a second.`
        : pads.length > 0 ? `${pads.map((pad) => pad.id).join(', ')}: this browser does not let a page turn its motors.`
        : 'A gamepad: none is connected, or no button was pressed yet. With one, two motors turn.',
      channels === null ? 'The waveform itself on channels 3 and 4 (a voice coil, a DualSense by USB): known when sound has begun.'
        : channels >= 4 ? `The sound device has ${channels} channels: the waveform itself can go to 3 and 4.`
        : `The sound device has ${channels} channels: the waveform itself needs 4.`,
    ];
    this.list.replaceChildren(...lines.map((line) => Object.assign(document.createElement('li'), { textContent: line })));
    this.phone = phone;
  }

  /** The newest levels of the heavy and the light motor. */
  feel([low, high], muted) {
    const now = performance.now();
    const strong = muted ? 0 : Math.min(1, low / FULL);
    const weak = muted ? 0 : Math.min(1, high / FULL);
    if (now - this.rumbled < (this.phone ? PHONE_MS : PAD_MS)) return;
    const was = this.on;
    this.on = strong > 0.02 || weak > 0.02;
    if (!this.on && !was) return;
    this.rumbled = now;
    for (const pad of this.gamepads()) {
      pad.vibrationActuator?.playEffect?.('dual-rumble', { duration: 2 * PAD_MS, strongMagnitude: strong, weakMagnitude: weak }).catch(() => {});
    }
    // On and off only: long where much is felt.
    if (this.phone && navigator.userActivation?.hasBeenActive) navigator.vibrate(Math.round(PHONE_MS * Math.min(1, strong + weak)));
  }
}
