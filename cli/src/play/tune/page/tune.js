// The panel of `asperity play SCENE.toml --tune`: turns the numbers of a scene that sounds, and touches it.

const $ = (id) => document.getElementById(id);
/** Reports of a finger are sent so often, ms. */
const SENT_MS = 12;
const RESTING_MS = 60;
const FORCE_N = 0.6;
const STEPS = 1000;
const CHANGES = { sounding: 'while it sounds', anew: 'while it sounds; begins anew', opened: 'when the scene is opened again' };

let state = null;
let surface = 0;
let showsMissing = false;

function say(sentence, seconds = 8) {
  $('status').textContent = sentence;
  clearTimeout(say.timer);
  say.timer = setTimeout(() => { $('status').textContent = ''; }, seconds * 1000);
}

async function ask(path, body) {
  const response = await fetch(path, body === undefined ? {} : { method: 'POST', body: typeof body === 'string' ? body : JSON.stringify(body) });
  const answer = await response.json();
  if (answer.error !== undefined) throw new Error(answer.error.replace(/^error: /, ''));
  return answer;
}

// ---- Numbers ----

const nameOf = ({ path, key }) => `${path}/${key}`;
/** What a slider spans: around what there is, within what is accepted. */
function span(setting) {
  const { low, high, value, default: usual, whole } = setting;
  const now = value[0] ?? usual ?? 0;
  if (whole && high - low <= STEPS) return { low, high, log: false };
  if (low >= 0 && now > 0 && high / Math.max(low, now / 100) > 50) return { low: Math.max(low, now / 100), high: Math.min(high, now * 100), log: true };
  return { low, high: Math.min(high, Math.max(1, 10 * Math.abs(now))), log: false };
}

const round = (x) => Number(x.toPrecision(4));

function row(setting) {
  const row = document.createElement('div');
  row.className = `setting${setting.value.length === 0 ? ' missing' : ''}`;
  row.dataset.name = nameOf(setting);
  const id = `s-${setting.path}-${setting.key}`.replaceAll('.', '-');
  const label = Object.assign(document.createElement('label'), { htmlFor: `${id}-0`, textContent: setting.key });
  row.append(label);
  const shown = setting.value.length > 0 ? setting.value : Array(setting.components).fill(setting.default);
  const numbers = shown.map((value, i) => {
    const input = Object.assign(document.createElement('input'), { type: 'number', id: `${id}-${i}`, step: 'any', value: value ?? '', placeholder: 'not set' });
    input.setAttribute('aria-label', `${setting.place}: ${setting.key}${setting.components > 1 ? ` ${i + 1}` : ''}${setting.unit ? `, ${setting.unit}` : ''}`);
    input.setAttribute('aria-describedby', `${id}-about`);
    input.addEventListener('change', () => turn(setting, numbers.map((each) => Number(each.value))));
    return input;
  });
  if (setting.components === 1) {
    const reach = span(setting);
    const place = (x) => Math.round(STEPS * (reach.log ? Math.log(x / reach.low) / Math.log(reach.high / reach.low) : (x - reach.low) / (reach.high - reach.low)));
    const slider = Object.assign(document.createElement('input'), { type: 'range', min: 0, max: STEPS, value: shown[0] === null ? 0 : place(shown[0]) });
    slider.setAttribute('aria-label', `${setting.place}: ${setting.key}, slider`);
    slider.addEventListener('input', () => {
      const share = Number(slider.value) / STEPS;
      const x = round(reach.log ? reach.low * (reach.high / reach.low) ** share : reach.low + (reach.high - reach.low) * share);
      numbers[0].value = setting.whole ? Math.round(x) : x;
      turn(setting, [Number(numbers[0].value)]);
    });
    row.append(slider, numbers[0]);
    row.place = (value) => { if (value !== null) slider.value = place(value); };
  } else {
    const vector = document.createElement('div');
    vector.className = 'vector';
    vector.append(...numbers);
    row.append(vector);
  }
  const unit = Object.assign(document.createElement('span'), { className: 'unit', textContent: setting.unit });
  const out = Object.assign(document.createElement('button'), { type: 'button', textContent: '×', title: 'Take it out of the file: its default counts' });
  out.setAttribute('aria-label', `Take ${setting.key} of ${setting.place} out of the file`);
  out.addEventListener('click', () => turn(setting, []));
  const usual = setting.default === null ? '' : ` Default ${setting.default}${setting.source ? ` (${setting.source})` : ''}.`;
  const about = Object.assign(document.createElement('p'), { id: `${id}-about`, textContent: `${setting.meaning}: ${setting.range}.${usual} Changes ${CHANGES[setting.changes]}.` });
  row.append(unit, out, about);
  row.numbers = numbers;
  return row;
}

