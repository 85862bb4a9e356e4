// The page: puts surface, hand, engine, strips, files and buttons together.
import { createEngine, load, parseLog } from './asperity.js';
import { Feel } from './feel.js';
import { Hand } from './hand.js';
import { PIXELS_A_METRE, Picture, RELIEF_TEXELS, lookOf, thumbnail } from './look.js';
import { fractal } from './pictures.js';
import { Strips, length } from './strips.js';
import { LEVELS_HZ, RATE_HZ, SURFACES, sceneOf } from './surfaces.js';

const $ = (id) => document.getElementById(id);
/** The offline tools, for what visitors bring. */
const TOOLS = String(new URL('./tools.wasm', import.meta.url));
/** The solver of meshes. */
const SHAPE = String(new URL('./shape.wasm', import.meta.url));
/** Who has not struck anything after so much sound is told how, frames. */
const HINTED_AFTER = 300;
/** A take longer than this begins anew when no finger touches, lines of its log. */
const LONGEST_TAKE = 20000;

const asked = new Map();
function helper() {
  const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
  worker.onmessage = ({ data: { id, answer, error } }) => {
    const { resolve, reject } = asked.get(id);
    asked.delete(id);
    if (error === undefined) resolve(answer);
    else reject(new Error(error));
  };
  return worker;
}
const worker = helper();

/** Lets the worker make or render something, with the engine if nothing else is said; what takes seconds has another one. */
async function ask(work, wasm) {
  const { module } = await load(wasm);
  const id = (ask.count = (ask.count ?? 0) + 1);
  const who = wasm === TOOLS || wasm === SHAPE ? (ask.slow ??= helper()) : worker;
  who.postMessage({ id, module, ...work });
  return new Promise((resolve, reject) => asked.set(id, { resolve, reject }));
}

const picture = new Picture($('surface'));
const strips = new Strips($('strips'));
const feel = new Feel($('feel'));
const state = { surface: null, engine: null, context: null, muted: false, tool: 'stroke', modes: undefined, frames: 0, speed: 0, force: 0, struck: false };
let spectrum = new Float32Array(2048).fill(-200);

/** Says something, for eyes and for screen readers, as long as it takes to read; an empty sentence goes. */
function say(sentence, seconds = Math.max(6, sentence.length / 12)) {
  $('status').textContent = sentence;
  clearTimeout(say.timer);
  say.timer = setTimeout(() => { $('status').textContent = ''; }, seconds * 1000);
}

// ---- Surfaces ----

/** What the engine is made of for a surface, made by the worker. */
function make(surface, modes) {
  const { text, pictures, files } = sceneOf(surface, surface.id, modes);
  const relief = surface.draw ? 0 : RELIEF_TEXELS;
  return ask({ make: { scene: text, pictures, files, rate: RATE_HZ, levels: LEVELS_HZ, relief, watch: surface.watch ? 'surface' : null } });
}

/** Another surface: under the fingers without a click. */
async function choose(surface, modes) {
  const turn = (choose.turn = (choose.turn ?? 0) + 1);
  if (surface.isSolid) modes ??= surface.modes ?? await solve(surface);
  if (turn !== choose.turn) return;
  const prepared = await make(surface, modes);
  if (turn !== choose.turn) return;
  hand.release();
  const isNew = state.surface !== surface;
  [state.surface, state.modes, state.relief] = [surface, modes, prepared.relief];
  if (isNew) await body(surface, modes);
  if (isNew || surface.watch) picture.show(lookOf(surface, surface.watch ? flat(prepared) : prepared.relief));
  $('note').textContent = surface.note;
  $('surface').setAttribute('aria-label', `Surface: ${surface.name}. Arrow keys stroke, Space hits.`);
  for (const button of $('surfaces').children) button.setAttribute('aria-pressed', String(button.dataset.id === surface.id));
  if (state.engine) await state.engine.take({ prepared });
  else state.prepared = prepared;
  $('surfaces').dataset.ready = surface.id;
}

