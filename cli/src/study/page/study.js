'use strict';
// A study in one page: consent, levels, training, trials, and answers that are kept after each trial.
const study = JSON.parse(document.getElementById('study').textContent);
const screen = document.getElementById('screen');
const said = document.getElementById('said');
const COLUMNS = ['participant', 'trial', 'protocol', 'stimulus', 'shown', 'answer', 'correct', 'response_ms', 'time'];
const PREFIX = `asperity-study ${study.id} `;
let run = { participant: '', rows: [] };
let served = false;
let keys = {};

// ---- random numbers of a seed -----------------------------------------------------------------
function random(text) {
  let state = 2166136261;
  for (const c of `${study.seed}/${text}`) state = Math.imul(state ^ c.codePointAt(0), 16777619);
  return () => { // mulberry32
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
const below = (next, n) => Math.floor(next() * n);
function shuffled(list, next) {
  const out = [...list];
  for (let i = out.length - 1; i > 0; i--) { const j = below(next, i + 1); [out[i], out[j]] = [out[j], out[i]]; }
  return out;
}

// ---- stimuli ----------------------------------------------------------------------------------
const names = [...new Set(study.stimuli.map((s) => s.name))];
const takes = (name) => study.stimuli.filter((s) => s.name === name);
const sets = [...new Set(study.stimuli.map((s) => s.set ?? ''))];
const within = (set) => names.filter((name) => (takes(name)[0].set ?? '') === set);
const labels = study.labels.length ? study.labels : names;
const label = (name) => takes(name)[0].label ?? name;
const pictureOf = (shown) => study.stimuli.find((s) => (s.label ?? s.name) === shown)?.picture;

// ---- order: a function of seed and participant, the same after a reload ------------------------
function plan() {
  const next = random(run.participant);
  const trials = [];
  const rounds = (things, make) => {
    for (let round = 0; round < study.trials; round++) {
      const order = shuffled(things, next);
      const last = trials.at(-1)?.thing;
      if (order.length > 1 && order[0] === last) order.push(order.shift());
      for (const thing of order) trials.push({ thing, ...make(thing, round) });
    }
  };
  if (study.protocol === 'identification') {
    const first = Object.fromEntries(names.map((name) => [name, below(next, takes(name).length)]));
    rounds(names, (name, round) => ({ take: takes(name)[(first[name] + round) % takes(name).length] }));
  } else if (study.protocol === 'abx') {
    const pairs = sets.flatMap((set) => within(set).flatMap((a, i, all) => all.slice(i + 1).map((b) => [a, b])));
    const flips = new Map(pairs.map((pair) => [pair, below(next, 4)]));
    rounds(pairs, (pair, round) => {
      const turn = (flips.get(pair) + round) % 4; // X and the order of A and B in turn: balanced every four
      const [a, b] = turn & 1 ? pair : [pair[1], pair[0]];
      const any = (name) => takes(name)[below(next, takes(name).length)];
      const x = turn & 2 ? a : b;
      return { a: any(a), b: any(b), x: any(x) };
    });
  } else if (study.protocol === 'rating') {
    const screens = study.stimuli.some((s) => s.role) ? sets : names;
    rounds(screens, (thing, round) => {
      const on = screens === names ? [thing] : within(thing);
      return { rated: shuffled(on, next).map((name) => takes(name)[round % takes(name).length]) };
    });
  }
  for (let n = 0; n < study.attention && trials.length; n++) {
    const part = trials.length / study.attention;
    trials.splice(Math.floor(n * part + next() * part), 0, { attention: true });
  }
  return trials;
}

/// Three down, one up over the levels there are: two steps at once until the second reversal.
function staircase(set) {
  const levels = study.stimuli.filter((s) => (s.set ?? '') === set && s.role !== 'reference').sort((a, b) => a.level - b.level);
  const rows = run.rows.filter((row) => row.protocol === 'staircase' && row.stimulus === (set || 'level'));
  let [at, streak, reversals, direction] = [levels.length - 1, 0, 0, 0];
  const move = (way) => {
    if (direction && way !== direction) reversals++;
    direction = way;
    at = Math.min(levels.length - 1, Math.max(0, at + way * (reversals < 2 ? 2 : 1)));
  };
  for (const row of rows) {
    streak = row.correct === 1 ? streak + 1 : 0;
    if (row.correct === 0) move(1);
    else if (streak === 3) { streak = 0; move(-1); }
  }
  return { set, target: levels[at], asked: rows.length, done: reversals >= study.reversals || rows.length >= study.trials };
}

// ---- keeping ----------------------------------------------------------------------------------
const quoted = (value) => { const text = String(value ?? ''); return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text; };
const csv = () => [COLUMNS, ...run.rows.map((row) => COLUMNS.map((name) => row[name]))].map((row) => row.map(quoted).join(',')).join('\n') + '\n';
const answered = () => new Set(run.rows.map((row) => row.trial)).size;

async function keep(rows, began) {
  const trial = answered() + 1;
  const common = { participant: run.participant, trial, response_ms: Math.round(performance.now() - began), time: new Date().toISOString() };
  run.rows.push(...rows.map((row) => ({ ...common, protocol: study.protocol, ...row })));
  await put();
}
async function put() {
  try { localStorage.setItem(PREFIX + run.participant, JSON.stringify(run)); } catch { say('This browser keeps nothing: download the answers at the end.', true); }
  if (!served) return;
  try {
    const response = await fetch(`answers/${run.participant}`, { method: 'POST', body: csv() });
    if (!response.ok) throw new Error(await response.text());
  } catch (error) { say(`The server has not saved this answer (${error.message}); this browser has. It is sent again with the next.`, true); }
}
/// One window at a time answers for a participant.
function locked(participant) {
  return new Promise((resolve) => {
    try {
      navigator.locks.request(PREFIX + participant, { ifAvailable: true }, (lock) => { resolve(Boolean(lock)); return lock && new Promise(() => {}); }).catch(() => resolve(true));
    } catch { resolve(true); }
  });
}

// ---- sound and touch --------------------------------------------------------------------------
const level = { sound: 0.5, touch: 0.5 };
let sink = '';
let playing = [];
const elements = new Map();
function element(path) {
  if (!elements.has(path)) { const audio = new Audio(path); audio.preload = 'auto'; elements.set(path, audio); }
  return elements.get(path);
}
async function play(stimulus) {
  for (const audio of playing) { audio.pause(); audio.dispatchEvent(new Event('stopped')); }
  const use = ['sound', 'touch'].filter((sense) => stimulus[sense]).map((sense) => [sense, element(stimulus[sense])]);
  playing = use.map(([, audio]) => audio);
  for (const [sense, audio] of use) {
    audio.volume = level[sense];
    audio.currentTime = 0;
    if (sense === 'touch' && sink && audio.setSinkId) await audio.setSinkId(sink);
  }
  const ended = ([, audio]) => new Promise((resolve) => { for (const name of ['ended', 'stopped', 'error']) audio.addEventListener(name, resolve, { once: true }); });
  const all = Promise.all(use.map(ended));
  try { await Promise.all(use.map(([, audio]) => audio.play())); } catch (error) { if (error.name !== 'AbortError') say(`cannot be played: ${error.message}`, true); }
  await all;
}

// ---- screens ----------------------------------------------------------------------------------
function make(tag, properties = {}, ...children) {
  const { data, ...rest } = properties;
  const made = Object.assign(document.createElement(tag), rest);
  Object.assign(made.dataset, data);
  made.append(...children);
  return made;
}
function say(text, wrong = false) { said.textContent = text; said.className = wrong ? 'wrong' : ''; }
function show(...children) { keys = {}; screen.replaceChildren(...children); (screen.querySelector('[data-first]') ?? screen).focus(); }
function button(text, act, { key, first, main, picture, disabled } = {}) {
  const made = make('button', { type: 'button', className: main ? 'main' : '', disabled: Boolean(disabled) });
  if (picture) made.append(make('img', { src: picture, alt: '' }));
  if (key) { made.append(make('kbd', { ariaHidden: 'true' }, key)); made.setAttribute('aria-keyshortcuts', key); keys[key] = made; }
  made.append(text);
  if (first) made.dataset.first = '';
  made.addEventListener('click', act);
  return made;
}
function slider(name, value, act, attributes = {}) {
  const shown = make('output', {}, String(value));
  const input = make('input', { type: 'range', min: 0, max: 100, value, ...attributes });
  input.addEventListener('input', () => { shown.textContent = input.value; act(Number(input.value)); });
  return make('label', { className: 'slider' }, make('span', {}, name), input, shown);
}
document.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  const pressed = keys[event.key.toLowerCase()];
  if (pressed && !pressed.disabled) { event.preventDefault(); pressed.click(); }
});
const pressed = (text, act) => new Promise((resolve) => { act(button(text, resolve, { first: true, main: true })); });
const paragraphs = (text) => text.split('\n\n').map((part) => make('p', {}, part));

