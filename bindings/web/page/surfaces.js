// The surfaces of the page: each is a scene file, the maps that it names, and how it looks.
import * as pictures from './pictures.js';

/** Rate of every engine of the page: what it plays is the same on every device, and so is what it saves. */
export const RATE_HZ = 48000;
/** Levels of the haptic channel a second, for motors. */
export const LEVELS_HZ = 30;

const FINGER = '';
const STICK = `
[probe]                            # the tip of a stick, not a fingertip
pad_mass_kg = 0.002
pad_stiffness_n_m = 4000.0
pad_damping_n_s_m = 0.5
finger_mass_kg = 0.05
contact_stiffness_n_m = 1e6
`;

/** The text of a scene file. */
function scene(name, { title, body, surface, probe = FINGER, fullScale, gain, tail = 1.5 }) {
  return `# ${title}: saved by the page of asperity web.
sample_rate_hz = ${RATE_HZ}
contacts = "${name}.jsonl"
tail_s = ${tail.toFixed(1)}

[[body]]
name = "body"
${body}

[[surface]]
name = "surface"
body = "body"
${surface}
${probe}
[[actuator]]
output = "displacement"
full_scale = ${fullScale}
limit = true

[audio]
${gain === null ? '' : `gain = ${gain}\n`}limit = true
`;
}

/** Colours between two, by a number from 0 to 1. */
const between = (low, high) => (t) => low.map((c, i) => c + (high[i] - c) * Math.min(1, Math.max(0, t)));

/** Goes from one colour to another where `x` passes `at`, without an edge of texels. */
const blend = (from, to, x, at) => between(from, to)((x - at) / 0.06 + 0.5);

const map = (lines) => (name) => lines.replaceAll('MAP', `${name}.displacement.png`);

const STEEL = { striker: 'steel', mass_kg: 0.008, radius_m: 0.006, restitution: 0.5 };
const WOOD = { striker: 'wood', mass_kg: 0.02, radius_m: 0.012, restitution: 0.5 };

/**
 * `size_m`: what one repetition spans; `wavelength_m`: for the marker at v/λ, where there is one; `draw`: its map; `colour(height, u, v)`: height
 * from 0 to 1; `shine`: how glossy; `steep`: how much steeper than it is it is drawn.
 */
