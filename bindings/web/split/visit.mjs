// What a visitor does with the first surface: opening it, and everything that hands, keys, pads and buttons of the page report. `build` notes which
// parts of the engine that needs. The files are those that the page loads, whose lines are not indented as the sources' are: a scene of another length
// takes another way through the allocator.
import { Engine } from '../dist/page/engine.js';
import { Hand } from '../dist/page/hand.js';
import { PIXELS_A_METRE } from '../dist/page/look.js';
import { LEVELS_HZ, RATE_HZ, SURFACES, sceneOf } from '../dist/page/surfaces.js';

const BLOCK = 128;
/** Of so many visitors one leads the page's own hand by a mouse. */
const MICE = 3;

/** Whole numbers from a seed, 0 to 1. */
function seeded(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

/** The first surface as the page opens it; tells the instance. */
export function opened(module) {
  const { text, pictures, files } = sceneOf(SURFACES[0], SURFACES[0].id);
  const engine = new Engine(module);
  engine.open(text, { rate: RATE_HZ, live: true, files, pictures });
  engine.openLevels(0, LEVELS_HZ);
  engine.record();
  engine.wasm.asp_forget_files();
  return engine;
}

/** Taken over by another instance, as the audio thread does. */
export function taken(module, engine) {
  const image = engine.image();
  const other = Engine.shell(module, image.length);
  other.fill(image, 0, image.length);
  other.know(engine.told);
  return other;
}

/** Reports what may be refused; whether the engine lacks something is another matter. */
function report(engine, t, event) {
  try { engine.report(t, event); } catch (error) { if (error instanceof WebAssembly.RuntimeError) throw error; }
}

/** A block, and what the audio thread asks the engine for beside. */
function hear(engine, block) {
  if (!(engine.position >= 0)) throw new Error('the engine has no position');
  engine.render(BLOCK);
  for (const signal of [engine.scope(), engine.audio(0, BLOCK), engine.haptic(0, BLOCK)]) if (!signal.every((x) => !Number.isNaN(x))) throw new Error('not a number');
  if (block % 6 === 0) engine.levels();
}

/** Plays for so many seconds: up to ten fingers that slide, rest, leap, press, are forgotten and come back; blows; all buttons. */
export function play(engine, seed, seconds) {
  const random = seeded(seed);
  const fingers = new Map();
  let name = 0;
  let skew = 0;
  const late = [];
  let stalls = 0;
  const tell = (t, event) => {
    // A page that is busy reports nothing for a while, and then all at once.
    late.push([t, event]);
    if (stalls === 0) for (const [then, what] of late.splice(0)) report(engine, then, what);
  };
  // Every other visitor has one finger only and leads it evenly, as keys do.
  const isCalm = seed % 2 === 1;
  const pace = () => [0, 0.02, 0.1, 0.3, 1, 3][Math.floor(random() * 6)];
  const begin = (t) => {
    const finger = { uv: [random() * 3 - 1, random() * 3 - 1], v: [pace() * (random() - 0.5), pace() * (random() - 0.5)], t, force: 0.1 + 3 * random() };
    fingers.set(++name, finger);
    tell(t, { event: 'begin', contact: name, surface: 'surface', actuator: 0, uv: finger.uv, normal_force_n: finger.force, closing_m_s: random() < 0.8 ? 0.04 : undefined });
  };
  const move = (t, contact, finger) => {
    const dt = t - finger.t;
    finger.t = t;
    if (random() < (isCalm ? 0.002 : 0.03)) finger.v = [pace() * (random() - 0.5), pace() * (random() - 0.5)];
    if (!isCalm && random() < 0.005) finger.uv = [random() * 40 - 20, random()];
    if (!isCalm && random() < 0.05) finger.force = random() < 0.1 ? 0 : 6 * random();
    finger.uv = [finger.uv[0] + finger.v[0] * dt / 0.028, finger.uv[1] + finger.v[1] * dt / 0.007];
    tell(t, { event: 'move', contact, uv: finger.uv, velocity_m_s: random() < 0.9 ? finger.v : undefined, normal_force_n: finger.force });
  };
  // The first touch may well be there before the first block, or long after.
  if (isCalm) begin(1000.003);
  else if (random() < 0.3) for (let idle = Math.floor(300 * random()); idle > 0; idle--) hear(engine, idle);
  for (let block = 0; block < (seconds * RATE_HZ) / BLOCK; block++) {
    const clock = 1000 + (block * BLOCK) / RATE_HZ;
    stalls = stalls > 0 ? stalls - 1 : random() < 0.002 ? Math.floor(600 * random() ** 2) : 0;
    // Clocks differ, and where the processor has too much to do the sound falls behind them.
    if (random() < 0.002) skew = 0.3 * (random() - 0.5);
    if (!isCalm && random() < 0.0005) skew += random();
    const t = clock + skew + 0.004 * random();
    if (random() < 0.03 && fingers.size < (isCalm ? 1 : 10)) begin(t);
    for (const [contact, finger] of fingers) {
      if (random() < 0.006) { fingers.delete(contact); if (random() < 0.8) tell(t, { event: 'end', contact }); }
      else if (!finger.still && t > finger.t && random() < 0.35) move(t, contact, finger);
      if (random() < 0.002) finger.still = !finger.still;
    }
    if (random() < 0.02) tell(t, { event: 'impact', body: 'body', speed_m_s: 0.1 + 2.9 * random(), position: Math.floor(3 * random()), actuator: 0, ...SURFACES[0].blow });
    if (random() < 0.002) tell(t, { event: 'end', contact: 1 + Math.floor(random() * name) });
    if (!isCalm && random() < 0.01) for (const [contact, { uv, force }] of fingers) tell(t - 0.5 * random() ** 3, { event: 'move', contact, uv, normal_force_n: force });
    hear(engine, block);
  }
  stalls = 0;
  for (const contact of fingers.keys()) tell(2000, { event: 'end', contact });
}

/** A mouse that strokes in straight lines, bends, rests and leaps, as the page's hand tells it: places in whole pixels, speeds from the last of them. */
export function mouse(engine, seed, seconds) {
  const random = seeded(seed);
  const { size_m } = SURFACES[0];
  const waiting = [];
  const hand = Object.assign(Object.create(Hand.prototype), {
    fingers: new Map(), contacts: 0, pixelsAMetre: PIXELS_A_METRE, show() {},
    page: {
      force: () => 1,
      place: (at) => ({ uv: at.map((x, axis) => x / (size_m[axis] * PIXELS_A_METRE)) }),
      report: (events) => waiting.push(...events),
    },
  });
  let at = [500, 300];
  let way = [0, 0];
  let next = 1000 + 0.02 * random();
  let [isDown, isStraight] = [false, true];
  const frame_s = random() < 0.5 ? 0.0167 : 0.008;
  for (let block = 0; block < (seconds * RATE_HZ) / BLOCK; block++) {
    const clock = 1000 + (block * BLOCK) / RATE_HZ;
    while (next <= clock) {
      if (!isDown) { hand.land('mouse', at.map(Math.round), next); isDown = true; }
      else if (random() < 0.006) { hand.lift('mouse', next); isDown = false; }
      else hand.slide(hand.fingers.get('mouse'), at.map(Math.round), next);
      if (random() < 0.04) {
        way = random() < 0.2 ? [0, 0] : [1500 * (random() - 0.5), 1500 * (random() - 0.5)];
        // Keys, and hands that follow an edge, go along one axis.
        if (random() < 0.4) way[Math.floor(2 * random())] = 0;
        isStraight = random() < 0.6;
      } else if (!isStraight) way = way.map((speed) => speed + 40 * (random() - 0.5));
      const step = frame_s * (random() < 0.1 ? 3 * random() : 0.9 + 0.2 * random());
      // A page that is busy hears nothing for a while; meanwhile the finger has gone on, or not.
      const stalls = random() < 0.02;
      if (!stalls || random() < 0.5) at = at.map((x, axis) => x + way[axis] * step);
      next += step + (stalls ? 0.6 * random() : 0);
    }
    for (const event of waiting.splice(0)) report(engine, event.t, event);
    hear(engine, block);
  }
  if (isDown) hand.lift('mouse', 1000 + seconds);
  for (const event of waiting) report(engine, event.t, event);
  for (let block = 0; block < 40; block++) engine.render(BLOCK);
}

/** One visitor: a mouse, or anything. */
export const visit = (engine, seed, seconds) => (seed % MICE === 0 ? mouse : play)(engine, seed, seconds);

/** What a page may say wrongly, and every button. */
export function trouble(engine) {
  const good = { event: 'begin', contact: 1e6, surface: 'surface', actuator: 0, uv: [0, 0], normal_force_n: 1 };
  const blow = { event: 'impact', body: 'body', speed_m_s: 1 };
  for (const event of [
    { ...good, event: 'dance' }, { ...good, normal_force_n: NaN }, { ...good, normal_force_n: -3 }, { ...good, normal_force_n: 1e12 }, { ...good, uv: [NaN, 0] },
    { ...good, uv: [1e300, 0] }, { ...good, contact: -1 }, { ...good, actuator: 9 }, { ...good, closing_m_s: -1 }, { ...blow, speed_m_s: 1e9 },
    { ...blow, mass_kg: -1 }, { ...blow, radius_m: 0 }, { ...blow, restitution: 7 }, { ...blow, position: 99 }, { event: 'move', contact: 123456, uv: [0, 0], normal_force_n: 1 },
  ]) {
    for (const t of [1500, NaN]) report(engine, t, event);
  }
  for (const what of ['mute', 'pause', 'resume', 'audioGain', 'hapticGain', 'timeScale', 'fadeAll']) {
    for (const value of [1, 0, NaN]) {
      try { engine.do(what, value); } catch (error) { if (error instanceof WebAssembly.RuntimeError) throw error; }
      for (let block = 0; block < 40; block++) engine.render(BLOCK);
    }
    try { engine.do('timeScale', 1); } catch { /* It was refused before as well. */ }
  }
}
