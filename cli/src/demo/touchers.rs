//! One plate under four things: what touches decides what is heard.

use super::demo_scene::DemoScene;
use super::strokes::{Finger, log};
use asperity::files::contact_log::LogEvent;

/// Side of the plate, m.
const SIDE_M: f64 = 0.3;
/// Pause between two strokes, s.
const PAUSE_S: f64 = 0.3;
/// Probe presets in the order in which they stroke.
const TOUCHERS: [&str; 4] = ["fingertip", "fingernail", "stylus", "steel-rod"];

/// A wooden plate, stroked across and back by a finger, a nail, a pen and a steel rod.
pub fn scene() -> DemoScene {
    let mut toml = "# One stroke, four things: only the probe differs.\n\
                    contacts = \"touchers.jsonl\"\n\
                    tail_s = 0.4\n\n\
                    [[body]]\n\
                    name = \"board\"\n\
                    stock = \"plate\"\n\
                    size_m = 0.3\n\
                    material = \"wood\"\n\n\
                    [[surface]]\n\
                    name = \"board\"\n\
                    body = \"board\"\n\
                    width_m = 0.3\n\
                    height_m = 0.3\n\n"
        .to_owned();
    let (mut lines, mut start_s) = (Vec::new(), 0.15);
    for (contact, preset) in (1..).zip(TOUCHERS) {
        toml += &format!("[[probe]]\nname = \"{preset}\"\npreset = \"{preset}\"\n\n");
        let finger = Finger {
            contact,
            surface: "board",
            extent_m: [SIDE_M; 2],
            start_s,
            normal_force_n: 1.0,
            from_m: [0.06, 0.12],
            strokes: vec![([0.18, 0.125], 0.1), ([0.06, 0.13], 0.2)],
        };
        let mut stroke = finger.lines();
        for line in &mut stroke {
            if let LogEvent::Begin { touching, .. } = &mut line.event {
                touching.hand.probe = Some(preset.to_owned());
            }
        }
        start_s = stroke.last().map_or(start_s, |line| line.t) + PAUSE_S;
        lines.extend(stroke);
    }
    toml += "[[actuator]]\nfull_scale = 0.0005\n\n[audio]\ngain = 1.0\n";
    DemoScene {
        name: "touchers",
        title: "A finger, a nail, a pen, a steel rod",
        notice: "The same stroke over the same board of planed wood, across at 100 mm/s and back at 200 mm/s. The finger is the \
                 quietest, because many asperities of it share the load; nail, pen and rod are louder one after the other, each \
                 by what its shaft and the hardness of its tip let through.",
        toml,
        log: log(lines),
        assets: Vec::new(),
    }
}