export const SURFACES = [
  {
    id: 'sawtooth', name: 'Sawtooth', note: '1 mm teeth, 7 mm apart. One way you fall off each, the other way you climb.',
    size_m: [0.028, 0.007], wavelength_m: 0.007, draw: pictures.sawtooth,
    body: 'stock = "disc"\nsize_m = 0.14\nmaterial = "pla"',
    surface: map('displacement = "MAP"\nrelief_m = 0.001\nroughness = 0.5\nwidth_m = 0.028\nheight_m = 0.007'),
    fullScale: 0.002, gain: 0.12, blow: STEEL, colour: between([38, 92, 122], [120, 190, 214]), shine: 0.5,
  },
  {
    id: 'bumps', name: 'Bumps', note: 'Round bumps on a 7 mm grid: the rhythm rises with your speed.',
    size_m: [0.007, 0.007], wavelength_m: 0.007, draw: pictures.bump,
    body: 'stock = "disc"\nsize_m = 0.14\nmaterial = "plastic"',
    surface: map('displacement = "MAP"\nrelief_m = 0.001\nroughness = 0.5\nwidth_m = 0.007\nheight_m = 0.007'),
    fullScale: 0.002, gain: 0.1, blow: STEEL, colour: between([150, 62, 48], [236, 148, 110]), shine: 0.6,
  },
  {
    id: 'halves', name: 'Matte, shiny', note: 'No relief at all: the bright stripes are rough, the dark ones smooth.',
    size_m: [0.08, 0.01], draw: pictures.halves, isRoughness: true,
    body: 'stock = "disc"\nsize_m = 0.14\nmaterial = "pla"',
    surface: (name) => `roughness = "${name}.roughness.png"\nwidth_m = 0.08\nheight_m = 0.01`,
    fullScale: 5e-4, gain: 0.045, blow: STEEL, colour: between([24, 26, 34], [126, 128, 138]), shine: 0.9, steep: 0,
  },
  {
    id: 'brick', name: 'Brick', note: 'Bricks of a doll’s house, 64 mm long, with mortar between.',
    size_m: [0.128, 0.128], draw: pictures.brick,
    body: 'stock = "block"\nsize_m = 0.21\nmaterial = "brick"',
    surface: map('displacement = "MAP"\nrelief_m = 0.003\nroughness = 0.9\nwidth_m = 0.128\nheight_m = 0.128'),
    fullScale: 0.004, gain: 1.3, blow: STEEL, shine: 0.05,
    colour: (h, u, v) => {
      const { brick, inside } = pictures.brickAt(u, v);
      const tint = ((brick[0] * 7 + brick[1] * 5) % 6) * 7;
      return inside < 0.11 ? [172, 164, 152] : between([108 + tint, 48, 36], [186 + tint, 96, 72])(h);
    },
  },
  {
    id: 'weave', name: 'Cloth', note: 'A coarse plain weave over a wooden board, threads 1.5 mm apart.',
    size_m: [0.012, 0.012], wavelength_m: 0.003, draw: pictures.weave,
    body: 'stock = "plate"\nsize_m = 0.3\nmaterial = "softwood"',
    surface: map('displacement = "MAP"\nrelief_m = 0.0004\nroughness = 0.8\nwidth_m = 0.012\nheight_m = 0.012'),
    fullScale: 5e-4, gain: 0.08, blow: WOOD, colour: between([66, 70, 104], [196, 194, 206]), shine: 0.02,
  },
  {
    id: 'granite', name: 'Granite', note: 'Solid noise, cut anywhere: no two places are the same.',
    size_m: [0.3, 0.3],
    body: 'stock = "block"\nsize_m = 0.2\nmaterial = "stone"',
    surface: () => 'solid = "granite"\nwidth_m = 0.3\nheight_m = 0.3',
    fullScale: 1.5e-4, gain: 40, blow: STEEL, shine: 0.35,
    colour: (h, u, v) => {
      const grain = pictures.fractal(u, v, [128, 128], 3, 21);
      const pale = blend(between([126, 118, 118], [176, 166, 162])(h), [214, 196, 188], grain, 0.6);
      return blend([46, 44, 46], pale, grain, 0.37);
    },
  },
  {
    id: 'wood', name: 'Wood', note: 'Along the grain it is quiet, across it sings.',
    size_m: [0.3, 0.3],
    body: 'stock = "bar"\nsize_m = 0.4\nmaterial = "wood"',
    surface: () => 'solid = "wood"\nwidth_m = 0.3\nheight_m = 0.3',
    fullScale: 5e-5, gain: 25, blow: WOOD, colour: between([92, 54, 28], [214, 156, 96]), shine: 0.2,
  },
  {
    id: 'sand', name: 'Sand', note: 'It keeps your furrow. Press hard, write something.',
    size_m: [0.3, 0.3], clamps: true, watch: true,
    body: 'stock = "plate"\nsize_m = 0.3\nmaterial = "softwood"',
    surface: () => `sand = { cells = 256, depth_m = 0.03, talus_deg = 32.0, stiffness_n = 60.0, exponent_per_m = 20.0, tool_radius_m = 0.008 }
width_m = 0.3
height_m = 0.3
wrap = "clamp"`,
    fullScale: 2e-4, gain: 3, shine: 0,
    colour: (h, u, v) => between([186, 140, 86], [246, 216, 164])(0.6 * h + 0.8 * (pictures.fractal(u, v, [256, 256], 2, 5) - 0.3)),
  },
  {
    id: 'gravel', name: 'Gravel', note: 'Stones under a stick.',
    size_m: [0.3, 0.3], probe: STICK,
    body: 'stock = "block"\nsize_m = 0.12\nmaterial = "stone"',
    surface: () => 'solid = "gravel"\nwidth_m = 0.3\nheight_m = 0.3',
    fullScale: 0.001, gain: 8, blow: STEEL, colour: between([84, 82, 84], [186, 182, 174]), shine: 0.15,
  },
  {
    id: 'bell', name: 'Bell', note: 'Ribs on a brass bowl: scrape them with a stick, or strike the bowl.',
    size_m: [0.016, 0.001], wavelength_m: 0.004, draw: pictures.ribs, probe: STICK,
    body: 'stock = "bowl"\nsize_m = 0.14\nmaterial = "brass"',
    surface: map('displacement = "MAP"\nrelief_m = 0.0006\nroughness = 0.4\nwidth_m = 0.016\nheight_m = 0.001'),
    fullScale: 0.003, gain: 0.045, tail: 3, blow: STEEL, colour: between([128, 92, 30], [248, 214, 122]), shine: 1,
  },
  solidSurface('bowl', 'Bowl', 'Solved from its mesh here: rim, wall and bottom ring differently. Drag beside it to turn it.'),
];

