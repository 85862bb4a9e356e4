// Runs a WebAssembly program in node, as cargo asks for it: node .ci/wasi.mjs PROGRAM.wasm [ARGUMENT …]
//
// A test that computes needs of WASI its arguments, two clocks and somewhere to print; node's own implementation has crashed the
// collector of node 20 when a program's memory grew.
import { readFileSync, writeSync } from 'node:fs';
import { argv, exit } from 'node:process';

const [OK, BADF, NOSYS] = [0, 8, 52];
const args = argv.slice(2).map((text) => new TextEncoder().encode(`${text}\0`));
const module = new WebAssembly.Module(readFileSync(argv[2]));
let memory;
const view = () => new DataView(memory.buffer);

const known = {
  args_sizes_get(count, bytes) {
    view().setUint32(count, args.length, true);
    view().setUint32(bytes, args.reduce((sum, text) => sum + text.length, 0), true);
    return OK;
  },
  args_get(pointers, bytes) {
    for (const [i, text] of args.entries()) {
      view().setUint32(pointers + 4 * i, bytes, true);
      new Uint8Array(memory.buffer, bytes).set(text);
      bytes += text.length;
    }
    return OK;
  },
  environ_sizes_get(count, bytes) {
    view().setUint32(count, 0, true);
    view().setUint32(bytes, 0, true);
    return OK;
  },
  environ_get: () => OK,
  clock_time_get(clock, _precision, time) {
    const now = clock === 0 ? BigInt(Date.now()) * 1_000_000n : process.hrtime.bigint();
    view().setBigUint64(time, now, true);
    return OK;
  },
  random_get(bytes, length) {
    // Nothing that is tested depends on it, and what is the same each time fails each time.
    new Uint8Array(memory.buffer, bytes, length).fill(7);
    return OK;
  },
  fd_write(file, vectors, count, written) {
    let sum = 0;
    for (let i = 0; i < count; i++) {
      const [from, length] = [0, 4].map((at) => view().getUint32(vectors + 8 * i + at, true));
      writeSync(file, new Uint8Array(memory.buffer, from, length).slice());
      sum += length;
    }
    view().setUint32(written, sum, true);
    return OK;
  },
  fd_prestat_get: () => BADF,
  sched_yield: () => OK,
  proc_exit: (code) => exit(code),
};

const imports = {};
for (const { module: from, name } of WebAssembly.Module.imports(module)) {
  imports[from] ??= {};
  imports[from][name] = known[name] ?? (() => NOSYS);
}
const instance = new WebAssembly.Instance(module, imports);
({ memory } = instance.exports);
instance.exports._start();
exit(0);
