// A body from a mesh: solved in a worker, drawn as it stands, turned by a drag beside it, hit and stroked where the pointer is on it.

/** How much of the window it takes, and how large it is at most, CSS pixels a metre. */
const [PART, MOST_PIXELS_A_METRE] = [0.86, 6500];
/** Turned so far by a drag of a pixel, rad. */
const TURN = 1 / 140;
/** Faces that meet at less than this are one smooth surface: cosine. */
const SMOOTH = 0.8;
/** How it is looked at first: around and from above, rad. */
const FIRST = [0.4, 0.55];
const TINT = [0.84, 0.8, 0.72];
/** Half of it is glazed: one sees it turn. */
const GLAZE = [0.3, 0.47, 0.56];

const VERTEX = `#version 300 es
in vec3 place, normal; uniform mat3 turned; uniform vec3 middle; uniform vec2 size; uniform float pixels, depth;
out vec3 n; out vec2 pixel; out float side;
void main() {
  vec3 p = turned * (place - middle);
  n = turned * normal;
  side = (place.x - middle.x) * pixels + 0.1 * (place.z - middle.z) * pixels;
  pixel = vec2(0.5 * size.x + p.x * pixels, 0.5 * size.y - p.y * pixels);
  gl_Position = vec4(2.0 * p.x * pixels / size.x, 2.0 * p.y * pixels / size.y, -p.z / depth, 1.0);
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 n; in vec2 pixel; in float side; uniform vec2 light; uniform vec3 tint, glaze, touches[4]; out vec4 shown;
void main() {
  vec3 l = normalize(vec3(light.x - pixel.x, pixel.y - light.y, 260.0));
  vec3 m = normalize(n);
  float gloss = pow(max(dot(reflect(-l, m), vec3(0.0, 0.0, 1.0)), 0.0), 40.0);
  vec3 c = mix(tint, glaze, smoothstep(-1.5, 1.5, side)) * (0.3 + 0.25 * max(m.z, 0.0) + 0.5 * max(dot(m, l), 0.0)) + 0.35 * gloss;
  for (int i = 0; i < 4; i++) if (touches[i].z > 0.0) c = mix(c, c * 0.5, 0.8 * (1.0 - smoothstep(touches[i].z * 0.5, touches[i].z, length(pixel - touches[i].xy))));
  shown = vec4(c, 1.0);
}`;

/** A bowl of 14 cm with a wall of 6 mm, in metres: a part of a hollow ball, its faces outwards; the text of an OBJ file. */
export function bowl([radius, wall, rim, rings, around] = [0.07, 0.006, -0.1, 9, 32]) {
  const height = (ring) => -Math.PI / 2 + (Math.PI / 2 + rim) * (ring + 1) / rings;
  const outside = Array.from({ length: rings }, (_, ring) => [radius, height(ring)]);
  const turns = [...outside, ...outside.map(([, h]) => [radius - wall, h]).reverse()];
  const lines = ['v 0 0 0'];
  for (const [r, h] of turns) {
    for (let i = 0; i < around; i++) {
      const a = (2 * Math.PI * i) / around;
      lines.push(`v ${[r * Math.cos(h) * Math.cos(a), r * Math.cos(h) * Math.sin(a), radius + r * Math.sin(h)].map((x) => x.toFixed(5)).join(' ')}`);
    }
  }
  lines.push(`v 0 0 ${wall}`);
  const at = (ring, i) => 2 + ring * around + (i % around);
  for (let i = 0; i < around; i++) {
    lines.push(`f 1 ${at(0, i + 1)} ${at(0, i)}`);
    for (let ring = 0; ring + 1 < turns.length; ring++) {
      const [a, b, c, d] = [at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)];
      lines.push(`f ${a} ${b} ${c}`, `f ${a} ${c} ${d}`);
    }
    lines.push(`f ${2 + turns.length * around} ${at(turns.length - 1, i)} ${at(turns.length - 1, i + 1)}`);
  }
  return `${lines.join('\n')}\n`;
}

