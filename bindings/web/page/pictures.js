// Height maps drawn in code: every one repeats, none is a photograph.

/** A whole-number hash of two numbers and a seed, 0 to 1. */
function hash(x, y, seed) {
  let h = Math.imul(x, 0x27d4eb2d) ^ Math.imul(y, 0x165667b1) ^ Math.imul(seed, 0x9e3779b1);
  h = Math.imul(h ^ (h >>> 15), 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 13), 0xc2b2ae35);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967295;
}

/** Smooth noise on a grid of `cells` that repeats after 1, 0 to 1. */
export function noise(u, v, cells, seed) {
  const [x, y] = [u * cells[0], v * cells[1]];
  const [i, j] = [Math.floor(x), Math.floor(y)];
  const [a, b] = [x - i, y - j].map((t) => t * t * (3 - 2 * t));
  const at = (p, q) => hash((((i + p) % cells[0]) + cells[0]) % cells[0], (((j + q) % cells[1]) + cells[1]) % cells[1], seed);
  return (at(0, 0) * (1 - a) + at(1, 0) * a) * (1 - b) + (at(0, 1) * (1 - a) + at(1, 1) * a) * b;
}

/** Octaves of it, each half as high as the one before. */
export function fractal(u, v, cells, octaves, seed) {
  let [sum, height, total] = [0, 1, 0];
  for (let k = 0; k < octaves; k++) {
    sum += height * noise(u, v, [cells[0] << k, cells[1] << k], seed + k);
    total += height;
    height *= 0.5;
  }
  return sum / total;
}

/** A 16-bit map of `grey(u, v)`, 0 to 1, at texel centres. */
export function draw(width, height, grey) {
  const samples = new Uint16Array(width * height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const value = grey((x + 0.5) / width, (y + 0.5) / height);
      samples[y * width + x] = Math.round(65535 * Math.min(1, Math.max(0, value)));
    }
  }
  return { width, height, samples };
}

/** Four teeth, each falling off within 6 % of its length. */
export function sawtooth() {
  const fall = 0.06;
  return draw(512, 128, (u) => {
    const phase = (4 * u) % 1;
    return phase < 1 - fall ? phase / (1 - fall) : (1 - phase) / fall;
  });
}

/** One round bump. */
export function bump() {
  return draw(128, 128, (u, v) => {
    const radius = Math.hypot(u - 0.5, v - 0.5) / 0.45;
    return radius < 1 ? 0.5 + 0.5 * Math.cos(Math.PI * radius) : 0;
  });
}

/** Round ribs with sharp valleys. */
export function ribs() {
  return draw(512, 32, (u) => Math.abs(Math.sin(4 * Math.PI * u)));
}

/** Which brick of a running bond a place belongs to, and how far inside it lies, in parts of a course. */
export function brickAt(u, v) {
  const [courses, along] = [4, 2];
  const course = Math.floor(v * courses);
  const shifted = u * along + 0.5 * (course % 2);
  const [x, y] = [shifted - Math.floor(shifted), v * courses - course];
  // A course is 16 mm of 64 mm · 2: a brick is four courses long.
  const inside = Math.min(Math.min(x, 1 - x) * 2, Math.min(y, 1 - y));
  return { brick: [Math.floor(shifted) % along, course], inside };
}

/** Bricks with mortar between, a little uneven and rough. */
export function brick() {
  return draw(512, 512, (u, v) => {
    const wander = 0.012 * (fractal(u, v, [8, 8], 3, 11) - 0.5);
    const { brick, inside } = brickAt((u + wander + 1) % 1, (v + wander + 1) % 1);
    const edge = Math.min(1, Math.max(0, (inside - 0.09) / 0.05));
    const face = 0.72 + 0.12 * hash(brick[0], brick[1], 5) + 0.16 * (fractal(u, v, [48, 48], 3, 3) - 0.5);
    const mortar = 0.28 + 0.2 * (fractal(u, v, [64, 64], 2, 7) - 0.5);
    return mortar + (face - mortar) * edge * edge * (3 - 2 * edge);
  });
}

/** Plain weave: threads over and under. */
export function weave() {
  const threads = 8;
  return draw(256, 256, (u, v) => {
    const [x, y] = [u * threads, v * threads];
    const over = (Math.floor(x) + Math.floor(y)) % 2 === 0;
    const [across, along] = over ? [x % 1, y % 1] : [y % 1, x % 1];
    const round = Math.sin(Math.PI * across) * (0.55 + 0.45 * Math.sin(Math.PI * along));
    return 0.1 + 0.8 * round + 0.1 * (noise(u, v, [96, 96], 2) - 0.5);
  });
}

/** Rough left half, smooth right half. */
export function halves() {
  return draw(64, 8, (u) => (u < 0.5 ? 0.9 : 0.1));
}

/** Somebody's own picture as heights: what is bright is high. */
export function ofImage(image, longest = 512) {
  const scale = Math.min(1, longest / Math.max(image.width, image.height));
  const [width, height] = [image.width, image.height].map((side) => Math.max(8, Math.round(side * scale)));
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(image, 0, 0, width, height);
  const { data } = context.getImageData(0, 0, width, height);
  const grey = (i) => (0.2126 * data[4 * i] + 0.7152 * data[4 * i + 1] + 0.0722 * data[4 * i + 2]) / 255;
  const samples = Uint16Array.from({ length: width * height }, (_, i) => Math.round(65535 * grey(i)));
  return { picture: { width, height, samples }, colours: data };
}
