// Saving: what was played as a WAV, the contact log and the scene that make it again, in one archive.

const table = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

/** An archive of files as they are, without compression. */
export function zip(files) {
  const [parts, entries] = [[], []];
  let at = 0;
  for (const [name, bytes] of Object.entries(files)) {
    const path = new TextEncoder().encode(name);
    const head = new DataView(new ArrayBuffer(30));
    // Version 2.0, names in UTF-8, stored, 1 January 1980.
    [[0, 0x04034b50, 4], [4, 20, 2], [6, 0x800, 2], [12, 0x21, 2], [14, crc32(bytes), 4], [18, bytes.length, 4], [22, bytes.length, 4], [26, path.length, 2]]
      .forEach(([place, value, size]) => (size === 4 ? head.setUint32(place, value, true) : head.setUint16(place, value, true)));
    const entry = new DataView(new ArrayBuffer(46));
    entry.setUint32(0, 0x02014b50, true);
    entry.setUint16(4, 20, true);
    for (let i = 4; i < 30; i++) entry.setUint8(i + 2, head.getUint8(i));
    entry.setUint32(42, at, true);
    parts.push(new Uint8Array(head.buffer), path, bytes);
    entries.push(new Uint8Array(entry.buffer), path);
    at += 30 + path.length + bytes.length;
  }
  const size = entries.reduce((sum, part) => sum + part.length, 0);
  const end = new DataView(new ArrayBuffer(22));
  end.setUint32(0, 0x06054b50, true);
  for (const place of [8, 10]) end.setUint16(place, entries.length / 2, true);
  end.setUint32(12, size, true);
  end.setUint32(16, at, true);
  return new Blob([...parts, ...entries, new Uint8Array(end.buffer)], { type: 'application/zip' });
}

/** A grey map as PNG: 16 bits a sample. */
export async function png({ width, height, samples }) {
  const rows = new Uint8Array(height * (1 + 2 * width));
  for (let y = 0, i = 0; y < height; y++) {
    rows[i++] = 0;
    for (let x = 0; x < width; x++) {
      const sample = samples[y * width + x];
      rows[i++] = sample >> 8;
      rows[i++] = sample & 255;
    }
  }
  const packed = new Response(new Blob([rows]).stream().pipeThrough(new CompressionStream('deflate')));
  const head = new DataView(new ArrayBuffer(13));
  head.setUint32(0, width);
  head.setUint32(4, height);
  head.setUint8(8, 16);
  const chunks = [['IHDR', new Uint8Array(head.buffer)], ['IDAT', new Uint8Array(await packed.arrayBuffer())], ['IEND', new Uint8Array(0)]];
  const bytes = chunks.flatMap(([kind, content]) => {
    const chunk = new Uint8Array(12 + content.length);
    const view = new DataView(chunk.buffer);
    view.setUint32(0, content.length);
    chunk.set([...kind].map((letter) => letter.charCodeAt(0)), 4);
    chunk.set(content, 8);
    view.setUint32(8 + content.length, crc32(chunk.subarray(4, 8 + content.length)));
    return [chunk];
  });
  return new Uint8Array(await new Blob([Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10), ...bytes]).arrayBuffer());
}

/** Everything that was played, to be rendered again: scene, log, maps, WAVs. */
export async function archive(name, { scene, log, pictures, files, audio, haptic }) {
  const text = (words) => new TextEncoder().encode(words);
  const saved = { [`${name}.wav`]: audio, [`${name}.haptic.wav`]: haptic, [`${name}.jsonl`]: text(log), [`${name}.toml`]: text(scene) };
  for (const [path, picture] of Object.entries(pictures)) saved[path] = await png(picture);
  for (const [path, content] of Object.entries(files)) saved[path] = text(content);
  return zip(saved);
}

/** Hands a file to whoever looks at the page. */
export function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
