//! What is pressed harder is felt more, in displacement as in acceleration, where nobody wrote a
//! level; metres that a scene writes are the pad's own.

use crate::common;
use crate::slanting;

use asperity::files::Memory;
use asperity::files::contact_log::ContactLog;
use asperity::offline::Render;
use common::rms;
use slanting::{ceramic_scene as scene, grounds, open, slanting_stroke};

const FORCES_N: [f64; 5] = [0.3, 0.6, 1.0, 2.0, 5.0];

fn stroke(normal_force_n: impl Fn(f64) -> f64) -> ContactLog {
    slanting_stroke(0.1, normal_force_n)
}

fn rendered(toml: &str, files: &Memory, log: &ContactLog, block: usize) -> Render {
    slanting::rendered(open(toml, files), log, block)
}

/// n of y ∝ Fⁿ, by least squares.
fn exponent(levels: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().map(|x| x.ln()).sum::<f64>() / x.len() as f64;
    let (force, level) = (mean(&FORCES_N), mean(levels));
    let (mut both, mut forces) = (0.0, 0.0);
    for (f, y) in FORCES_N.iter().zip(levels) {
        both += (f.ln() - force) * (y.ln() - level);
        forces += (f.ln() - force).powi(2);
    }
    both / forces
}

#[test]
fn a_finger_pressed_harder_is_felt_more_on_every_ground() {
    let mut files = Memory::new();
    for (name, ground) in grounds(&[0.2, 0.5, 0.9], 2e-4, &mut files) {
        let growth = |output: &str| {
            let toml = scene("fingertip", &ground, &format!("output = \"{output}\"\nlimit = false"));
            let levels = FORCES_N.map(|force_n| {
                let render = rendered(&toml, &files, &stroke(|_| force_n), 512);
                rms(&render.haptic[0][8820..])
            });
            println!("{name:>8} {output:>12}: F^{:.2}, {levels:.3?}", exponent(&levels));
            (exponent(&levels), levels)
        };
        let (n, levels) = growth("displacement");
        assert!(levels.windows(2).all(|pair| pair[1] > pair[0]), "{name}: {levels:?}");
        assert!((0.3..=0.4).contains(&n), "{name}: F^{n}");
        // An accelerometer on a finger, whose tissue stiffens: a clean line near its resonance
        // grows least.
        let (n, _) = growth("acceleration");
        assert!((0.0..=0.3).contains(&n), "{name}, acceleration: F^{n}");
    }
}

#[test]
fn a_scenes_metres_are_the_pads_own_either_way() {
    let files = Memory::new();
    let ground = "roughness = 0.7";
    let full_scale = open(&scene("fingertip", ground, ""), &files).levels.full_scale[0];
    let written = |more: &str| scene("fingertip", ground, &format!("full_scale = {full_scale:e}\n{more}"));
    let haptic =
        |toml: &str, force_n: f64| rendered(toml, &files, &stroke(|_| force_n), 512).haptic[0].clone();
    let by_policy = |force_n| haptic(&scene("fingertip", ground, "limit = false"), force_n);
    assert!(by_policy(1.0) == haptic(&written(""), 1.0), "one newton differs");
    assert!(haptic(&written(""), 2.0) == haptic(&written("felt_force_exponent = 0"), 2.0));
    let growing = haptic(&written("felt_force_exponent = 0.3333333333333333"), 8.0);
    assert!(by_policy(8.0) == growing, "the key and the policy differ");
    let twice = haptic(&written(""), 8.0)
        .iter()
        .zip(&growing)
        .all(|(own, grown)| (2.0 * own - grown).abs() <= 1e-6 * own.abs());
    assert!(twice, "eight newtons are not felt twice as strongly");
    let tool = |more: &str| haptic(&scene("stylus", ground, &format!("full_scale = 1e-4\n{more}")), 4.0);
    assert!(tool("") == tool("felt_force_exponent = 0.5"), "a tool has no skin");
}

#[test]
fn a_changing_force_is_felt_without_a_step_in_any_blocks() {
    let files = Memory::new();
    let toml = scene("fingertip", "roughness = 0.5", "limit = false");
    let swelling = stroke(|t| 0.2 + 8.0 * t * t);
    let whole = rendered(&toml, &files, &swelling, 4096).haptic[0].clone();
    for block in [1, 64, 333] {
        assert!(rendered(&toml, &files, &swelling, block).haptic[0] == whole, "blocks of {block} show");
    }
    // The same stroke through the pad's own motion: their ratio is the growth, and it bends nowhere
    // by more than a report can make it.
    let own = rendered(&toml.replace("limit", "felt_force_exponent = 0\nlimit"), &files, &swelling, 512)
        .haptic[0]
        .clone();
    let growth: Vec<f64> = own
        .iter()
        .zip(&whole)
        .filter(|(own, _)| own.abs() > 1e-4)
        .map(|(own, grown)| f64::from(*grown / *own))
        .collect();
    let steepest = growth.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    println!("from {:.3} to {:.3}, at most {steepest:.1e} a sample", growth[0], growth[growth.len() - 1]);
    assert!(growth.len() > 5000 && steepest < 2e-3, "{} samples, a step of {steepest}", growth.len());
    assert!(growth[growth.len() - 1] > 1.9 * growth[0]);
}