/** Lets the worker solve a mesh; the text of its modes file, what was mended or is doubted, and what was found. */
export async function solved(ask, name, bytes) {
  const { modes, told, mass_kg } = await ask({ solve: { name, bytes } });
  const hz = JSON.parse(modes).modes.map(({ frequency_hz }) => Math.round(frequency_hz));
  const found = `${hz.length} modes from ${hz[0]} to ${hz.at(-1)} Hz, ${Math.round(1e3 * mass_kg)} g of stoneware`;
  return { modes, told, found };
}

/** Corners of triangles, three numbers each, with normals that are smooth where the surface is. */
function corners(points, triangles) {
  const sub = (a, b) => a.map((x, k) => x - b[k]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => { const l = Math.sqrt(dot(a, a)) || 1; return a.map((x) => x / l); };
  const areas = triangles.map(([a, b, c]) => {
    const [u, v] = [sub(points[b], points[a]), sub(points[c], points[a])];
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  });
  const units = areas.map(unit);
  const faces = points.map(() => []);
  triangles.forEach((corner, f) => corner.forEach((point) => faces[point].push(f)));
  const [places, normals] = [[], []];
  triangles.forEach((corner, f) => corner.forEach((point) => {
    const sum = [0, 0, 0];
    for (const g of faces[point]) if (dot(units[f], units[g]) > SMOOTH) areas[g].forEach((x, k) => { sum[k] += x; });
    places.push(...points[point]);
    normals.push(...unit(sum));
  }));
  return { places: new Float32Array(places), normals: new Float32Array(normals) };
}

/** The body on the page: a canvas over the surface's. */
export class Solid {
  /** `picture`: the one below; `scaled(pixels a metre)` hears how large it is shown. */
  constructor(picture, scaled) {
    Object.assign(this, { picture, scaled });
    this.canvas = document.createElement('canvas');
    this.canvas.id = 'solid';
    this.canvas.setAttribute('aria-hidden', 'true');
    picture.canvas.after(this.canvas);
    this.gl = this.canvas.getContext('webgl2', { antialias: true, alpha: true, premultipliedAlpha: true });
    this.flat = this.gl ? null : this.canvas.getContext('2d');
    if (this.gl) this.compile();
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', () => { this.compile(); if (this.points) this.load(); });
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
    gl.enable(gl.DEPTH_TEST);
    this.buffers = ['place', 'normal'].map((name) => [gl.getAttribLocation(program, name), gl.createBuffer()]);
    this.at = new Proxy({}, { get: (known, name) => (known[name] ??= gl.getUniformLocation(program, name)) });
  }

  /** Shows the body of a modes file with shapes. */
  show(modes) {
    const { points_m, triangles } = JSON.parse(modes).shapes;
    [this.points, this.triangles, this.turned] = [points_m, triangles, [...FIRST]];
    const sides = [0, 1, 2].map((k) => points_m.reduce(([low, high], p) => [Math.min(low, p[k]), Math.max(high, p[k])], [Infinity, -Infinity]));
    this.middle = sides.map(([low, high]) => (low + high) / 2);
    this.reach = Math.max(...points_m.map((p) => Math.hypot(...p.map((x, k) => x - this.middle[k]))));
    [this.last, this.laid] = [points_m[0], ''];
    this.canvas.hidden = false;
    this.load();
  }

  load() {
    const { gl } = this;
    this.dirty = true;
    if (!gl) return;
    const made = corners(this.points, this.triangles);
    [made.places, made.normals].forEach((numbers, i) => {
      const [at, buffer] = this.buffers[i];
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
    });
  }

  hide() {
    this.canvas.hidden = true;
    this.points = null;
  }

  /** Rows of the rotation: right, up, towards whoever looks. */
  rows() {
    const [[c, s], [e, f]] = this.turned.map((angle) => [Math.cos(angle), Math.sin(angle)]);
    return [[c, -s, 0], [s * f, c * f, e], [-s * e, -c * e, f]];
  }

  /** Where every point is on the screen, anew when something has moved. */
  lay() {
    const { clientWidth: w, clientHeight: h } = this.picture.canvas;
    const key = `${w} ${h} ${this.turned}`;
    if (key === this.laid) return;
    this.laid = key;
    this.pixels = Math.min(MOST_PIXELS_A_METRE, (PART * Math.min(w, h)) / (2 * this.reach));
    const rows = this.rows();
    this.screen = this.points.map((p) => {
      const [x, y, z] = rows.map((row) => row.reduce((sum, r, k) => sum + r * (p[k] - this.middle[k]), 0));
      return [w / 2 + x * this.pixels, h / 2 - y * this.pixels, z];
    });
    this.scaled(this.pixels);
  }

  /** The place in the body's frame under a place on the screen, m; none where there is nothing. */
  hit([x, y]) {
    this.lay();
    let [nearest, found] = [-Infinity, null];
    for (const corner of this.triangles) {
      const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [this.screen[corner[0]], this.screen[corner[1]], this.screen[corner[2]]];
      const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (area === 0) continue;
      const v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area;
      const w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area;
      if (v < 0 || w < 0 || v + w > 1) continue;
      const z = az + v * (bz - az) + w * (cz - az);
      if (z > nearest) [nearest, found] = [z, { corner, v, w }];
    }
    if (!found) return null;
    const [a, b, c] = found.corner.map((point) => this.points[point]);
    return a.map((p, k) => Number((p + found.v * (b[k] - p) + found.w * (c[k] - p)).toFixed(6)));
  }

  /** What a finger there touches, for an event; `on` is false beside the body. */
  place(at) {
    const found = this.hit(at);
    this.last = found ?? this.last;
    return { on: found !== null, uv: at.map((x) => x / this.pixels / 0.3), at_m: this.last };
  }

  turn(x, y) {
    const [around, above] = this.turned;
    this.turned = [around + x * TURN, Math.max(-1.5, Math.min(1.5, above + y * TURN))];
    this.dirty = true;
  }

  /** Before the picture below is drawn: it moves and is lit with that. */
  draw() {
    const { gl, canvas, picture } = this;
    if (!this.points || !(this.dirty || picture.dirty)) return;
    this.dirty = false;
    this.lay();
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const size = [picture.canvas.clientWidth, picture.canvas.clientHeight];
    const [width, height] = size.map((side) => Math.max(1, Math.round(side * scale)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    if (!gl) { this.paint(scale, size); return; }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const rows = this.rows();
    gl.uniformMatrix3fv(this.at.turned, false, [0, 1, 2].flatMap((column) => rows.map((row) => row[column])));
    gl.uniform3fv(this.at.middle, this.middle);
    gl.uniform2fv(this.at.size, size);
    gl.uniform1f(this.at.pixels, this.pixels);
    gl.uniform1f(this.at.depth, 1.1 * this.reach);
    gl.uniform2fv(this.at.light, picture.light);
    gl.uniform3fv(this.at.tint, TINT);
    gl.uniform3fv(this.at.glaze, GLAZE);
    const rings = new Float32Array(12);
    [...picture.touches.values()].slice(0, 4).forEach((ring, i) => rings.set(ring, 3 * i));
    gl.uniform3fv(this.at.touches, rings);
    gl.drawArrays(gl.TRIANGLES, 0, 3 * this.triangles.length);
  }

  /** Without WebGL: triangles from the farthest, each in one shade. */
  paint(scale, [width, height]) {
    const { flat, screen } = this;
    flat.setTransform(scale, 0, 0, scale, 0, 0);
    flat.clearRect(0, 0, width, height);
    const depth = (corner) => corner.reduce((sum, point) => sum + screen[point][2], 0);
    for (const corner of [...this.triangles].sort((a, b) => depth(a) - depth(b))) {
      const [a, b, c] = corner.map((point) => screen[point]);
      const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
      const slope = Math.hypot(b[2] - a[2], c[2] - a[2]) * this.pixels / (Math.sqrt(Math.abs(area)) || 1);
      const shade = Math.round(90 + 130 / (1 + slope * slope));
      flat.fillStyle = flat.strokeStyle = `rgb(${shade} ${Math.round(shade * 0.95)} ${Math.round(shade * 0.86)})`;
      flat.beginPath();
      for (const [x, y] of [a, b, c]) flat.lineTo(x, y);
      flat.closePath();
      flat.fill();
      flat.stroke();
    }
    for (const [x, y, radius] of this.picture.touches.values()) {
      flat.fillStyle = '#0006';
      flat.beginPath();
      flat.arc(x, y, radius * 0.8, 0, 7);
      flat.fill();
    }
  }
}
