// A stroke in a link: the contact log of the last seconds, as few letters as that takes.
//
// Whole numbers, each as its difference from the one before, in bytes of seven bits; then deflate, then base64url. What a link says is a little
// coarser than what was played (0.1 ms, 1e-5 of the surface, 0.01 N), and the same for everybody who opens it.

const KINDS = ['begin', 'move', 'end', 'impact'];
/** Steps of time, place, velocity, force and speed that a link tells apart. */
const STEP = { t: 1e-4, uv: 1e-5, velocity_m_s: 1e-4, normal_force_n: 0.01, speed_m_s: 0.01 };
/** Moves of a finger closer together say nothing that can be heard, s. */
const APART_S = 0.012;
const MOST_EVENTS = 6000;
const LONGEST_S = 60;
/** Letters of a stroke: what chats and browsers still take as a link. */
export const MOST_LETTERS = 7000;

const ints = (value, step, count) => (Array.isArray(value) ? value : [value ?? 0]).slice(0, count).map((x) => Math.round(x / step));

/** An event as whole numbers; the first two are its kind and the finger. */
function row(event, t0) {
  return [
    KINDS.indexOf(event.event), event.contact ?? 0, ...ints(event.t - t0, STEP.t, 1), ...ints(event.uv ?? [0, 0], STEP.uv, 2),
    ...ints(event.velocity_m_s ?? [0, 0], STEP.velocity_m_s, 2), ...ints(event.normal_force_n, STEP.normal_force_n, 1), ...ints(event.speed_m_s, STEP.speed_m_s, 1),
  ];
}

async function through(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

async function packed(events) {
  const bytes = [];
  const before = new Map();
  for (const event of events) {
    const numbers = row(event, events[0].t);
    const [kind, contact] = numbers;
    const last = before.get(contact) ?? Array(numbers.length).fill(0);
    bytes.push(kind);
    numbers.slice(1).forEach((number, i) => {
      const base = i === 0 ? 0 : i === 1 ? before.time ?? 0 : last[i + 1];
      // Zigzag: small differences of either sign are small numbers.
      let rest = (number - base) * 2;
      if (rest < 0) rest = -rest - 1;
      for (; rest >= 128; rest = Math.floor(rest / 128)) bytes.push((rest % 128) | 128);
      bytes.push(rest);
    });
    before.set(contact, numbers);
    before.time = numbers[2];
  }
  const small = await through(Uint8Array.from(bytes), new CompressionStream('deflate-raw'));
  return btoa(String.fromCharCode(...small)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** Names every stroke of a finger anew, and leaves out moves on each other's heels. */
function thinned(events) {
  const [names, last] = [new Map(), new Map()];
  return events.flatMap((event) => {
    if (event.event === 'impact') return [event];
    if (event.event === 'begin') names.set(event.contact, names.size + 1);
    const contact = names.get(event.contact);
    if (contact === undefined) return [];
    if (event.event === 'move' && event.t - last.get(event.contact) < APART_S) return [];
    last.set(event.contact, event.t);
    return [{ ...event, contact }];
  });
}

/** The stroke of a contact log's last seconds, as many as a link holds; empty where nothing was played. */
export async function pack(lines) {
  const known = lines.filter(({ event }) => KINDS.includes(event));
  for (let from = Math.max(0, known.findIndex(({ t }) => t >= (known.at(-1)?.t ?? 0) - LONGEST_S)); from < known.length;) {
    const events = thinned(known.slice(from)).slice(-MOST_EVENTS);
    if (events.length === 0) return '';
    const text = await packed(thinned(events));
    if (text.length <= MOST_LETTERS) return text;
    from += Math.max(1, Math.ceil((known.length - from) * (1 - MOST_LETTERS / text.length)));
  }
  return '';
}

/** Events of a stroke, `t` from 0; what is none is refused in words. */
export async function unpack(text) {
  const wrong = (why) => new Error(`the stroke in the link ${why}`);
  if (text.length > MOST_LETTERS || !/^[\w-]*$/.test(text)) throw wrong('is none');
  let bytes;
  try {
    const small = Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
    bytes = await through(small, new DecompressionStream('deflate-raw'));
  } catch {
    throw wrong('is cut off or changed');
  }
  const events = [];
  const before = new Map();
  const touching = new Set();
  for (let at = 0, time = 0; at < bytes.length;) {
    const kind = KINDS[bytes[at++]];
    const numbers = [0];
    for (let i = 0; i < 8; i++) {
      let [rest, factor] = [0, 1];
      for (;; factor *= 128) {
        const byte = bytes[at++];
        if (byte === undefined || factor > 2 ** 40) throw wrong('is cut off or changed');
        rest += (byte & 127) * factor;
        if (byte < 128) break;
      }
      const base = i === 0 ? 0 : i === 1 ? time : (before.get(numbers[1])?.[i + 1] ?? 0);
      numbers.push(base + (rest % 2 === 1 ? -(rest + 1) / 2 : rest / 2));
    }
    const [, contact, t, u, v, x, y, force, speed] = numbers;
    before.set(contact, numbers);
    const event = { t: t * STEP.t, event: kind };
    const isSound = kind !== undefined && t >= time && event.t <= LONGEST_S && contact >= 0 && contact <= MOST_EVENTS && Math.abs(u) < 1e9 && Math.abs(v) < 1e9
      && Math.hypot(x, y) < 1e6 && force >= 0 && force <= 2000 && speed >= 0 && speed <= 1000 && events.length < MOST_EVENTS;
    if (!isSound) throw wrong('says what no hand does');
    time = t;
    if (kind === 'impact') events.push({ ...event, speed_m_s: speed * STEP.speed_m_s });
    else {
      if (kind === 'begin') touching.add(contact);
      else if (!touching.has(contact)) throw wrong('moves a finger that does not touch');
      if (kind === 'end') { touching.delete(contact); events.push({ ...event, contact }); } else {
        // Where none is said, the places tell it.
        const velocity = x === 0 && y === 0 ? {} : { velocity_m_s: [x * STEP.velocity_m_s, y * STEP.velocity_m_s] };
        events.push({ ...event, contact, uv: [u * STEP.uv, v * STEP.uv], ...velocity, normal_force_n: force * STEP.normal_force_n });
      }
    }
  }
  for (const contact of touching) events.push({ t: events.at(-1).t, event: 'end', contact });
  return events;
}

/**
 * Plays a stroke by hand: `report(event)` gets every event a little before it is due, with times of the page's clock and names that no finger
 * has. Tells when it is over.
 */
export function play(events, report) {
  const began = performance.now() / 1000 + 0.08;
  const first = 5e6 + Math.floor(performance.now());
  let next = 0;
  return new Promise((resolve) => {
    const timer = setInterval(() => {
      const now = performance.now() / 1000;
      while (next < events.length && began + events[next].t < now + 0.05) {
        const { contact, ...event } = events[next++];
        report({ ...event, ...(contact === undefined ? {} : { contact: first + contact }), t: began + event.t });
      }
      if (next < events.length) return;
      clearInterval(timer);
      resolve();
    }, 10);
  });
}
