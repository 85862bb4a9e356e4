// node without_paths.mjs FROM.wasm TO.wasm: the module without the names of folders on the machine that built it. They are in no page's interest,
// take 2 kB gzipped, and would make its bytes those of one folder. Only data hold names, and a name that is blanked keeps its length.
import { readFileSync, realpathSync, writeFileSync } from 'node:fs';
import { homedir } from 'node:os';

const [from, to] = process.argv.slice(2);
const cargo = process.env.CARGO_HOME ?? `${homedir()}/.cargo`;
const folders = [realpathSync(new URL('../../', import.meta.url)).replace(/\/$/, ''), `${cargo}/registry/src`, '/rustc', '/rust/deps'];
const escaped = folders.map((folder) => folder.replace(/[^\w/]/g, '\\$&'));
const path = new RegExp(`(?:${escaped.join('|')})/[\\w.+/-]*?\\.rs`, 'g');
const bytes = readFileSync(from);
for (const { index, 0: { length } } of bytes.toString('latin1').matchAll(path)) bytes.fill(0, index, index + length);
writeFileSync(to, bytes);
