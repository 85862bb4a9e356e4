//! A force-feedback device on sand, on a shell in the sand, on a wall and on a soft cloth: a loop
//! of 1, 2 and 5 kHz holds it still, and gives no more energy than it takes.
//!
//! ```sh
//! cargo run --release --example force_loop [FOLDER]     # default force_loop/
//! ```
//!
//! The thread that drives a device asks [`Scene::tip_law`] once, and from then on turns the depth
//! of its tip into a force without waiting for anything; the same depths go to the engine as
//! reports, which makes what is felt of the grains, what is heard, and moves the sand. Writes
//! sand.svg, shell.svg, wall.svg, cloth.svg, prints and draws how stiff a loop may be
//! (stiffest.svg), and what else stands behind a force:
//!
//! | picture | what |
//! |---|---|
//! | materials.svg | rows of the seven solid materials against their law |
//! | one_block.svg | a cube and a sphere cut from one block of granite |
//! | sand_law.svg | sand's force over depth and its drag over speed against equations 1 and 3; a landing |
//! | furrow.svg | the furrow of a finger at 0.5 m/s |
//! | readers.svg | three readers of one hand's force, of which one stalls |
//! | footprint.svg | what a ball feels of a soft map |
//! | drawn.svg | how much of moving sand a game has to draw |

mod device;
mod picture;
mod sand;
mod soft;
mod solid;

use asperity::live::ports::{Force, ForceRow, Of};
use asperity::surface::sand::{Buried, SandDesign, SandSource};
use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Scene, Surface, SurfaceId, TipLaw,
};
use device::{Device, Tick};
use picture::{Curve, svg};
use std::error::Error;
use std::path::Path;

const SIDE_M: f64 = 0.1;
const RATES_HZ: [f64; 3] = [1000.0, 2000.0, 5000.0];
const MASSES_KG: [f64; 3] = [0.05, 0.15, 0.5];
const COLOURS: [&str; 3] = ["#1b6ca8", "#d1495b", "#3a7d44"];
/// Of a light device in a relaxed hand, N·s/m (assumed; a hand alone is told to damp with 2 to 20).
const DAMPING_N_S_M: f64 = 2.0;
/// The finer of the two sensors that the sand paper names, m.
const RESOLUTION_M: f64 = 9e-6;
/// Stiffness of the wall, N/m.
const WALL_N_M: f64 = 1500.0;

fn device(rate_hz: f64, mass_kg: f64) -> Device {
    Device { mass_kg, damping_n_s_m: DAMPING_N_S_M, rate_hz, resolution_m: RESOLUTION_M }
}

/// How long the hand keeps still, s: against a wall of 1500 N/m a loop of 1 kHz leaves 1.25 of the
/// device's 2 N·s/m, in which half a kilogram's swing falls to a third in 0.8 s.
const STILL_S: f64 = 8.0;
/// A flat shell under the tip, half as hard again as the sand: three times as hard is more than a
/// loop of 1 kHz holds with half a kilogram.
const SHELL: Buried =
    Buried { at_m: [0.5 * SIDE_M; 2], top_m: 0.001, half_m: [0.01; 2], height_m: 0.001, hardness: 1.5 };

/// A hand that leans on the tip with 2 N, and pushes to and fro in the end.
fn hand_n(t: f64) -> f64 {
    if t < STILL_S { 2.0 } else { 2.0 + 1.2 * (std::f64::consts::TAU * 4.0 * (t - STILL_S)).sin() }
}

/// A bed of sand with a shell in it, or without.
fn sand(shell: Option<Buried>) -> Result<Surface, Box<dyn Error>> {
    let mut design = SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 256, ..SandDesign::default() };
    design.law.buried[0] = shell;
    Ok(Surface::new(SandSource::synchronous(&design, 1)?, SIDE_M, SIDE_M)?.wraps(false))
}