/** A body of unglazed stoneware, from a mesh: `modes`, once it is solved, are its own, with shapes. */
export function solidSurface(id, name, note) {
  return {
    id, name, note, size_m: [0.3, 0.3], isSolid: true,
    body: 'stock = "bowl"\nsize_m = 0.14\nmaterial = "ceramic"',
    surface: () => 'solid = "granite"\nwidth_m = 0.3\nheight_m = 0.3',
    fullScale: 1.5e-4, gain: 10, blow: STEEL, colour: between([52, 60, 66], [92, 102, 108]), shine: 0,
    // Seen from above, half of it glazed.
    icon: { size_m: [0.3, 0.3], colour: (h, u) => (u < 0.25 ? [214, 204, 184] : [76, 120, 143]) },
  };
}

/** A surface of somebody's own picture. */
export function ownSurface({ picture, colours }) {
  const width_m = 0.12;
  const height_m = (width_m * picture.height) / picture.width;
  return {
    id: 'own', name: 'Your picture', note: 'What is bright is high: 1 mm from black to white.',
    size_m: [width_m, height_m], draw: () => picture, isOwn: true,
    body: 'stock = "plate"\nsize_m = 0.2\nmaterial = "ceramic"',
    surface: map(`displacement = "MAP"\nrelief_m = 0.001\nroughness = 0.5\nwidth_m = ${width_m}\nheight_m = ${height_m}\nwrap = "mirror"`),
    fullScale: 0.001, gain: 5, blow: STEEL, shine: 0.2, mirrors: true,
    colour: (h, u, v) => {
      const [x, y] = [Math.floor(u * picture.width), Math.floor(v * picture.height)];
      const at = 4 * (Math.min(y, picture.height - 1) * picture.width + Math.min(x, picture.width - 1));
      return [colours[at], colours[at + 1], colours[at + 2]];
    },
  };
}

/** A surface of a photograph: heights and roughness as the offline tools found them. */
export function photoSurface(drawn, { displacement, roughness, relief_m, micro_relief_m }) {
  const own = ownSurface(drawn);
  const [width_m, height_m] = own.size_m;
  const numbers = [`relief_m = ${relief_m}`, `micro_relief_m = ${micro_relief_m}`, `width_m = ${width_m}`, `height_m = ${height_m}`, 'wrap = "mirror"'];
  return {
    ...own, name: 'Your photograph', note: 'Heights found from light and shade, roughness from how they fall off.',
    draw: () => displacement, roughness, fullScale: Math.max(1e-4, relief_m), gain: null,
    surface: (name) => [`displacement = "${name}.displacement.png"`, `roughness = "${name}.roughness.png"`, ...numbers].join('\n'),
  };
}

/** What is saved and opened: the scene's text, and the maps beside it by the names of their files. */
export function sceneOf(surface, name, modes) {
  const wraps = surface.clamps || surface.mirrors ? '' : '\nwrap = "repeat"';
  const body = modes === undefined ? surface.body : `modes = "${name}.modes.json"\nmaterial = "ceramic"`;
  // How loud a body of one's own is nobody knows: the engine finds a gain.
  const gain = modes === undefined ? surface.gain : null;
  const text = scene(name, { ...surface, gain, title: surface.name, body, surface: surface.surface(name) + wraps });
  const maps = {};
  if (surface.draw) maps[`${name}.${surface.isRoughness ? 'roughness' : 'displacement'}.png`] = surface.draw();
  if (surface.roughness) maps[`${name}.roughness.png`] = surface.roughness;
  return { text, pictures: maps, files: modes === undefined ? {} : { [`${name}.modes.json`]: modes } };
}
