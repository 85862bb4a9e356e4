// A finger strokes granite on a brass bowl for a second, then steel strikes the bowl: stroke.wav.
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { renderLog } from 'asperity/engine.js';

const scene = `
sample_rate_hz = 48000
[[body]]
name = "bowl"
stock = "bowl"
size_m = 0.12
material = "brass"
[[surface]]
name = "granite"
body = "bowl"
solid = "granite"
width_m = 0.14
height_m = 0.14
[[actuator]]
full_scale = 1e-4
[audio]
gain = 0.05
limit = true
`;

const log = [];
for (let step = 0; step <= 60; step++) {
  const t = step / 60;
  const place = { uv: [0.1 + (0.08 * t) / 0.14, 0.5], velocity_m_s: [0.08, 0], normal_force_n: 0.6 };
  log.push(step === 0 ? { t, event: 'begin', contact: 1, surface: 'granite', actuator: 0, ...place } : { t, event: 'move', contact: 1, ...place });
}
log.push({ t: 1.02, event: 'end', contact: 1 });
log.push({ t: 1.1, event: 'impact', body: 'bowl', speed_m_s: 0.5, mass_kg: 0.008, radius_m: 0.006, striker: 'steel' });

const wasm = readFileSync(fileURLToPath(import.meta.resolve('asperity/asperity.wasm')));
const { audio, haptic } = renderLog(new WebAssembly.Module(wasm), { scene, log });
writeFileSync('stroke.wav', audio);
writeFileSync('stroke.haptic.wav', haptic);
console.log(`wrote stroke.wav (${audio.length} bytes) and stroke.haptic.wav`);
