// node split/plain.mjs FROM.wasm TO.wasm: the module without the names of folders on the machine that built it. They are in no page's interest, take
// 2 kB gzipped, and would make its bytes those of one folder.
import { readFileSync, realpathSync, writeFileSync } from 'node:fs';
import { homedir } from 'node:os';
import { withoutPaths } from './binary.mjs';

const [from, to] = process.argv.slice(2);
const cargo = process.env.CARGO_HOME ?? `${homedir()}/.cargo`;
const folders = [realpathSync(new URL('../../../', import.meta.url)).replace(/\/$/, ''), `${cargo}/registry/src`, '/rustc', '/rust/deps'];
writeFileSync(to, withoutPaths(new Uint8Array(readFileSync(from)), folders));
