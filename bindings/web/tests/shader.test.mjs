// Shaders of `asperity texture solid --shader glsl`, drawn by WebGL2 on the plane and on a mesh, beside the height maps that are felt.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { tmpdir } from 'node:os';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { browser } from './host.mjs';

const folder = mkdtempSync(join(tmpdir(), 'asperity-shader-'));
const PICTURES = join(process.env.WORK, 'pictures');
mkdirSync(PICTURES, { recursive: true });
const texture = (...words) => JSON.parse(execFileSync(process.env.ASPERITY_PROGRAM, ['texture', ...words, '--json'], { cwd: folder, encoding: 'utf8' }));
let chromium;
before(async () => { chromium = await browser(); });
after(async () => { await chromium?.close(); });

const SIZE = 1024;
/** Radius of the sphere, m: a texel of its map is a sixteenth of the finest cell or less. */
const radius = (name) => (['sandpaper', 'wood'].includes(name) ? 1e-3 : 2e-3);
const SOLIDS = ['sandpaper', 'granite', 'rough-glass', 'wood', 'sand', 'gravel', 'pebbles', 'ridged', 'billow', 'turbulence', 'voronoi'];
const GRATINGS = ['sine', 'ridges', 'dots'];

/** A sphere somewhere in the block, as GLB: longitude to u, latitude to v. */
function sphere(name, r, cells = 48) {
  const [places, uvs, corners] = [[], [], []];
  for (let j = 0; j <= cells; j++) {
    for (let i = 0; i <= cells; i++) {
      const [lon, lat] = [(2 * Math.PI * i) / cells, (Math.PI * j) / cells];
      places.push(0.007 + r * Math.sin(lat) * Math.cos(lon), 0.003 + r * Math.sin(lat) * Math.sin(lon), 0.005 + r * Math.cos(lat));
      uvs.push(i / cells, j / cells);
      if (i < cells && j < cells) {
        const at = j * (cells + 1) + i;
        corners.push(at, at + cells + 1, at + 1, at + 1, at + cells + 1, at + cells + 2);
      }
    }
  }
  const parts = [Float32Array.from(places), Float32Array.from(uvs), Uint16Array.from(corners)].map((one) => Buffer.from(one.buffer));
  const views = parts.map((part, i) => ({ buffer: 0, byteOffset: parts.slice(0, i).reduce((sum, one) => sum + one.length, 0), byteLength: part.length }));
  const binary = Buffer.concat(parts);
  const pad = (buffer, fill) => Buffer.concat([buffer, Buffer.alloc(-buffer.length & 3, fill)]);
  const document = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2 }] }],
    buffers: [{ byteLength: binary.length }], bufferViews: views,
    accessors: [
      { bufferView: 0, componentType: 5126, count: places.length / 3, type: 'VEC3' },
      { bufferView: 1, componentType: 5126, count: uvs.length / 2, type: 'VEC2' },
      { bufferView: 2, componentType: 5123, count: corners.length, type: 'SCALAR' },
    ],
  };
  const chunks = [[pad(Buffer.from(JSON.stringify(document)), ' '), 'JSON'], [pad(binary, 0), 'BIN\0']];
  const body = Buffer.concat(chunks.flatMap(([bytes, kind]) => { const head = Buffer.alloc(8); head.writeUInt32LE(bytes.length); head.write(kind, 4); return [head, bytes]; }));
  const head = Buffer.alloc(12);
  head.write('glTF'); head.writeUInt32LE(2, 4); head.writeUInt32LE(12 + body.length, 8);
  writeFileSync(join(folder, name), Buffer.concat([head, body]));
  return { places, uvs, corners, r };
}

/** Grey levels of a 16-bit PNG. */
function grey16(name) {
  const file = readFileSync(join(folder, name));
  const size = file.readUInt32BE(16);
  assert.deepEqual([file[24], file[25], file[28]], [16, 0, 0], 'a grey PNG of 16 bits');
  const data = [];
  for (let at = 8; at < file.length; at += 12 + file.readUInt32BE(at)) {
    if (file.toString('latin1', at + 4, at + 8) === 'IDAT') data.push(file.subarray(at + 8, at + 8 + file.readUInt32BE(at)));
  }
  const raw = inflateSync(Buffer.concat(data));
  const stride = 2 * size;
  const out = Buffer.alloc(stride * size);
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < stride; x++) {
      const [left, up, corner] = [x > 1 ? out[y * stride + x - 2] : 0, y ? out[(y - 1) * stride + x] : 0, x > 1 && y ? out[(y - 1) * stride + x - 2] : 0];
      const far = [left, up, corner].map((one) => Math.abs(left + up - corner - one));
      const nearest = far[0] <= far[1] && far[0] <= far[2] ? left : far[1] <= far[2] ? up : corner;
      const guess = [0, left, up, (left + up) >> 1, nearest][raw[y * (stride + 1)]];
      out[y * stride + x] = raw[y * (stride + 1) + 1 + x] + guess;
    }
  }
  return out.swap16();
}