/** One request at a time, and of what is turned meanwhile only the newest. */
const turning = new Map();
let isTurning = false;
function turn(setting, value) {
  if (value.some((x) => !Number.isFinite(x))) { say(`${setting.key}: must be ${setting.range}`); return; }
  turning.set(nameOf(setting), { path: setting.path, key: setting.key, value });
  if (!isTurning) send();
}

async function send() {
  isTurning = true;
  while (turning.size > 0) {
    const [[name, change]] = turning;
    turning.delete(name);
    try {
      show(await ask('set', change));
    } catch (error) {
      say(error.message);
      show(await ask('state'), true);
    }
  }
  isTurning = false;
}

/** Shows a state; rows stay what they are unless other numbers are there. */
function show(next, anew = false) {
  const names = (all) => all?.settings.map((setting) => nameOf(setting) + (setting.value.length > 0)).join();
  const first = state === null;
  const differs = anew || names(state) !== names(next);
  const was = state;
  state = next;
  if (differs) rows();
  else {
    for (const setting of next.settings) {
      const row = document.querySelector(`[data-name="${CSS.escape(nameOf(setting))}"]`);
      const old = was.settings.find((each) => nameOf(each) === nameOf(setting));
      if (row && String(old.value) !== String(setting.value)) row.numbers.forEach((input, i) => { if (document.activeElement !== input) input.value = setting.value[i]; });
    }
  }
  $('scene').textContent = `${next.scene}${next.changed ? ' •' : ''}`;
  document.title = `${next.changed ? '• ' : ''}${next.scene}: tune`;
  $('keep').disabled = !next.changed;
  $('log').hidden = !next.has_log;
  $('log').setAttribute('aria-pressed', String(next.plays));
  $('heard').textContent = `${next.heard}${next.why_silent.length > 0 ? `; ${next.why_silent.join('; ')}` : ''}`;
  $('said').textContent = next.said.join('; ');
  if (first || was.surfaces.map(({ name }) => name).join() !== next.surfaces.map(({ name }) => name).join()) tiles();
}

function rows() {
  const focused = document.activeElement?.id;
  const shown = state.settings.filter(({ value }) => showsMissing || value.length > 0);
  const places = [...new Set(shown.map(({ place }) => place))];
  $('settings').replaceChildren(...places.map((place) => {
    const set = document.createElement('fieldset');
    set.append(Object.assign(document.createElement('legend'), { textContent: place }), ...shown.filter((each) => each.place === place).map(row));
    return set;
  }));
  for (const each of document.querySelectorAll('.setting:not(.missing)')) each.classList.add('changed');
  if (focused) document.getElementById(focused)?.focus();
}

function tiles() {
  $('surfaces').replaceChildren(...state.surfaces.map(({ name }, index) => {
    const tile = Object.assign(document.createElement('button'), { type: 'button', textContent: name });
    tile.setAttribute('aria-pressed', String(index === surface));
    tile.addEventListener('click', () => { surface = index; tiles(); });
    return tile;
  }));
}

// ---- Touch ----

const fingers = new Map();
const waiting = [];
let contacts = 0;
let isSending = false;

async function flush() {
  if (isSending || waiting.length === 0) return;
  isSending = true;
  const lines = waiting.splice(0);
  try {
    await ask('touch', lines.map((line) => JSON.stringify(line)).join('\n'));
  } catch (error) {
    say(error.message);
  }
  isSending = false;
}

function report(event) {
  const t = Math.max(performance.now() / 1000, report.last ?? 0);
  report.last = t;
  waiting.push({ t, ...event });
}

function place(event) {
  const { left, top, width, height } = $('pad').getBoundingClientRect();
  return [(event.clientX - left) / width, (event.clientY - top) / height];
}

const force = (event) => (event.pointerType === 'pen' && event.pressure > 0 ? 3 * event.pressure : FORCE_N);

