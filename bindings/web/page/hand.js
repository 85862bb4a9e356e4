// The hand: pointers, keys and a pad's stick become contacts, with place, force and time.

/** How often a finger that rests is reported, ms; the engine lets one go of which it has not heard for 250 ms. */
const RESTING_MS = 60;
/** Shortest time between two reports of a finger, s: a mouse of 1000 Hz says nothing that 250 Hz does not. */
const SHORTEST_S = 0.004;
/** Over how long a speed is taken, s: a pixel in a millisecond is no speed. */
const SPEED_OVER_S = 0.05;
/** A press that moved less, CSS pixels, and lasted less, ms, was a tap: it strikes too. */
const TAP = { pixels: 5, ms: 180 };
/** Speed of a finger led by keys, m/s, and with Shift. */
const KEY_SPEED_M_S = [0.06, 0.25];
/** How hard a finger lands, m/s. */
const CLOSING_M_S = 0.04;
/** Holding still presses harder, up to so many times, within so many seconds. */
const HELD = { times: 2, after_s: 1 };
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Hand {
  /** `page`: picture, place(at), turns(at), turn(x, y), force, blow, tool, report(events, stamp), strike(place, speed), touched(). */
  constructor(canvas, page, pixelsAMetre) {
    Object.assign(this, { canvas, page, pixelsAMetre });
    this.fingers = new Map();
    this.keys = new Set();
    this.contacts = 0;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.moved(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) canvas.addEventListener(name, (event) => this.up(event));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => { event.preventDefault(); page.press(event.deltaY < 0 ? 0.1 : -0.1); }, { passive: false });
    canvas.addEventListener('keydown', (event) => this.keyDown(event));
    canvas.addEventListener('keyup', (event) => this.keys.delete(event.key));
    canvas.addEventListener('blur', () => this.keys.clear());
    window.addEventListener('blur', () => this.release());
    document.addEventListener('visibilitychange', () => document.hidden && this.release());
    setInterval(() => this.rest(), RESTING_MS / 2);
  }

  place(event) {
    const { left, top } = this.canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  down(event) {
    if (event.button > 0) return;
    event.preventDefault();
    this.canvas.focus({ preventScroll: true, focusVisible: false });
    try { this.canvas.setPointerCapture(event.pointerId); } catch { /* A pointer that is gone already. */ }
    const at = this.place(event);
    this.page.touched();
    if (this.page.turns(at)) {
      this.turning = { pointer: event.pointerId, at };
      return;
    }
    if (this.page.tool() === 'hit') {
      this.page.strike(at, this.page.blow());
      return;
    }
    this.land(event.pointerId, at, this.seconds(event), this.pressure(event));
  }

  moved(event) {
    const at = this.place(event);
    this.page.picture.light = at;
    this.page.picture.dirty = true;
    if (this.turning?.pointer === event.pointerId) {
      this.page.turn(at[0] - this.turning.at[0], at[1] - this.turning.at[1]);
      this.turning.at = at;
      return;
    }
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return;
    const parts = event.getCoalescedEvents?.() ?? [];
    for (const part of parts.length > 0 ? parts : [event]) {
      finger.pressure = this.pressure(part);
      this.slide(finger, this.place(part), this.seconds(part));
    }
  }

  up(event) {
    if (this.turning?.pointer === event.pointerId) this.turning = null;
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return;
    const t = this.seconds(event);
    const tapped = finger.way < TAP.pixels && (t - finger.since) * 1000 < TAP.ms && event.type === 'pointerup';
    this.lift(event.pointerId, t);
    if (tapped) this.page.strike(finger.at, this.page.blow());
  }

  /** When it happened; a browser that stamps events by another clock is not believed. */
  seconds(event) {
    const now = performance.now();
    return (Math.abs(now - event.timeStamp) < 500 ? event.timeStamp : now) / 1000;
  }

  /** What a pen or a screen measures, 0 to 1; none where nothing does. */
  pressure(event) {
    const measures = event.pointerType === 'pen' || (event.pointerType === 'touch' && event.pressure !== 0.5);
    return measures && event.pressure > 0 && event.pressure < 1 ? event.pressure : null;
  }

  land(name, at, t, pressure = null) {
    const finger = { contact: ++this.contacts, at, t, since: t, still: t, way: 0, pressure, path: [[t, ...at]] };
    this.fingers.set(name, finger);
    this.show();
    this.page.report([{ t, event: 'begin', contact: finger.contact, surface: 'surface', actuator: 0, closing_m_s: CLOSING_M_S, ...this.sample(finger, t) }], Date.now());
  }

  slide(finger, at, t) {
    const step = Math.hypot(at[0] - finger.at[0], at[1] - finger.at[1]);
    if (step > 1) finger.still = t;
    finger.way += step;
    finger.at = at;
    // What comes late, or on the heels of another report, waits for the next one.
    if (t - finger.t < SHORTEST_S) return;
    finger.t = t;
    finger.path.push([t, ...at]);
    while (finger.path.length > 2 && t - finger.path[1][0] > SPEED_OVER_S) finger.path.shift();
    this.page.report([{ t, event: 'move', contact: finger.contact, velocity_m_s: this.velocity(finger), ...this.sample(finger, t) }]);
    this.show();
  }

  /** Along u and v, m/s: the straight line through the last places that fits them best. */
  velocity({ path }) {
    const n = path.length;
    const mean = [0, 1, 2].map((k) => path.reduce((sum, row) => sum + row[k], 0) / n);
    const along = (k) => path.reduce((sum, row) => sum + (row[0] - mean[0]) * (row[k] - mean[k]), 0);
    const spread = along(0);
    return spread > 0 ? [along(1), along(2)].map((sum) => sum / spread / this.pixelsAMetre) : [0, 0];
  }

  lift(name, t) {
    const finger = this.fingers.get(name);
    if (!finger) return;
    this.fingers.delete(name);
    this.page.report([{ t: Math.max(t, finger.t), event: 'end', contact: finger.contact }]);
    this.show();
  }

  /** Every finger goes: the page is left. */
  release() {
    for (const name of [...this.fingers.keys()]) this.lift(name, performance.now() / 1000);
    this.keys.clear();
  }

  force(finger, t) {
    if (finger.pressure !== null) return 0.1 + 3 * finger.pressure;
    const held = Math.min(1, Math.max(0, t - finger.still - 0.15) / HELD.after_s);
    return this.page.force() * (1 + (HELD.times - 1) * held);
  }

  sample(finger, t) {
    // Beside a body there is nothing to press on.
    const { on = true, ...place } = this.page.place(finger.at);
    return { ...place, normal_force_n: on ? this.force(finger, t) : 0 };
  }

  /** Fingers that rest are told again, and those of keys go on. */
  rest() {
    const t = performance.now() / 1000;
    this.lead(t);
    for (const [name, finger] of this.fingers) {
      if (name !== 'keys' && (t - finger.t) * 1000 > RESTING_MS) this.slide(finger, finger.at, t);
    }
  }

  keyDown(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key in KEYS) {
      this.keys.add(event.key);
      this.fast = event.shiftKey;
      this.page.touched();
    } else if (event.key === ',' || event.key === '.') {
      this.page.turn(event.key === ',' ? -30 : 30, 0);
    } else if (event.key === ' ' && !event.repeat) {
      this.page.touched();
      this.page.strike(this.fingers.get('keys')?.at ?? this.middle(), this.page.blow());
    } else return;
    event.preventDefault();
  }

  middle() {
    return [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
  }

  /** The finger of the keys. */
  lead(t) {
    const ways = [...this.keys].map((key) => KEYS[key]);
    const [x, y] = ways.reduce(([a, b], [p, q]) => [a + p, b + q], [0, 0]);
    const finger = this.fingers.get('keys');
    if (x === 0 && y === 0) {
      if (finger) { this.rested = finger.at; this.lift('keys', t); }
      return;
    }
    if (!finger) {
      this.land('keys', this.rested ?? this.middle(), t);
      return;
    }
    const speed = (KEY_SPEED_M_S[this.fast ? 1 : 0] * this.pixelsAMetre) / Math.hypot(x, y);
    const at = [finger.at[0] + x * speed * (t - finger.t), finger.at[1] + y * speed * (t - finger.t)];
    // At the edge of the window a finger of keys begins again at the other side.
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (at[0] < 0 || at[1] < 0 || at[0] > w || at[1] > h) {
      this.lift('keys', t);
      this.rested = [(at[0] + w) % w, (at[1] + h) % h];
      return;
    }
    this.page.picture.light = at;
    this.slide(finger, at, t);
  }

  /** Rings where fingers are, larger where they press. */
  show() {
    const { picture } = this.page;
    picture.touches.clear();
    for (const [name, finger] of this.fingers) picture.touches.set(name, [...finger.at, 14 + 8 * Math.sqrt(this.force(finger, finger.t))]);
    picture.dirty = true;
  }
}
