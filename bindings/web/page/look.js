// The surface as it looks: lit from where the finger is. Its normals come from the heights that are felt.

/** CSS pixels a metre: about what a screen has, so that things are about as large as they are. */
export const PIXELS_A_METRE = 6500;
/** The same number of texels for every picture that is not a map of its own. */
export const RELIEF_TEXELS = 512;
/** Mean steepness that every surface is drawn with, whatever it is. */
const STEEPNESS = 0.32;

const VERTEX = `#version 300 es
in vec2 at; void main() { gl_Position = vec4(at, 0.0, 1.0); }`;
const FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D normals, colours; uniform vec2 size, texels, origin, light; uniform float scale, shine; uniform vec3 touches[4];
out vec4 shown;
void main() {
  vec2 pixel = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) / scale;
  vec2 uv = (pixel - origin) / texels;
  vec4 n4 = texture(normals, uv);
  vec3 n = normalize(vec3((n4.xy * 255.0 - 128.0) / 127.0 * 2.0, 1.0));
  vec3 toLight = vec3(light - pixel, 220.0);
  float near = 1.0 / (1.0 + dot(toLight.xy, toLight.xy) / 360000.0);
  vec3 l = normalize(toLight);
  float lit = max(dot(n, l), 0.0);
  float gloss = pow(max(dot(reflect(-l, n), vec3(0.0, 0.0, 1.0)), 0.0), 24.0);
  vec3 c = texture(colours, uv).rgb * (0.26 + (0.30 + 0.62 * near) * lit) + shine * 0.55 * gloss * near;
  for (int i = 0; i < 4; i++) {
    float d = length(pixel - touches[i].xy);
    if (touches[i].z > 0.0) c = mix(c, c * 0.55, 0.8 * (1.0 - smoothstep(touches[i].z * 0.5, touches[i].z, d)));
  }
  shown = vec4(c, 1.0);
}`;

/** Slopes of heights on a grid that repeats, as bytes of red and green. */
function normalsOf({ width, height, heights }, metresATexel, gain, wraps) {
  const bytes = new Uint8Array(4 * width * height);
  const side = (i, n) => (wraps ? (i + n) % n : Math.min(n - 1, Math.max(0, i)));
  const byte = (slope) => 128 + Math.round(63.5 * Math.max(-2, Math.min(2, -slope * gain)));
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const at = (i, j) => heights[side(j, height) * width + side(i, width)];
      const i = 4 * (y * width + x);
      bytes[i] = byte((at(x + 1, y) - at(x - 1, y)) / (2 * metresATexel[0]));
      bytes[i + 1] = byte((at(x, y + 1) - at(x, y - 1)) / (2 * metresATexel[1]));
      bytes[i + 3] = 255;
    }
  }
  return bytes;
}

function steepness({ width, height, heights }, metresATexel) {
  let sum = 0;
  for (let i = 0; i + 1 < width * height; i++) sum += ((heights[i + 1] - heights[i]) / metresATexel[0]) ** 2;
  return Math.sqrt(sum / (width * height)) || 1;
}

/** Heights, normals and colours of a surface: what is drawn. */
export function lookOf(surface, relief) {
  const picture = surface.draw?.();
  const grid = relief ?? (surface.isRoughness
    ? { width: picture.width, height: picture.height, heights: Float32Array.from(picture.samples, () => 0) }
    : { width: picture.width, height: picture.height, heights: Float32Array.from(picture.samples, (s) => s / 65535) });
  const metres = [surface.size_m[0] / grid.width, surface.size_m[1] / grid.height];
  const gain = surface.watch && grid.width > 64 ? 3 : surface.isRoughness ? 0 : STEEPNESS / steepness(grid, metres);
  let [low, high] = [Infinity, -Infinity];
  for (const h of grid.heights) [low, high] = [Math.min(low, h), Math.max(high, h)];
  const colours = new Uint8Array(4 * grid.width * grid.height);
  for (let y = 0, i = 0; y < grid.height; y++) {
    for (let x = 0; x < grid.width; x++, i++) {
      const level = surface.isRoughness ? picture.samples[i] / 65535 : (grid.heights[i] - low) / (high - low || 1);
      colours.set(surface.colour(surface.watch ? 0.8 : level, x / grid.width, y / grid.height), 4 * i);
      colours[4 * i + 3] = 255;
    }
  }
  return { grid, metres, gain, colours, normals: normalsOf(grid, metres, gain, !surface.clamps), surface };
}

/** A small round picture for a button. */
export function thumbnail(canvas, look) {
  [canvas.width, canvas.height] = [52, 52];
  const context = canvas.getContext('2d');
  const image = context.createImageData(52, 52);
  const { grid, normals, colours, surface } = look;
  const span = surface.draw ? Math.min(0.03, surface.size_m[0] * 2) : surface.size_m[0] * 0.5;
  for (let y = 0, i = 0; y < 52; y++) {
    for (let x = 0; x < 52; x++, i++) {
      const [u, v] = [(x / 52) * span / surface.size_m[0], (y / 52) * span / surface.size_m[1]];
      const at = 4 * (Math.floor((v % 1) * grid.height) * grid.width + Math.floor((u % 1) * grid.width));
      const lit = 0.85 + (normals[at] - 128 + normals[at + 1] - 128) / 190;
      for (let c = 0; c < 3; c++) image.data[4 * i + c] = colours[at + c] * lit;
      image.data[4 * i + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
}

/** Draws looks into a canvas. */
export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.light = [300, 160];
    this.touches = new Map();
    this.sharpness = 1;
    this.gl = canvas.getContext('webgl2', { antialias: false, alpha: false, powerPreference: 'low-power' });
    if (this.gl) this.compile();
    else this.flat = canvas.getContext('2d');
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => { this.compile(); if (this.look) this.show(this.look); });
  }

  compile() {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.bindAttribLocation(program, 0, 'at');
    gl.vertexAttribPointer(gl.getAttribLocation(program, 'at'), 2, gl.FLOAT, false, 0, 0);
    this.at = new Proxy({}, { get: (known, name) => (known[name] ??= gl.getUniformLocation(program, name)) });
    gl.uniform1i(this.at.colours, 1);
    this.textures = [gl.createTexture(), gl.createTexture()];
  }

  /** Another look. */
  show(look) {
    this.look = look;
    this.dirty = true;
    const { grid, normals, colours, surface } = look;
    if (!this.gl) return this.showFlat(look);
    const { gl } = this;
    const wrap = surface.clamps ? gl.CLAMP_TO_EDGE : surface.mirrors ? gl.MIRRORED_REPEAT : gl.REPEAT;
    [normals, colours].forEach((bytes, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, this.textures[unit]);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, grid.width, grid.height, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, axis, wrap);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, surface.watch ? gl.LINEAR : gl.LINEAR_MIPMAP_LINEAR);
      if (!surface.watch) gl.generateMipmap(gl.TEXTURE_2D);
    });
  }

  /** Without WebGL: lit once, from the left. */
  showFlat({ grid, normals, colours, surface }) {
    const tile = new OffscreenCanvas(grid.width, grid.height);
    const context = tile.getContext('2d');
    const image = context.createImageData(grid.width, grid.height);
    for (let i = 0; i < colours.length; i += 4) {
      const lit = 0.8 + (normals[i] - 128 + normals[i + 1] - 128) / 160;
      for (let c = 0; c < 3; c++) image.data[i + c] = colours[i + c] * lit;
      image.data[i + 3] = 255;
    }
    context.putImageData(image, 0, 0);
    this.pattern = this.flat.createPattern(tile, 'repeat');
    const [w, h] = surface.size_m.map((m) => m * PIXELS_A_METRE);
    this.pattern.setTransform(new DOMMatrix().translate(...this.origin()).scale(w / grid.width, h / grid.height));
  }

  /** Tiles of a surface that changes: heights in metres above its bottom. */
  change(tiles) {
    const { grid, metres, gain, surface } = this.look;
    this.lowest ??= null;
    for (let i = 0; i < tiles.length; ) {
      const [x, y, columns, rows] = tiles.subarray(i, i + 4);
      i += 4;
      for (let r = 0; r < rows; r++, i += columns) grid.heights.set(tiles.subarray(i, i + columns), (y + r) * grid.width + x);
    }
    this.look.normals = normalsOf(grid, metres, gain, !surface.clamps);
    if (!this.gl) return this.showFlat(this.look);
    this.gl.activeTexture(this.gl.TEXTURE0);
    this.gl.bindTexture(this.gl.TEXTURE_2D, this.textures[0]);
    this.gl.texImage2D(this.gl.TEXTURE_2D, 0, this.gl.RGBA, grid.width, grid.height, 0, this.gl.RGBA, this.gl.UNSIGNED_BYTE, this.look.normals);
    this.dirty = true;
  }

  /** Where uv (0, 0) lies, CSS pixels: a surface that ends is in the middle. */
  origin() {
    const { surface } = this.look;
    if (!surface.clamps) return [0, 0];
    const { clientWidth, clientHeight } = this.canvas;
    return [(clientWidth - surface.size_m[0] * PIXELS_A_METRE) / 2, (clientHeight - surface.size_m[1] * PIXELS_A_METRE) / 2];
  }

  /** Texture coordinates of a place in CSS pixels. */
  uvOf([x, y]) {
    const { surface } = this.look;
    const [x0, y0] = this.origin();
    const uv = [(x - x0) / (surface.size_m[0] * PIXELS_A_METRE), (y - y0) / (surface.size_m[1] * PIXELS_A_METRE)];
    return surface.clamps ? uv.map((t) => Math.min(0.995, Math.max(0.005, t))) : uv;
  }

  draw() {
    if (!this.look || !this.dirty) return;
    this.dirty = false;
    const { canvas, gl } = this;
    const began = performance.now();
    const scale = this.sharpness * Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * scale)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    if (!gl) {
      this.flat.setTransform(scale, 0, 0, scale, 0, 0);
      this.flat.fillStyle = this.pattern;
      this.flat.fillRect(0, 0, width, height);
      return;
    }
    const { surface } = this.look;
    gl.viewport(0, 0, width, height);
    gl.uniform2f(this.at.size, width, height);
    gl.uniform1f(this.at.scale, scale);
    gl.uniform2fv(this.at.texels, surface.size_m.map((m) => m * PIXELS_A_METRE));
    gl.uniform2fv(this.at.origin, this.origin());
    gl.uniform2fv(this.at.light, this.light);
    gl.uniform1f(this.at.shine, surface.shine);
    const rings = new Float32Array(12);
    [...this.touches.values()].slice(0, 4).forEach(([x, y, radius], i) => rings.set([x, y, radius], 3 * i));
    gl.uniform3fv(this.at.touches, rings);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    // Where a processor draws, it draws fewer pixels rather than let the sound wait.
    gl.flush();
    const took = performance.now() - began;
    if (took > 24 && this.sharpness > 0.3) this.sharpness *= 0.8;
  }
}