/** Solves the bowl, once; the sentence about it goes when it rings. */
async function solve(surface) {
  say('The bowl is being solved from its mesh …', 60);
  const { bowl, solved } = await import('./solid.js');
  const { modes, found } = await solved((work) => ask(work, SHAPE), 'bowl.obj', new TextEncoder().encode(bowl()));
  surface.modes = modes;
  say(`The bowl is solved: ${found}. Hit it in different places.`, 10);
  return modes;
}

/** A body is seen and hit where it is; other surfaces fill the window. */
async function body(surface, modes) {
  state.solid?.hide();
  if (surface.isSolid) {
    const { Solid } = await import('./solid.js');
    solid ??= new Solid(picture, scaled);
    solid.show(modes);
  }
  state.solid = surface.isSolid ? solid : null;
  if (!state.solid) scaled(PIXELS_A_METRE);
}
let solid;

/** So large is what is shown, CSS pixels a metre. */
function scaled(pixels) {
  hand.pixelsAMetre = pixels;
  const bar = $('scale').firstElementChild;
  const long_m = pixels < 4000 ? 0.05 : 0.01;
  bar.textContent = length(long_m);
  bar.style.width = `${long_m * pixels}px`;
}

/** A bed of sand before anything has touched it. */
function flat({ picture: { columns, rows } }) {
  return { width: columns, height: rows, heights: new Float32Array(columns * rows) };
}

/** Some ground for the button of a surface whose own heights only the engine knows. */
function stand() {
  const side = 64;
  const height = (_, i) => 1e-3 * fractal((i % side) / side, Math.floor(i / side) / side, [6, 6], 3, 9);
  return { width: side, height: side, heights: Float32Array.from({ length: side * side }, height) };
}

function button(surface) {
  const button = document.createElement('button');
  Object.assign(button, { type: 'button', textContent: surface.name, title: surface.note });
  button.dataset.id = surface.id;
  button.setAttribute('aria-pressed', 'false');
  const canvas = document.createElement('canvas');
  canvas.setAttribute('aria-hidden', 'true');
  button.prepend(canvas);
  button.addEventListener('click', () => choose(surface).catch(refuse));
  $('surfaces').append(button);
  // Drawn when nothing else is to do.
  const draw = () => thumbnail(canvas, lookOf(surface.icon ?? surface, surface.draw ? null : stand()));
  (window.requestIdleCallback ?? setTimeout)(draw);
  return button;
}

// ---- Sound ----

/** Sound begins with the first touch, as browsers want it. */
async function begin() {
  const context = new AudioContext({ sampleRate: RATE_HZ, latencyHint: 'interactive' });
  state.context = context;
  context.onstatechange = () => { if (context.state === 'interrupted') say('The sound was interrupted; touch to go on.'); };
  const { prepared } = state.prepared ? state : { prepared: await make(state.surface) };
  const engine = await createEngine(context, { prepared });
  state.prepared = null;
  const volume = new GainNode(context);
  const analyser = new AnalyserNode(context, { fftSize: 4096, smoothingTimeConstant: 0.2 });
  engine.connect(volume).connect(analyser);
  volume.connect(context.destination);
  spectrum = new Float32Array(analyser.frequencyBinCount);
  Object.assign(state, { volume, analyser });
  engine.addEventListener('frame', ({ detail }) => frame(detail));
  engine.addEventListener('refused', ({ detail }) => say(`Not played: ${detail.refused}`));
  engine.addEventListener('error', ({ detail }) => refuse(detail));
  engine.addEventListener('heard', ({ detail }) => { state.latency_ms = detail.at - detail.heard; });
  feel.listen(engine);
  feel.tell(context);
  $('wide').disabled = context.destination.maxChannelCount < 4;
  mute(state.muted);
  await context.resume();
  state.engine = engine;
  hand.again();
  replay().catch(refuse);
}

