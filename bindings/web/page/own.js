// What visitors bring: pictures become surfaces, recorded hits and files of modes bodies. Loaded when somebody brings something.
import { ofImage } from './pictures.js';
import { solved } from './solid.js';
import { ownSurface, photoSurface, solidSurface } from './surfaces.js';

const MOST_FILE_BYTES = 64 << 20;
/** Rate at which recordings are decoded, Hz. */
const RATE_HZ = 48000;
/** How long a hit is listened for, s. */
const LISTENED_S = 4;

/** What a file is: `{ surface }` or `{ modes }`, with a sentence. `ask(work)` lets the worker's tools do something, `askShape(work)` its solver. */
export async function bring(file, { isMap, ask, askShape }) {
  if (file.size > MOST_FILE_BYTES) throw new Error(`${file.name}: has ${Math.round(file.size / 1e6)} MB; must be at most 64 MB.`);
  if (/\.json$/i.test(file.name)) return ringing(file.name, await file.text());
  if (/\.(obj|stl|msh)$/i.test(file.name)) return mesh(file, askShape);
  if (/\.(wav|flac|ogg|mp3|m4a|opus|webm)$/i.test(file.name) || file.type.startsWith('audio/')) return hit(file.name, await decoded(file), ask);
  return picture(file, isMap, ask);
}

/** A mesh becomes a body. */
async function mesh(file, ask) {
  const { modes, told, found } = await solved(ask, file.name, new Uint8Array(await file.arrayBuffer()));
  return solid(file.name, modes, [`${file.name} is solved: ${found}. Hit it in different places.`, ...told.map((line) => `(${line}.)`)].join(' '));
}

/** A body of one's own, with its shape. */
function solid(name, modes, sentence) {
  return { surface: { ...solidSurface('own', name.slice(0, 24), 'Your own body. Drag beside it to turn it.'), isOwn: true, modes }, sentence };
}

/** A file of modes; where it has shapes, the body can be seen and hit anywhere. */
function ringing(name, modes) {
  let shapes;
  try { ({ shapes } = JSON.parse(modes)); } catch { /* The engine says what is wrong. */ }
  const sentence = `${name} rings now.`;
  return shapes?.points_m && shapes.triangles ? solid(name, modes, sentence) : { modes, sentence };
}

async function decoded(file) {
  try {
    return await new OfflineAudioContext(1, 1, RATE_HZ).decodeAudioData(await file.arrayBuffer());
  } catch {
    throw new Error(`${file.name}: is no recording that this browser reads; must be WAV, FLAC, MP3, Ogg or the like.`);
  }
}

/** The loudest channel of a recording becomes a body. */
async function hit(name, sound, ask) {
  const channels = Array.from({ length: sound.numberOfChannels }, (_, i) => sound.getChannelData(i));
  const energy = channels.map((samples) => samples.reduce((sum, x) => sum + x * x, 0));
  const samples = Float64Array.from(channels[energy.indexOf(Math.max(...energy))]);
  try {
    const modes = await ask({ fit: { name, samples, rate: sound.sampleRate } });
    const count = JSON.parse(modes).modes.length;
    return { modes, sentence: `${name} rings now: ${count} ${count === 1 ? 'mode' : 'modes'}.` };
  } catch (error) {
    throw new Error(`${name}: ${error.message}`);
  }
}

async function picture(file, isMap, ask) {
  let image;
  try {
    image = await createImageBitmap(file);
  } catch {
    throw new Error(`${file.name}: is no picture that this browser reads; must be a picture, a recorded hit, a mesh (.obj, .stl) or a .modes.json.`);
  }
  const drawn = ofImage(image);
  image.close();
  if (isMap) return { surface: ownSurface(drawn), sentence: `${file.name}: what is bright is high, 1 mm.` };
  const { width, height, samples } = drawn.picture;
  try {
    const found = await ask({ photo: { width, height, grey: Float64Array.from(samples, (x) => x / 65535), texel_m: 0.12 / width } });
    if (found.relief_m < 1e-6) throw new Error('shows no relief; must be a surface with light and shade, or tick “pictures are height maps”.');
    const surface = photoSurface(drawn, found);
    return { surface, sentence: `${file.name}: a relief of ${(1e3 * found.relief_m).toFixed(1)} mm, found from light and shade.` };
  } catch (error) {
    throw new Error(`${file.name}: ${error.message}`);
  }
}

/** Listens to the microphone for some seconds; a hit in them becomes a body. */
export async function listen(ask, say) {
  if (!navigator.mediaDevices?.getUserMedia) throw new Error('This page may not listen: it must come by https or from this machine.');
  let stream;
  try {
    stream = await navigator.mediaDevices.getUserMedia({ audio: { echoCancellation: false, noiseSuppression: false, autoGainControl: false } });
  } catch {
    throw new Error('The microphone was not allowed, or there is none.');
  }
  const context = new AudioContext();
  try {
    await context.audioWorklet.addModule(new URL('./listen.js', import.meta.url));
    const node = new AudioWorkletNode(context, 'listen', { numberOfOutputs: 0, channelCount: 1, channelCountMode: 'explicit' });
    const parts = [];
    node.port.onmessage = ({ data }) => parts.push(data);
    context.createMediaStreamSource(stream).connect(node);
    say(`Hit something now: ${LISTENED_S} seconds.`);
    await new Promise((resolve) => setTimeout(resolve, 1000 * LISTENED_S));
    const samples = Float32Array.from(parts.flatMap((part) => [...part]));
    const sound = { numberOfChannels: 1, sampleRate: context.sampleRate, getChannelData: () => samples };
    return await hit('Your hit', sound, ask);
  } finally {
    for (const track of stream.getTracks()) track.stop();
    context.close();
  }
}