/** Draws in the page: red what the shader makes, green what the map holds there, m. Gives the share of pixels that differ by more than a grey step of 8 bit. */
async function drawn({ shader, height, at, map, told, view, mesh, name }) {
  const page = await chromium.newPage();
  const found = await page.evaluate(({ shader, height, at, map, grey, size, view, mesh }) => {
    const side = 256;
    const gl = Object.assign(document.createElement('canvas'), { width: side, height: side }).getContext('webgl2', { antialias: false });
    if (!gl || !gl.getExtension('EXT_color_buffer_float')) throw new Error('no WebGL2 with float targets');
    const vertex = `#version 300 es
      precision highp float; in vec3 place; in vec2 uv; out vec3 at_m; out vec2 on_map; uniform vec4 ball;
      void main() {
        at_m = place; on_map = uv;
        vec3 p = (place - ball.xyz) / ball.w;
        p = vec3(p.x * 0.8 - p.z * 0.6, p.y * 0.96 - (p.x * 0.6 + p.z * 0.8) * 0.28, p.y * 0.28 + (p.x * 0.6 + p.z * 0.8) * 0.96);
        gl_Position = ${view === 'camera' ? 'vec4(1.5 * p.xy, -p.z, 2.0 - 0.5 * p.z)' : 'vec4(2.0 * uv - 1.0, 0.0, 1.0)'};
      }`;
    const sampled = view === 'camera'
      ? `vec2 t = on_map * ${size}.0 - 0.5; vec2 f = t - floor(t); ivec2 c = ivec2(floor(t));
         #define T(x, y) texelFetch(map, clamp(c + ivec2(x, y), 0, ${size - 1}), 0).r
         float felt = mix(mix(T(0, 0), T(1, 0), f.x), mix(T(0, 1), T(1, 1), f.x), f.y);`
      : 'float felt = texelFetch(map, ivec2(gl_FragCoord.xy), 0).r;';
    const fragment = `#version 300 es
      ${shader}
      in vec3 at_m; in vec2 on_map; out vec4 colour; uniform highp sampler2D map;
      void main() { ${sampled} colour = vec4(${height}(${at}), felt, 0.0, 1.0); }`;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const part = gl.createShader(kind);
      gl.shaderSource(part, text);
      gl.compileShader(part);
      if (!gl.getShaderParameter(part, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(part));
      gl.attachShader(program, part);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    for (const [name, numbers, of] of [['place', mesh.places, 3], ['uv', mesh.uvs, 2]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, Float32Array.from(numbers), gl.STATIC_DRAW);
      const place = gl.getAttribLocation(program, name);
      if (place < 0) continue;
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, of, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint16Array.from(mesh.corners), gl.STATIC_DRAW);
    gl.uniform4f(gl.getUniformLocation(program, 'ball'), 0.007, 0.003, 0.005, mesh.r);
    const bytes = Uint8Array.from(atob(map), (c) => c.charCodeAt(0));
    const levels = new Uint16Array(bytes.buffer);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, size, size, 0, gl.RED, gl.FLOAT, Float32Array.from(levels, (level) => level * grey));
    for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, gl.NEAREST);
    // Of the layout, a window in the middle, past the pole's rim.
    const [width, first] = view === 'camera' ? [side, 0] : [size, (size - side) >> 1];
    const target = (format, attachment) => {
      gl.bindRenderbuffer(gl.RENDERBUFFER, gl.createRenderbuffer());
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, width);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, gl.getParameter(gl.RENDERBUFFER_BINDING));
    };
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    target(gl.RGBA32F, gl.COLOR_ATTACHMENT0);
    target(gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT);
    gl.viewport(0, 0, width, width);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(first, first, side, side);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.drawElements(gl.TRIANGLES, mesh.corners.length, gl.UNSIGNED_SHORT, 0);
    const pixels = new Float32Array(4 * side * side);
    gl.readPixels(first, first, side, side, gl.RGBA, gl.FLOAT, pixels);
    if (gl.getError()) throw new Error('WebGL refuses');
    const seen = Array.from({ length: side * side }, (_, i) => [pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 3]]).filter((one) => one[2] === 1);
    const apart = seen.map(([made, felt]) => made - felt).sort((a, b) => a - b);
    const [offset, step] = [apart[apart.length >> 1], 257 * grey];
    const steps = apart.map((one) => Math.abs(one - offset) / step).sort((a, b) => a - b);
    const heights = seen.map(([made]) => made);
    const [low, high] = [heights.reduce((a, b) => Math.min(a, b)), heights.reduce((a, b) => Math.max(a, b))];
    // The picture, as it is seen.
    const canvas = Object.assign(document.createElement('canvas'), { width: side, height: side });
    const picture = new ImageData(side, side);
    for (let i = 0; i < side * side; i++) {
      const level = Math.round((255 * (pixels[4 * i] - low)) / (high - low));
      picture.data.set(pixels[4 * i + 3] === 1 ? [level, level, level, 255] : [40, 60, 90, 255], 4 * ((side - 1 - Math.floor(i / side)) * side + (i % side)));
    }
    canvas.getContext('2d').putImageData(picture, 0, 0);
    return {
      pixels: seen.length, beyond: steps.filter((one) => one > 1).length / seen.length, median: steps[steps.length >> 1], worst: steps.at(-1),
      range: (high - low) / step, png: canvas.toDataURL().split(',')[1],
    };
  }, { shader, height, at, map: map.toString('base64'), grey: told.metres_per_grey, size: Math.sqrt(map.length / 2), view, mesh });
  await page.close();
  writeFileSync(join(PICTURES, `shader-${name}-${view}.png`), Buffer.from(found.png, 'base64'));
  console.log(`${name} ${view}: ${found.pixels} pixels, median ${found.median.toFixed(4)}, worst ${found.worst.toFixed(3)} steps of 8 bit, ${found.range.toFixed(0)} in view`);
  assert.ok(found.pixels > 20000 && found.range > 20, `${name} ${view}: ${found.pixels} pixels, ${found.range} steps`);
  assert.ok(found.beyond <= 1e-3, `${name} ${view}: ${(100 * found.beyond).toFixed(2)} % of the pixels are more than a grey step off, the worst ${found.worst}`);
}

