// The solver of shapes, in the worker: a mesh becomes a body that rings wherever it is struck. `shape.wasm` is loaded when somebody wants one.
const [MODE, HEAD] = [5, 6];
/** Lowest so many modes: as many as a body has that rings for long. */
const MODES = 20;
/** Glazed stoneware, as the engine's preset `ceramic` has it. */
export const CERAMIC = { young_pa: 72e9, poisson: 0.19, density_kg_m3: 2700, alpha_per_s: 0.5, eta: 1.1e-3, beta_s: 0 };

const rounded = (x) => Number(x.toPrecision(6));
const rows = (numbers, width) => Array.from({ length: numbers.length / width }, (_, i) => Array.from(numbers.subarray(width * i, width * (i + 1))));

/** The text of a modes file with shapes, of the bytes of a mesh's file; what was mended or is doubted; how much was solved. */
export function solve(module, { name, bytes, material = CERAMIC, size_m = 0 }) {
  const { memory, ...wasm } = new WebAssembly.Instance(module).exports;
  const path = new TextEncoder().encode(name);
  const at = wasm.shape_inbox(path.length + bytes.length);
  new Uint8Array(memory.buffer, at).set(path);
  new Uint8Array(memory.buffer, at + path.length).set(bytes);
  const answer = () => new Uint8Array(memory.buffer, wasm.shape_outbox(), wasm.shape_outbox_bytes()).slice();
  const words = () => new TextDecoder().decode(answer());
  const { young_pa, poisson, density_kg_m3, alpha_per_s, eta, beta_s } = material;
  if (!wasm.shape_solve(path.length, young_pa, poisson, density_kg_m3, alpha_per_s, eta, beta_s, size_m, MODES)) throw new Error(words());
  const numbers = new Float64Array(answer().buffer);
  const [modes, points, triangles, struck_point, unknowns, mass_kg] = numbers;
  let from = HEAD;
  const next = (count) => numbers.subarray(from, from += count);
  const ringing = rows(next(MODE * modes), MODE);
  const shapes = {
    points_m: rows(next(3 * points).map(rounded), 3),
    triangles: rows(next(3 * triangles), 3),
    gains: ringing.map(([gain]) => gain),
    phi_per_sqrt_kg: Array.from({ length: modes }, () => rows(next(3 * points).map(rounded), 3)),
    struck_point,
  };
  const file = {
    format: 'asperity.modes', version: 2, source: name, impulse_n_s: 1, unit: 'relative', damping: { alpha_per_s, eta, beta_s },
    modes: ringing.map(([, frequency_hz, decay_per_s, amplitude, phase_rad]) => ({ frequency_hz, decay_per_s, amplitude, phase_rad })),
    shapes,
  };
  wasm.shape_told();
  return { modes: JSON.stringify(file), told: words().split('\n').filter(Boolean), unknowns, mass_kg };
}