/** The stroke that came with the link, once. */
async function replay() {
  const { stroke } = state;
  state.stroke = undefined;
  if (!stroke) return;
  const { play, unpack } = await import('./link.js');
  const events = (await unpack(stroke)).map((event) => {
    if (event.event === 'impact') return { ...event, body: 'body', ...state.surface.blow };
    return event.event === 'begin' ? { ...event, surface: 'surface', actuator: 0 } : event;
  });
  say('This is the stroke that came with the link.');
  await play(events, (event) => state.engine.node.port.postMessage({ do: 'events', events: [event] }));
}

function touched() {
  $('hint').classList.add('gone');
  $('more').open = false;
  if (!state.context) begin().catch(refuse);
  else if (state.context.state !== 'running') state.context.resume().catch(() => {});
}

/** What the audio thread tells 60 times a second. */
function frame({ rows, levels, tiles }) {
  state.analyser?.getFloatFrequencyData(spectrum);
  strips.add(rows, spectrum, RATE_HZ, state.surface.wavelength_m);
  if (!state.muted) feel.feel(levels);
  if (tiles && state.surface.watch) picture.change(tiles);
  const last = rows.length - 16;
  [state.speed, state.force, state.touching] = last >= 0 ? [Math.hypot(rows[last + 7], rows[last + 8]), rows[last + 9], rows[last] > 0] : [0, 0, false];
  state.frames++;
  if (state.frames === HINTED_AFTER && !state.struck) {
    $('hint').textContent = 'now tap it';
    $('hint').className = 'tap';
  }
}

function readout() {
  const { speed, surface, touching } = state;
  const wave = surface?.wavelength_m;
  const hz = touching && wave && speed > 0.005 ? ` · ${(speed / wave).toFixed(speed < 10 * wave ? 1 : 0)} ridges/s` : '';
  $('readout').textContent = touching ? `${Math.round(speed * 1000)} mm/s · ${state.force.toFixed(1)} N${hz}` : '';
}

function mute(muted) {
  state.muted = muted;
  $('mute').setAttribute('aria-pressed', String(muted));
  $('mute').textContent = muted ? 'Muted' : 'Mute';
  state.volume?.gain.setTargetAtTime(muted ? 0 : 1, state.context.currentTime, 0.01);
}

/** The waveform itself on channels 3 and 4, for a device that has them. */
function wide(on) {
  const { context, engine, volume } = state;
  if (!context) return;
  volume.disconnect();
  engine.node.disconnect();
  engine.connect(volume).connect(state.analyser);
  feel.listen(engine);
  context.destination.channelCount = on ? 4 : 2;
  if (!on) { volume.connect(context.destination); return; }
  const [split, merge] = [new ChannelSplitterNode(context, { numberOfOutputs: 2 }), new ChannelMergerNode(context, { numberOfInputs: 4 })];
  volume.connect(split);
  for (const side of [0, 1]) split.connect(merge, side, side);
  for (const side of [2, 3]) engine.node.connect(merge, 1, side);
  merge.connect(context.destination);
}

// ---- The hand ----

const waiting = [];
const hand = new Hand($('surface'), {
  picture,
  touched,
  place: (at) => state.solid?.place(at) ?? { uv: picture.uvOf(at) },
  turns: (at) => state.solid?.hit(at) === null,
  turn: (x, y) => state.solid?.turn(x, y),
  force: () => Number($('force').value),
  blow: () => Number($('blow').value),
  tool: () => state.tool,
  press,
  report(events, stamp) {
    if (!state.engine) { waiting.push(...events); return; }
    state.engine.node.port.postMessage({ do: 'events', events, stamp });
    cut();
  },
  strike([x, y], speed_m_s) {
    // A body without shapes has three places.
    const { on = true, at_m } = this.place([x, y]);
    if (!on) return;
    state.struck = true;
    const where = at_m ? { at_m } : { position: Math.floor((x + y) / 90) % 3 };
    const blow = state.surface.blow ?? { striker: 'wood', mass_kg: 0.02, radius_m: 0.012, restitution: 0.3 };
    this.report([{ t: performance.now() / 1000, event: 'impact', body: 'body', speed_m_s, ...where, actuator: 0, ...blow }], Date.now());
    picture.touches.set('blow', [x, y, 34]);
    picture.dirty = true;
    setTimeout(() => { picture.touches.delete('blow'); picture.dirty = true; }, 120);
  },
}, PIXELS_A_METRE);