/** Two triangles over the whole map. */
const SHEET = { places: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], uvs: [0, 0, 1, 0, 0, 1, 1, 1], corners: [0, 1, 2, 2, 1, 3], r: 1 };

test('pictures of solids and gratings are drawn as they are felt', async () => {
  for (const [name, more] of [...SOLIDS.map((name) => [name, []]), ...GRATINGS.map((kind) => ['grating', ['--kind', kind]])]) {
    const told = texture('solid', name, ...more, '--size', '256', '-o', 'plane.png');
    const { name: word, shader } = texture('solid', name, ...more, '--shader', 'glsl');
    const at = `gl_FragCoord.xy * ${told.metres_per_px}`;
    await drawn({ shader, height: `${word}_picture`, at, map: grey16('plane.png'), told, view: 'plane', mesh: SHEET, name: more[1] ?? name });
  }
});

test('on a sphere, solids and gratings are seen as the map over it is felt', async () => {
  for (const name of SOLIDS) {
    const mesh = sphere('sphere.glb', radius(name));
    const told = texture('solid', name, '--bake', 'sphere.glb', '--size', String(SIZE), '-o', 'baked.png');
    const { name: word, shader } = texture('solid', name, '--shader', 'glsl');
    const map = grey16('baked.png');
    for (const view of ['layout', 'camera']) await drawn({ shader, height: `${word}_height`, at: 'at_m', map, told, view, mesh, name });
  }
  // A grating lies in its surface's own coordinates.
  for (const kind of GRATINGS) {
    const told = texture('solid', 'grating', '--kind', kind, '--size', String(SIZE), '--width-m', '0.01', '-o', 'grating.png');
    const { shader } = texture('solid', 'grating', '--kind', kind, '--shader', 'glsl');
    await drawn({ shader, height: 'grating_height', at: 'vec3(0.01 * on_map, 0.0)', map: grey16('grating.png'), told, view: 'camera', mesh: sphere('sphere.glb', 2e-3), name: kind });
  }
});
