// What can be felt: whatever this device has, and what it does not have is said.
import { Actuators, gamepads } from './actuators.js';

export class Feel extends Actuators {
  constructor(list) {
    super({ phone: 'vibrate' in navigator && matchMedia('(pointer: coarse)').matches });
    this.list = list;
    addEventListener('gamepadconnected', () => this.tell());
    addEventListener('gamepaddisconnected', () => this.tell());
    this.tell();
  }

  tell(context) {
    const pads = gamepads();
    const felt = pads.filter((pad) => pad.vibrationActuator);
    const kind = (pad) => `${pad.id}: ${pad.vibrationActuator.playPCM ? 'the waveform itself' : 'two motors, slow and fast, 30 times a second'}.`;
    const channels = context?.destination.maxChannelCount ?? null;
    const lines = [
      this.phone ? 'This phone’s motor: turns on and off with what is felt.' : 'A phone’s motor: this device has none a page may use.',
      felt.length > 0 ? felt.map(kind).join(' ')
        : pads.length > 0 ? `${pads.map((pad) => pad.id).join(', ')}: this browser does not let a page turn its motors.`
        : 'A gamepad: none is connected, or no button was pressed yet. With one, two motors turn.',
      channels === null ? 'The waveform itself on channels 3 and 4 (a voice coil, a DualSense by USB): known when sound has begun.'
        : channels >= 4 ? `The sound device has ${channels} channels: the waveform itself can go to 3 and 4.`
        : `The sound device has ${channels} channels: the waveform itself needs 4.`,
    ];
    this.list.replaceChildren(...lines.map((line) => Object.assign(document.createElement('li'), { textContent: line })));
  }
}
