//! Sand: its force and drag through the whole engine against the document's equations, a landing,
//! and the furrow of a fast finger.

use crate::picture::{Curve, svg};
use asperity::live::ports::{Force, ForceRow, Of};
use asperity::surface::sand::simulation::Pose;
use asperity::surface::sand::{SandDesign, SandLaw, SandSimulation, SandSource};
use asperity::{ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Surface};
use std::error::Error;
use std::path::Path;

const SIDE_M: f64 = 0.2;
const LAW: &str = "#e0a458";
const DRY: &str = "#1b6ca8";
const WET: &str = "#3a7d44";

type Failed = Box<dyn Error>;
type Points = Vec<[f64; 2]>;

fn curve(name: &str, colour: &'static str, points: Points) -> Curve {
    Curve { name: name.into(), colour, points }
}

/// Writes sand_law.svg and furrow.svg.
pub fn draw(folder: &Path) -> Result<(), Failed> {
    let mut worst = 0.0_f64;
    let (mut depths, mut drags) = (Vec::new(), Vec::new());
    for (name, colour, wetness) in [("dry", DRY, 0.0), ("wet", WET, 0.7)] {
        let law = SandLaw { wetness, ..SandLaw::default() };
        let (mut force, mut wanted_force, mut drag, mut wanted_drag) =
            <(Points, Points, Points, Points)>::default();
        for step in 0..12 {
            let depth_m = 5e-4 * f64::from(step);
            let found = settled_n(law, depth_m, 0.0)?;
            force.push([1e3 * depth_m, found[2]]);
            wanted_force.push([1e3 * depth_m, law.answer_n(depth_m, [0.0; 2])[2]]);
            worst = worst.max(found[0].abs());
            let speed_m_s = 0.02 * f64::from(step);
            let found = settled_n(law, 2e-3, speed_m_s)?;
            drag.push([speed_m_s, found[0]]);
            wanted_drag.push([speed_m_s, law.answer_n(2e-3, [speed_m_s, 0.0])[0]]);
        }
        let off = [(&force, &wanted_force), (&drag, &wanted_drag)].map(|(found, wanted)| {
            let pairs = found.iter().zip(wanted);
            pairs.fold(0.0_f64, |off, ([_, a], [_, b])| off.max((a - b).abs() / b.abs().max(0.1)))
        });
        println!("{name} sand: {:.3} % off equation 1, {:.3} % off equation 3", 1e2 * off[0], 1e2 * off[1]);
        depths.extend([curve("equation 1", LAW, wanted_force), curve(name, colour, force)]);
        drags.extend([curve("equation 3", LAW, wanted_drag), curve(name, colour, drag)]);
    }
    println!("resting: {worst:.4} N sideways at most");
    let landing = landing()?;
    let first_n = landing.iter().find(|[t, _]| *t > 0.1).map_or(0.0, |[_, z]| *z);
    println!("landing: {first_n:.3} N a row after touch, 0 N before");
    let panels = [
        ("force out of the sand, N", "mm", depths),
        ("drag at 2 mm, N", "m/s", drags),
        ("a tip dips in at 0.1 s, N", "s", vec![curve("rows", DRY, landing)]),
    ];
    let title = "sand: depth and speed in, force out, through the engine";
    std::fs::write(folder.join("sand_law.svg"), svg(title, &panels))?;
    furrow(folder)
}

/// Rows of a tip at some depth of time that moves along u.
fn rows(
    law: SandLaw,
    seconds: f64,
    speed_m_s: f64,
    depth_m: impl Fn(f64) -> f64,
) -> Result<Vec<ForceRow>, Failed> {
    let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
    let design = SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 400, law, ..SandDesign::default() };
    let sand = Surface::new(SandSource::synchronous(&design, 3)?, SIDE_M, SIDE_M)?.wraps(false);
    let id = scene.add_surface(sand)?;
    let mut port = scene.open_port(Force { rate_hz: 1000.0, holds_s: 4.0 })?;
    let (mut haptic, mut audio) = ([0.0; 64], [0.0; 64]);
    for step in 0..(1000.0 * seconds) as u32 {
        let t = 1e-3 * f64::from(step);
        let uv = [(0.03 + speed_m_s * t) / SIDE_M, 0.5];
        let sample = ContactSample::at_depth(uv, depth_m(t)).sliding([speed_m_s, 0.0]);
        scene.report(
            t,
            match step {
                0 => ContactEvent::begin(ContactId(1), id, ChannelId(0), sample),
                _ => ContactEvent::moved(ContactId(1), sample),
            },
        )?;
        while (renderer.position() as f64) < (t + 1e-3) * renderer.sample_rate_hz() {
            let left = ((t + 1e-3) * renderer.sample_rate_hz()) as u64 + 1 - renderer.position();
            let n = (left as usize).min(64);
            renderer.render(&mut [&mut haptic[..n]], &mut [&mut audio[..n]]);
        }
    }
    Ok(std::iter::from_fn(|| port.read()).filter(|row| matches!(row.of, Of::Contact(_))).collect())
}

fn settled_n(law: SandLaw, depth_m: f64, speed_m_s: f64) -> Result<[f64; 3], Failed> {
    let rows = rows(law, 0.4, speed_m_s, |_| depth_m)?;
    Ok(rows.get(rows.len().saturating_sub(20)).map_or([0.0; 3], |row| row.force_n))
}

/// Down at 5 cm/s through the surface at 0.1 s.
fn landing() -> Result<Points, Failed> {
    let rows = rows(SandLaw::default(), 0.18, 0.0, |t| 0.05 * (t - 0.1))?;
    Ok(rows.iter().map(|row| [row.tick as f64 / 1000.0, row.force_n[2]]).collect())
}

/// Along the furrow of a finger at 0.5 m/s, and after the sand has settled.
fn furrow(folder: &Path) -> Result<(), Failed> {
    let design = SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 400, ..SandDesign::default() };
    let mut sand = SandSimulation::new(&design)?;
    for frame in 0..18 {
        let position_m = [0.02 + 0.5 * f64::from(frame) / 60.0, 0.1];
        let pose = Pose {
            contact: 0,
            position_m,
            velocity_m_s: [0.5, 0.0],
            normal_force_n: 3.0,
            landed: frame == 0,
        };
        sand.set_pose(pose);
        sand.frame();
    }
    let along = |sand: &SandSimulation| -> Points {
        let cell_m = SIDE_M / 400.0;
        (0..400)
            .map(|x| [1e3 * cell_m * x as f64, 1e3 * (sand.grid().height_m(x, 200) - design.depth_m)])
            .collect()
    };
    let moving = along(&sand);
    sand.settle();
    let curves = vec![curve("while it moves", DRY, moving), curve("settled", WET, along(&sand))];
    let title = "along the furrow of a finger with 3 N at 0.5 m/s; a frame is 8.3 mm";
    std::fs::write(folder.join("furrow.svg"), svg(title, &[("height over the bed, mm", "mm", curves)]))?;
    Ok(())
}
