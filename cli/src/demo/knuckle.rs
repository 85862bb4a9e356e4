//! A knuckle that knocks: on what rings, and on what hardly does.

use super::demo_scene::DemoScene;
use super::scenes::{LEAD_S, strike};
use super::strokes::log;

/// Bodies in the order of the knocks: name, stock shape, its size in metres, material.
const BODIES: [(&str, &str, f64, &str); 4] = [
    ("door", "door", 2.0, "wood"),
    ("can", "can", 0.11, "steel"),
    ("box", "box", 0.4, "cardboard"),
    ("curtain", "sheet", 0.5, "cloth"),
];
/// Knocks on each, and the time from one to the next, s.
const KNOCKS: (usize, f64) = (3, 0.22);
/// Mass behind a knuckle and its radius, kg and m (assumed); skin over bone answers like rubber.
const KNUCKLE: (f64, f64) = (0.06, 0.01);

/// The scene.
pub fn scene() -> DemoScene {
    let mut toml = "# A knuckle on four things. Knocks are equal in the log; `variation` lets each sound a little different.\n\
                    contacts = \"knuckle.jsonl\"\ntail_s = 0.8\n\n"
        .to_owned();
    let mut lines = Vec::new();
    let mut t = LEAD_S;
    for (name, stock, size_m, material) in BODIES {
        toml += &format!(
            "[[body]]\nname = \"{name}\"\nstock = \"{stock}\"\nsize_m = {size_m:?}\nmaterial = \"{material}\"\nvariation = 0.5\n\n"
        );
        for _ in 0..KNOCKS.0 {
            lines.push(strike((t * 1e4f64).round() / 1e4, name, 0.8, "rubber", KNUCKLE));
            t += KNOCKS.1;
        }
        t += 0.6;
    }
    toml += "[audio]\ngain = 0.5\n";
    DemoScene {
        name: "knuckle",
        title: "A knuckle on wood, a can, cardboard and cloth",
        notice: "Three equal knocks each on a wooden door, a tin can, a cardboard box and a curtain. Door and can ring, the box hardly, \
                 the curtain not at all: it is noise that is gone at once. No knock is quite the one before (`variation`).",
        toml,
        log: log(lines),
        assets: Vec::new(),
    }
}