$('pad').addEventListener('pointerdown', (event) => {
  if (event.button > 0 || !state?.surfaces[surface]) return;
  $('pad').setPointerCapture(event.pointerId);
  const finger = { contact: 1_000_000 + ++contacts, uv: place(event), force: force(event), told: performance.now() };
  fingers.set(event.pointerId, finger);
  report({ event: 'begin', contact: finger.contact, surface: state.surfaces[surface].name, actuator: state.actuators > 0 ? 0 : undefined, uv: finger.uv, normal_force_n: finger.force });
});
$('pad').addEventListener('pointermove', (event) => {
  const finger = fingers.get(event.pointerId);
  if (!finger || performance.now() - finger.told < SENT_MS) return;
  [finger.uv, finger.force, finger.told] = [place(event), force(event), performance.now()];
  report({ event: 'move', contact: finger.contact, uv: finger.uv, normal_force_n: finger.force });
});
for (const name of ['pointerup', 'pointercancel']) {
  $('pad').addEventListener(name, (event) => {
    const finger = fingers.get(event.pointerId);
    fingers.delete(event.pointerId);
    if (finger) report({ event: 'end', contact: finger.contact });
  });
}
$('pad').addEventListener('keydown', (event) => {
  if (event.key !== ' ' || event.repeat || state.bodies.length === 0) return;
  event.preventDefault();
  report({ event: 'impact', body: state.bodies[0], speed_m_s: 0.6, mass_kg: 0.008, radius_m: 0.006, striker: 'steel', restitution: 0.5 });
});
setInterval(() => {
  const now = performance.now();
  for (const finger of fingers.values()) {
    if (now - finger.told < RESTING_MS) continue;
    finger.told = now;
    report({ event: 'move', contact: finger.contact, uv: finger.uv, normal_force_n: finger.force });
  }
  flush();
}, SENT_MS);

// ---- The pad ----

/** Where fingers were, of the last moments. */
const trail = [];
const TRAIL_MS = 900;

function draw() {
  const [canvas, now] = [$('pad'), performance.now()];
  const scale = Math.min(devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * scale)) [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
  const context = canvas.getContext('2d');
  const style = getComputedStyle(document.documentElement);
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  const size = state?.surfaces[surface];
  context.fillStyle = style.getPropertyValue('--quiet');
  context.font = '13px system-ui, sans-serif';
  if (size) context.fillText(`${(1e3 * size.width_m).toPrecision(3)} × ${(1e3 * size.height_m).toPrecision(3)} mm: stroke here, Space strikes`, 10, 20);
  for (const finger of fingers.values()) trail.push({ at: now, uv: finger.uv, force: finger.force });
  while (trail.length > 0 && now - trail[0].at > TRAIL_MS) trail.shift();
  context.fillStyle = style.getPropertyValue('--mark');
  for (const { at, uv, force } of trail) {
    const left = 1 - (now - at) / TRAIL_MS;
    context.globalAlpha = 0.5 * left * left;
    context.beginPath();
    context.arc(uv[0] * width, uv[1] * height, (4 + 9 * Math.sqrt(force)) * left, 0, 2 * Math.PI);
    context.fill();
  }
  context.globalAlpha = 1;
  requestAnimationFrame(draw);
}

// ---- Buttons ----

const act = (id, work) => $(id).addEventListener('click', () => work().then((next) => next && show(next, id === 'revert')).catch((error) => say(error.message)));
act('keep', async () => { const next = await ask('keep', ''); say(`${next.scene} is written; its comments are where they were.`); return next; });
act('revert', () => ask('revert', ''));
act('log', () => ask('log', !state.plays));
act('missing', async () => { showsMissing = !showsMissing; $('missing').setAttribute('aria-pressed', String(showsMissing)); rows(); });
$('settings').addEventListener('submit', (event) => event.preventDefault());
addEventListener('keydown', (event) => { if ((event.ctrlKey || event.metaKey) && event.key === 's') { event.preventDefault(); $('keep').click(); } });
addEventListener('beforeunload', (event) => { if (state?.changed) event.preventDefault(); });

draw();
ask('state').then((next) => {
  // A scene that says no numbers shows what it could say.
  showsMissing = next.settings.every(({ value }) => value.length === 0);
  $('missing').setAttribute('aria-pressed', String(showsMissing));
  show(next);
}).catch((error) => say(error.message));