fn surfaces() -> Result<[(&'static str, Surface); 4], Box<dyn Error>> {
    let flat = || Surface::flat(SIDE_M, SIDE_M);
    Ok([
        ("sand", sand(None)?),
        ("shell", sand(Some(SHELL))?),
        ("wall", flat()?.compliance_m_n(1.0 / WALL_N_M)),
        ("cloth", flat()?.compliance_m_n(2e-3)),
    ])
}

/// What the law answers to the tip in the middle of the surface, N upwards.
fn carried_n(law: &TipLaw, depth_m: f64) -> f64 {
    law.answer_at_n([0.5 * SIDE_M; 2], depth_m, [0.0; 2])[2]
}

/// The loop and the engine side by side: the loop's ticks, and the engine's rows of the same
/// contact.
fn run(
    scene: &mut Scene,
    renderer: &mut asperity::Renderer,
    surface: SurfaceId,
    device: &Device,
) -> Result<(Vec<Tick>, Vec<ForceRow>), Box<dyn Error>> {
    let law = scene.tip_law(surface)?.ok_or("a hard surface")?;
    let mut port = scene.open_port(Force { rate_hz: device.rate_hz, holds_s: STILL_S + 4.0 })?;
    let ticks = device.push(0.004, hand_n, STILL_S + 1.0, |depth_m| carried_n(&law, depth_m));
    let frames = renderer.sample_rate_hz() / device.rate_hz;
    let (mut haptic, mut audio) = (vec![0.0; 64], vec![0.0; 64]);
    for (index, tick) in ticks.iter().enumerate() {
        let sample = ContactSample::at_depth([0.5; 2], tick.depth_m).sliding([0.0; 2]);
        let event = match index {
            0 => ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        scene.report(tick.time_s, event)?;
        let until = ((index + 1) as f64 * frames) as u64;
        while renderer.position() < until {
            let n = 64.min((until - renderer.position()) as usize);
            renderer.render(&mut [&mut haptic[..n]], &mut [&mut audio[..n]]);
        }
    }
    let rows = std::iter::from_fn(|| port.read()).filter(|row| row.of == Of::Contact(ContactId(1))).collect();
    Ok((ticks, rows))
}

/// How far the engine's rows are from the loop's forces, over their rms.
fn apart(ticks: &[Tick], rows: &[ForceRow]) -> f64 {
    let pairs = rows.iter().filter_map(|row| Some((ticks.get(row.tick as usize)?.force_n, row.force_n[2])));
    let (error, power) =
        pairs.fold((0.0, 0.0), |(error, power), (a, b)| (error + (a - b) * (a - b), power + a * a));
    (error / f64::max(power, 1e-12)).sqrt()
}

fn plot(folder: &Path, name: &str, runs: &[(f64, Vec<Tick>)]) -> Result<(), Box<dyn Error>> {
    let curves = |of: fn(&Tick) -> f64| {
        let curve = |(rate_hz, ticks): &(f64, Vec<Tick>), colour| Curve {
            name: format!("{} kHz", rate_hz / 1000.0),
            colour,
            points: ticks.iter().map(|tick| [tick.time_s, of(tick)]).collect(),
        };
        runs.iter().zip(COLOURS).map(|(run, colour)| curve(run, colour)).collect()
    };
    let title = format!("{name}: 0.15 kg dropped from 4 mm, leaned on with 2 N, then pushed to and fro");
    let panels = [
        ("depth of the tip, mm", "s", curves(|tick| 1e3 * tick.depth_m)),
        ("force of the loop, N", "s", curves(|tick| tick.force_n)),
        ("energy given less taken, mJ", "s", curves(|tick| 1e3 * tick.given_j)),
    ];
    std::fs::write(folder.join(format!("{name}.svg")), svg(&title, &panels))?;
    Ok(())
}

/// The stiffest spring that a device holds still against, N/m.
fn stiffest_n_m(rate_hz: f64, mass_kg: f64) -> f64 {
    let holds = |stiffness_n_m: f64| {
        let law = TipLaw::Spring { compliance_m_n: 1.0 / stiffness_n_m, friction: 0.0 };
        let device = device(rate_hz, mass_kg);
        let ticks =
            device.push(0.0, |_| 2.0, 3.0 + 8.0 * mass_kg, |depth_m| law.answer_n(depth_m, [0.0; 2])[2]);
        device.holds(&ticks)
    };
    let (mut low, mut high) = (10.0, 1e6);
    while high / low > 1.02 {
        let middle = f64::sqrt(low * high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "force_loop".into());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    for index in 0..4 {
        let mut runs = Vec::new();
        let mut name = "";
        for rate_hz in RATES_HZ {
            for mass_kg in MASSES_KG {
                let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
                let mut made = surfaces()?;
                let (called, surface) = std::mem::replace(&mut made[index], ("", Surface::flat(1.0, 1.0)?));
                name = called;
                let surface = scene.add_surface(surface)?;
                let law = scene.tip_law(surface)?.ok_or("a hard surface")?;
                let device = device(rate_hz, mass_kg);
                let (ticks, rows) = run(&mut scene, &mut renderer, surface, &device)?;
                let still = device.holds(&ticks[..(STILL_S * rate_hz) as usize]);
                let cycle_j = device.cycle_j(0.003, 0.002, 20.0, |d| carried_n(&law, d));
                let stiffness_n_m = law.stiffness_at_n_m([0.5 * SIDE_M; 2], 0.002);
                println!(
                    "{name:6} {:1} kHz {mass_kg:4} kg: {stiffness_n_m:.0} N/m, {} (a third of a swing is left after {:.2} s), \
                     a cycle of 20 Hz gives {:+.3} mJ, engine's rows {:.2} % apart",
                    rate_hz / 1000.0,
                    if still { "holds still" } else { "STILL SWINGS AT THE END" },
                    device.fall_s(stiffness_n_m),
                    1e3 * cycle_j,
                    1e2 * apart(&ticks, &rows)
                );
                if mass_kg == MASSES_KG[1] {
                    runs.push((rate_hz, ticks));
                }
            }
        }
        plot(folder, name, &runs)?;
    }
    println!(
        "\nstiffest spring that holds still, N/m, with {DAMPING_N_S_M} N·s/m (2 b / T is what never gives energy)"
    );
    println!("rate     {}    2 b / T", MASSES_KG.map(|mass_kg| format!("{mass_kg:>8} kg")).join(""));
    let mut curves = Vec::new();
    for (rate_hz, colour) in RATES_HZ.into_iter().zip(COLOURS) {
        let stiffest = MASSES_KG.map(|mass_kg| [mass_kg, stiffest_n_m(rate_hz, mass_kg)]);
        let row = stiffest.map(|[_, stiffness_n_m]| format!("{stiffness_n_m:>11.0}"));
        let never_n_m = 2.0 * DAMPING_N_S_M * rate_hz;
        println!("{:1} kHz    {} {never_n_m:>10.0}", rate_hz / 1000.0, row.join(""));
        let curve = |name, points| Curve { name, colour, points };
        curves.push(curve(format!("{} kHz", rate_hz / 1000.0), stiffest.to_vec()));
        curves.push(curve("2 b / T".into(), MASSES_KG.map(|mass_kg| [mass_kg, never_n_m]).to_vec()));
    }
    let title = "stiffest spring that holds still, by mass and rate of the loop";
    std::fs::write(folder.join("stiffest.svg"), svg(title, &[("N/m", "kg", curves)]))?;
    solid::draw(folder)?;
    sand::draw(folder)?;
    soft::draw(folder)?;
    println!("\nplots: {}", folder.display());
    Ok(())
}