function kept() {
  return Object.keys(localStorage).filter((key) => key.startsWith(PREFIX)).map((key) => JSON.parse(localStorage[key]));
}
/// Consent, and whose answers these are: a random number, no name.
function consent() {
  return new Promise((resolve) => {
    const asked = new URLSearchParams(location.search).get('participant') ?? '';
    const drawn = `p${[...crypto.getRandomValues(new Uint8Array(5))].map((byte) => byte.toString(16).padStart(2, '0')).join('')}`;
    const own = /^[A-Za-z0-9-]{1,32}$/.test(asked) ? asked : drawn;
    const begin = async (found) => {
      if (!(await locked(found.participant))) return say(`${found.participant} is answering in another window.`, true);
      run = found;
      say('');
      resolve();
    };
    let before = [];
    try { before = kept(); } catch { /* nothing is kept in this browser */ }
    const open = before.filter((one) => !one.finished);
    const fresh = before.find((one) => one.participant === own) ?? { participant: own, rows: [] };
    show(make('h1', {}, study.title), ...paragraphs(study.consent),
      make('p', {}, 'Your answers carry a random number and no name. You may stop at any time: close the window.'),
      make('div', { className: 'row' }, button('I agree: begin', () => begin(fresh), { first: true, main: true }),
        ...open.filter((one) => one.participant !== own).map((one) => button(`Go on as ${one.participant} (${new Set(one.rows.map((row) => row.trial)).size} answered)`, () => begin(one)))),
      ...(before.length ? [make('p', {}, 'Answers in this browser:'), make('div', { className: 'row' }, ...before.map((one) => download(one)))] : []));
  });
}
/// Levels before the start: the loudest stimulus, and where touch comes out.
async function levels() {
  const loudest = study.stimuli[study.loudest];
  const set = (sense, name) => slider(name, 50, (value) => { level[sense] = value / 100; });
  const rows = [];
  if (loudest.sound) rows.push(set('sound', 'Loudness'));
  if (loudest.touch) rows.push(set('touch', 'Strength of touch'), outputs());
  await pressed('Continue', (go) => show(make('h1', {}, 'Levels'),
    make('p', {}, 'This is the strongest that you will get. Play it, and set the levels so that it is clear and comfortable; leave them until the end.'),
    make('div', { className: 'row' }, button('Play', () => play(loudest), { key: 'p' })), ...rows, make('div', { className: 'row' }, go)));
}
function outputs() {
  const choice = make('select', { id: 'output' }, make('option', { value: '' }, 'the usual one'));
  choice.addEventListener('change', () => { sink = choice.value; });
  const find = async () => {
    try {
      (await navigator.mediaDevices.getUserMedia({ audio: true })).getTracks().forEach((track) => track.stop());
      const found = (await navigator.mediaDevices.enumerateDevices()).filter((one) => one.kind === 'audiooutput');
      choice.replaceChildren(...found.map((one) => make('option', { value: one.deviceId }, one.label || 'an output')));
      sink = choice.value;
    } catch (error) { say(`Outputs cannot be listed (${error.message}): choose the actuator in the system's settings.`, true); }
  };
  return make('div', { className: 'row' }, make('label', { htmlFor: 'output' }, 'Output of the actuator'), choice, button('Find outputs', find));
}
async function training() {
  if (!study.training) return;
  const named = study.protocol === 'identification';
  const each = names.map((name, i) => button(named ? label(name) : `Example ${i + 1}`, () => play(takes(name)[0]), { key: i < 9 ? String(i + 1) : '', picture: named ? takes(name)[0].picture : '' }));
  await pressed('Start', (go) => show(make('h1', {}, 'Training'), ...paragraphs(study.instructions),
    make('p', {}, 'Play each as often as you like. Nothing is kept yet.'), make('div', { className: 'answers' }, ...each), make('div', { className: 'row' }, go)));
}
/// Heading and progress of a trial.
const head = (number, of) => [make('h1', {}, `Trial ${number} of ${of}`), make('progress', { max: of, value: number - 1, ariaLabel: 'progress' })];
/// A play button that lets answer once all that is to be played was.
function player(text, stimulus, key, state, first) {
  state.waits.add(text);
  return button(text, async () => {
    say('');
    await play(stimulus);
    state.waits.delete(text);
    if (!state.waits.size) state.open();
  }, { key, first });
}
/// Plays, then one answer of several; resolves to it.
function choose(header, question, plays, answers) {
  return new Promise((resolve) => {
    const began = performance.now();
    const state = { waits: new Set(), open: () => { for (const one of options) one.disabled = false; } };
    show(...header);
    const players = plays.map(([text, stimulus, key], i) => player(text, stimulus, key, state, i === 0));
    const options = answers.map((text, i) => button(text, () => resolve({ answer: text, began }), { key: i < 9 ? String(i + 1) : '', picture: pictureOf(text), disabled: plays.length > 0, first: !plays.length && i === 0 }));
    screen.append(make('div', { className: 'row' }, ...players), make('h2', {}, question), make('div', { className: 'answers' }, ...options));
    (screen.querySelector('[data-first]') ?? screen).focus();
  });
}
function rate(header, rated) {
  return new Promise((resolve) => {
    const began = performance.now();
    const done = button('Next', () => resolve({ rows, began }), { main: true, disabled: true });
    const state = { waits: new Set(), open: () => { done.disabled = false; } };
    const rows = [];
    const single = rated.length === 1;
    show(...header);
    const reference = rated.find((one) => one.role === 'reference');
    if (reference) screen.append(make('div', { className: 'row' }, player('Reference', reference, 'r', state, true)));
    if (single && rated[0].picture) screen.append(make('img', { className: 'beside', src: rated[0].picture, alt: 'what it shall feel and sound like' }));
    rated.forEach((one, i) => {
      const name = single ? 'Play' : `Play ${String.fromCharCode(65 + i)}`;
      const box = make('fieldset', {}, make('legend', {}, single ? study.question : String.fromCharCode(65 + i)), player(name, one, single ? 'p' : String(i + 1), state, i === 0 && !reference));
      for (const scale of study.scales) {
        const row = { stimulus: one.name, shown: scale, answer: 50, correct: '' };
        rows.push(row);
        box.append(slider(scale, 50, (value) => { row.answer = value; }, { ariaLabel: single ? scale : `${scale} of ${String.fromCharCode(65 + i)}` }));
      }
      screen.append(box);
    });
    screen.append(make('div', { className: 'row' }, done));
    (screen.querySelector('[data-first]') ?? screen).focus();
  });
}
/// A question about nothing that is played: whoever reads it answers it.
async function attention(header) {
  const options = { identification: labels, abx: ['A', 'B'], rating: ['0', '50', '100'], staircase: ['first', 'second'] }[study.protocol];
  const right = options[below(random(`${run.participant}/${answered()}`), options.length)];
  const { answer, began } = await choose(header, `A check of attention: answer “${right}”.`, [], options);
  await keep([{ protocol: 'attention', stimulus: 'attention', shown: right, answer, correct: Number(answer === right) }], began);
}
async function ask(trial, number, of) {
  const header = head(number, of);
  if (trial.attention) return attention(header);
  if (study.protocol === 'identification') {
    const right = label(trial.thing);
    const { answer, began } = await choose(header, study.question, [['Play', trial.take, 'p']], labels);
    return keep([{ stimulus: trial.thing, shown: right, answer, correct: Number(answer === right) }], began);
  }
  if (study.protocol === 'abx') {
    const { answer, began } = await choose(header, study.question, [['Play A', trial.a, 'a'], ['Play B', trial.b, 'b'], ['Play X', trial.x, 'x']], ['A', 'B']);
    const chosen = (answer === 'A' ? trial.a : trial.b).name;
    return keep([{ stimulus: trial.thing.join(' | '), shown: trial.x.name, answer: chosen, correct: Number(chosen === trial.x.name) }], began);
  }
  const { rows, began } = await rate(header, trial.rated);
  return keep(rows, began);
}
async function askLevel() {
  const next = random(`${run.participant}/${answered()}`);
  const open = sets.map(staircase).filter((one) => !one.done);
  if (!open.length) return false;
  const due = Math.floor(answered() / 20);
  const checks = run.rows.filter((row) => row.protocol === 'attention').length;
  const header = head(answered() + 1, sets.length * study.trials + study.attention);
  if (checks < Math.min(study.attention, due)) { await attention(header); return true; }
  const { set, target } = open[below(next, open.length)];
  const reference = study.stimuli.find((s) => (s.set ?? '') === set && s.role === 'reference');
  const second = next() < 0.5;
  const order = second ? [reference, target] : [target, reference];
  const { answer, began } = await choose(header, study.question, [['Play first', order[0], 'f'], ['Play second', order[1], 's']], ['first', 'second']);
  await keep([{ stimulus: set || 'level', shown: target.level, answer, correct: Number((answer === 'second') === second) }], began);
  return true;
}
function download(one = run) {
  const now = run;
  return button(`Download ${one.participant}.csv`, () => {
    run = one;
    const url = URL.createObjectURL(new Blob([csv()], { type: 'text/csv' }));
    run = now;
    make('a', { href: url, download: `${one.participant}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  });
}

(async () => {
  try { served = location.protocol !== 'file:' && (await (await fetch('answers')).text()) === 'asperity study'; } catch { served = false; }
  await consent();
  if (!run.finished) {
    await levels();
    await training();
    if (study.protocol === 'staircase') while (await askLevel());
    else { const trials = plan(); while (answered() < trials.length) await ask(trials[answered()], answered() + 1, trials.length); }
    run.finished = true;
    await put();
  }
  show(make('h1', {}, 'Thank you'), make('p', {}, served ? 'Your answers are saved on the machine that served this page.' : 'Your answers are kept in this browser. Please hand over the file:'), make('div', { className: 'row' }, download()));
})();