/** What was reported before there was sound: fingers that still touch land now, blows strike now. */
hand.again = () => {
  const t = performance.now() / 1000;
  const blows = waiting.splice(0).filter((event) => event.event === 'impact').slice(-1);
  const lands = [...hand.fingers.values()].map((finger) => {
    // What a busy page hears of it later and was before, was before it landed.
    finger.t = t;
    return { event: 'begin', contact: finger.contact, surface: 'surface', actuator: 0, closing_m_s: 0.04, ...hand.sample(finger, t) };
  });
  if (blows.length + lands.length > 0) state.engine.report(...[...blows, ...lands].map((event) => ({ ...event, t })));
};

/** A take that has grown long begins anew once nothing touches. */
function cut() {
  if (state.cutting || hand.fingers.size > 0 || state.engine.lines.length < LONGEST_TAKE / 30) return;
  state.cutting = true;
  choose(state.surface, state.modes).catch(refuse).finally(() => { state.cutting = false; });
}

function press(step) {
  $('force').value = Number($('force').value) + step;
  show();
}

function tool(name) {
  state.tool = name;
  for (const id of ['stroke', 'hit']) $(id).setAttribute('aria-pressed', String(id === name));
}

function show() {
  $('force-out').textContent = `${Number($('force').value).toFixed(1)} N`;
  $('blow-out').textContent = `${Number($('blow').value).toFixed(1)} m/s`;
}

// ---- Files and links ----

/** A sentence about what went wrong; the engine goes on. */
function refuse(error) {
  say(error.message, 12);
}

async function save() {
  if (!state.engine) throw new Error('Nothing was played yet: stroke the surface, then save.');
  const name = `asperity-${state.surface.id}`;
  const log = await state.engine.log();
  if (log === '') throw new Error('Nothing was played yet: stroke the surface, then save.');
  const { text, pictures, files } = sceneOf(state.surface, name, state.modes);
  const { audio, haptic } = await ask({ render: { scene: text, log, pictures, files } });
  const { archive, download } = await import('./save.js');
  download(await archive(name, { scene: text, log, pictures, files, audio, haptic }), `${name}.zip`);
  say('Saved: the WAV, and the contact log and scene that make it again.');
}

async function link() {
  const words = new URLSearchParams({ s: state.surface.id, force: $('force').value, blow: $('blow').value, tool: state.tool });
  // Places on a body are not in a link.
  const stroke = state.engine && !state.solid ? await (await import('./link.js')).pack(parseLog(await state.engine.log())) : '';
  if (stroke !== '') words.set('stroke', stroke);
  return `${location.origin}${location.pathname}#${words}`;
}

async function share() {
  if (state.surface.isOwn || (state.modes !== undefined && !state.solid)) throw new Error('What you brought yourself is not in a link: save it instead.');
  const made = await link();
  history.replaceState(null, '', made);
  const what = made.includes('stroke=') ? 'The link, with your last strokes in it,' : 'The link';
  try {
    await navigator.clipboard.writeText(made);
    say(`${what} is copied.`);
  } catch {
    say(`${what} is in the address bar: copy it from there.`);
  }
}

