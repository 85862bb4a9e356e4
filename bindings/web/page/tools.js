// The offline tools, in the worker: a recorded hit becomes modes, a photograph a relief. `tools.wasm` is loaded when somebody brings one.
const ROW = 4;

class Tools {
  constructor(module) {
    this.wasm = new WebAssembly.Instance(module).exports;
  }

  put(numbers) {
    const at = this.wasm.tools_inbox(8 * numbers.length);
    new Float64Array(this.wasm.memory.buffer, at, numbers.length).set(numbers);
  }

  answer(done) {
    const bytes = new Uint8Array(this.wasm.memory.buffer, this.wasm.tools_outbox(), this.wasm.tools_outbox_bytes()).slice();
    if (!done) throw new Error(new TextDecoder().decode(bytes));
    return new Float64Array(bytes.buffer);
  }
}

/** A recorded hit, one channel, as the text of a modes file. */
export function fit(module, { name, samples, rate }) {
  const tools = new Tools(module);
  tools.put(samples);
  const rows = tools.answer(tools.wasm.tools_fit(rate));
  const modes = Array.from({ length: rows.length / ROW }, (_, i) => {
    const [frequency_hz, decay_per_s, amplitude, phase_rad] = rows.subarray(ROW * i, ROW * (i + 1));
    return { frequency_hz, decay_per_s, amplitude, phase_rad };
  });
  if (modes.length === 0) throw new Error('nothing in it rings; must be one hit on something that does, and what it rings after');
  return JSON.stringify({ format: 'asperity.modes', version: 1, source: name, impulse_n_s: 0.01, modes });
}

/** A photograph's brightness as a surface: maps of heights and roughness, both 16 bits, and how high it is. */
export function photo(module, { width, height, grey, texel_m }) {
  const tools = new Tools(module);
  tools.put(grey);
  const [columns, rows, relief_m, micro_relief_m, ...values] = tools.answer(tools.wasm.tools_photo(width, height, texel_m, 0));
  const map = (from) => ({ width: columns, height: rows, samples: Uint16Array.from(values.slice(from, from + columns * rows), (x) => Math.round(65535 * Math.min(1, Math.max(0, x)))) });
  return { displacement: map(0), roughness: map(columns * rows), relief_m, micro_relief_m };
}
