// Three strips that scroll with time: the ground under the finger, its skin, the spectrogram of the sound with the marker at v/λ.

/** Numbers of a row of the engine's scope: see src/blocks.rs. */
const ROW = 16;
/** What the spectrogram shows up to, Hz, and how its axis bends: rhythms of 10 Hz have some of it, what rings at 3 kHz and more half. */
const [HIGHEST_HZ, BEND] = [16000, 0.35];
const FLOOR_DB = -95;

export class Strips {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d', { alpha: false });
    this.columns = [];
    this.told = 0;
    this.spans = [1e-5, 1e-5];
    this.middles = [0, 0];
    this.marks = true;
    this.colours();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.colours());
  }

  colours() {
    const style = getComputedStyle(document.documentElement);
    this.inks = Object.fromEntries(['strip', 'relief', 'skin', 'heard', 'ink', 'quiet', 'line'].map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
    this.clear = true;
  }

  /** Rows of the scope, and what is heard just now. */
  add(rows, spectrum, rate, wavelength_m) {
    let column = null;
    for (let i = 0; i < rows.length; i += ROW) {
      const row = rows.subarray(i, i + ROW);
      if (row[0] === 0) continue;
      column ??= { ground: [Infinity, -Infinity], skin: [Infinity, -Infinity] };
      column.ground = [Math.min(column.ground[0], row[1]), Math.max(column.ground[1], row[2])];
      column.skin = [Math.min(column.skin[0], row[3]), Math.max(column.skin[1], row[4])];
      column.speed = Math.hypot(row[7], row[8]);
    }
    column ??= {};
    this.marks = Boolean(wavelength_m);
    column.spectrum = spectrum.slice();
    column.rate = rate;
    column.marker = wavelength_m && column.speed > 0.005 ? column.speed / wavelength_m : 0;
    this.columns.push(column);
    this.told = 1;
    if (this.columns.length > 200) this.columns.shift();
  }

  draw() {
    if (document.hidden) { this.columns.length = 0; return; }
    const { canvas, context } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== width || canvas.height !== height || this.clear) {
      [canvas.width, canvas.height, this.clear] = [Math.max(1, width), Math.max(1, height), false];
      context.fillStyle = this.inks.strip;
      context.fillRect(0, 0, width, height);
      this.labels(height);
    }
    const columns = this.columns.splice(0);
    const step = 2;
    const moved = Math.min(width, columns.length * step);
    if (moved === 0) return;
    context.drawImage(canvas, moved, 0, width - moved, height, 0, 0, width - moved, height);
    context.fillStyle = this.inks.strip;
    context.fillRect(width - moved, 0, moved, height);
    columns.slice(-Math.ceil(width / step)).forEach((column, i, all) => this.column(column, width - (all.length - i) * step, step, height));
    this.labels(height);
  }

  column(column, x, step, height) {
    const lines = [0, height * 0.24, height * 0.48];
    const { context, inks } = this;
    [['ground', inks.relief], ['skin', inks.skin]].forEach(([name, ink], strip) => {
      if (!column[name]) return;
      // Slow ups and downs are followed, so that what is fine fills the strip.
      const middle = this.middles[strip] += 0.15 * ((column[name][0] + column[name][1]) / 2 - this.middles[strip]);
      const [low, high] = column[name].map((m) => m - middle);
      this.spans[strip] = Math.max(this.spans[strip] * 0.99, Math.abs(low), Math.abs(high), 1e-7);
      const at = (m) => lines[strip] + height * 0.12 * (1 - 0.9 * (m / this.spans[strip]));
      context.fillStyle = ink;
      context.fillRect(x, at(high), step, Math.max(1.5, at(low) - at(high)));
    });
    const rows = Math.floor(height - lines[2]);
    const bins = column.spectrum.length;
    context.fillStyle = inks.heard;
    for (let y = 0; y < rows; y += 2) {
      const hz = HIGHEST_HZ * (1 - y / rows) ** (1 / BEND);
      const bin = Math.min(bins - 1, Math.round((hz / (column.rate / 2)) * bins));
      const level = (column.spectrum[bin] - FLOOR_DB) / -FLOOR_DB;
      if (level <= 0.02) continue;
      context.globalAlpha = Math.min(1, level * 1.9) ** 1.2;
      context.fillRect(x, lines[2] + y, step, 2);
    }
    context.globalAlpha = 1;
    if (column.marker > 1 && column.marker < HIGHEST_HZ) {
      const y = lines[2] + rows * (1 - (column.marker / HIGHEST_HZ) ** BEND);
      context.fillStyle = inks.ink;
      context.fillRect(x, y, step, 2);
    }
  }

  labels(height) {
    const { context, inks } = this;
    context.font = '11px system-ui, sans-serif';
    const [skin, sound] = [0.24, 0.48].map((part) => height * part + 12);
    [
      ['relief', this.spans[0], inks.relief, 12, 6], ['skin', this.spans[1], inks.skin, skin, 6],
      ['sound', null, inks.heard, sound, 6], ...(this.marks ? [['— ridges a second, v/λ', null, inks.ink, sound, 44]] : []),
    ].forEach(([name, span, ink, y, x]) => {
      const text = span === null || this.columns.length + this.told === 0 ? name : `${name} ±${length(span)}`;
      context.fillStyle = inks.strip;
      context.fillRect(x - 6, y - 10, context.measureText(text).width + 12, 13);
      context.fillStyle = ink;
      context.fillText(text, x, y);
    });
  }
}

/** A length in a unit that suits it. */
export function length(m) {
  return m >= 1e-3 ? `${Number((m * 1e3).toFixed(1))} mm` : `${(m * 1e6).toFixed(m < 1e-5 ? 1 : 0)} µm`;
}