/** What a link says; what it says wrongly is told and left out. */
function opened() {
  const words = new URLSearchParams(location.hash.slice(1, 8000));
  const wrong = [];
  for (const [key, value] of words) {
    if (key === 's') { if (!SURFACES.some(({ id }) => id === value)) wrong.push(`surface “${value.slice(0, 30)}” is unknown`); }
    else if (key === 'force' || key === 'blow') {
      const { min, max } = $(key);
      const number = Number(value);
      if (value !== '' && number >= Number(min) && number <= Number(max)) $(key).value = value;
      else wrong.push(`${key} “${value.slice(0, 30)}” must be ${min} to ${max}`);
    } else if (key === 'stroke') state.stroke = value;
    else if (key === 'tool') { if (value === 'hit' || value === 'stroke') tool(value); else wrong.push(`tool “${value.slice(0, 30)}” must be stroke or hit`); }
    else wrong.push(`“${key.slice(0, 30)}” is unknown`);
  }
  if (wrong.length > 0) say(`In the link: ${wrong.slice(0, 3).join('; ')}.`, 12);
  show();
  return SURFACES.find(({ id }) => id === words.get('s')) ?? SURFACES[0];
}

/** A picture becomes a surface, a recorded hit or a file of modes the body. */
async function take(file) {
  say(`${file.name} is looked at …`, 60);
  const own = await import('./own.js');
  await wear(await own.bring(file, { isMap: $('map').checked, ask: (work) => ask(work, TOOLS), askShape: (work) => ask(work, SHAPE) }));
}

async function listen() {
  const own = await import('./own.js');
  await wear(await own.listen((work) => ask(work, TOOLS), say));
}

async function wear({ surface, modes, sentence }) {
  if (surface) {
    [...$('surfaces').children].find((child) => child.dataset.id === 'own')?.remove();
    button(surface).scrollIntoView({ block: 'nearest' });
  }
  // A recorded hit has no shape to be seen.
  await choose(surface ?? (state.solid ? SURFACES[0] : state.surface), modes);
  say(sentence);
}

// ---- The rest ----

function keys(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target instanceof HTMLInputElement) return;
  if (/^\d$/.test(event.key)) { const at = (Number(event.key) + 9) % 10; if (SURFACES[at]) choose(SURFACES[at]).catch(refuse); }
  else if (event.key === '+' || event.key === '=') press(0.1);
  else if (event.key === '-') press(-0.1);
  else if (event.key === 'm' || event.key === 'M') mute(!state.muted);
  else if (event.key === 'Escape') $('more').open = false;
}

function paint() {
  state.solid?.draw();
  picture.draw();
  strips.draw();
  readout();
  requestAnimationFrame(paint);
}

$('mute').addEventListener('click', () => mute(!state.muted));
$('stroke').addEventListener('click', () => tool('stroke'));
$('hit').addEventListener('click', () => tool('hit'));
$('save').addEventListener('click', () => save().catch(refuse));
$('share').addEventListener('click', () => share().catch(refuse));
$('own').addEventListener('click', () => $('file').click());
$('listen').addEventListener('click', () => listen().catch(refuse));
$('file').addEventListener('change', () => { const [file] = $('file').files; $('file').value = ''; if (file) take(file).catch(refuse); });
$('wide').addEventListener('change', () => wide($('wide').checked));
for (const id of ['force', 'blow']) $(id).addEventListener('input', show);
addEventListener('keydown', keys);
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => { event.preventDefault(); const [file] = event.dataTransfer.files; if (file) take(file).catch(refuse); });
addEventListener('hashchange', () => choose(opened()).catch(refuse));
navigator.mediaDevices?.addEventListener?.('devicechange', () => state.context && feel.tell(state.context));
new ResizeObserver(() => { picture.dirty = true; if (picture.look && !picture.gl) picture.showFlat(picture.look); }).observe($('surface'));
scaled(PIXELS_A_METRE);

SURFACES.forEach(button);
choose(opened()).then(() => { if (state.stroke) say('A stroke came with this link: touch to hear it.', 30); }).catch(refuse);
paint();
// For whoever looks inside, and for the tests.
window.asperity = { state, choose, hand, picture, strips, surfaces: SURFACES };
