//! The six plates of the Hasti study (§IV-B), the mirrored pair among them, judged by the frozen
//! observer.
//!
//! A trial is one free exploration: a stroke along u and one along v at random places, speeds and
//! forces, on a plate whose micro-relief has a seed of its own. The observer learns each plate from
//! other seeds, places, speeds and forces than those it is asked about, and knows where the hand
//! is, as the study's participants did. What it says is printed and stands in `docs/lab/feel.md`,
//! whatever it is; held to are the controls: shuffled labels and a plate against itself at chance,
//! and the figures of people as far as they are reached.

use crate::common;

use asperity_evidence::observer::{Confusion, Judge, Percept, constants};
use common::exploration::percepts;
use common::plates::surface;
use common::si_config;

const PLATES: [&str; 6] = ["matte-shiny", "shiny-matte", "ridge", "bumps", "sine", "sawtooth"];
/// Templates and trials a plate; people had 24 trials a plate.
const TEMPLATES: u64 = 16;
const TRIALS: u64 = 16;
/// Full scale of the sound in pascals: the demo's gain, and 94 dB SPL at full scale.
const PASCALS: f64 = 5.0 * constants::LISTENING_PA;

type Senses = fn(&[Percept; 2]) -> Percept;

const CONDITIONS: [(&str, Senses); 3] =
    [("touch", |p| p[0].clone()), ("sound", |p| p[1].clone()), ("both", |p| p[0].clone().and(&p[1]))];

fn lot(from: u64, count: u64) -> Vec<Vec<[Percept; 2]>> {
    let of = |(index, plate): (usize, &&str)| {
        let seed = |n| from + 1000 * index as u64 + n;
        (0..count).map(|n| percepts(si_config(), surface(plate), seed(n), PASCALS, true)).collect()
    };
    PLATES.iter().enumerate().map(of).collect()
}

fn seen(lot: &[Vec<[Percept; 2]>], senses: Senses) -> Vec<Vec<Percept>> {
    lot.iter().map(|plate| plate.iter().map(senses).collect()).collect()
}

#[test]
fn the_observer_tells_the_six_plates_as_the_study_s_participants_did() {
    println!("observer {}", constants::constants_sha256());
    let (known, asked) = (lot(50_000, TEMPLATES), lot(90_000, TRIALS));
    let chance = 1.0 / PLATES.len() as f64;
    let independent = PLATES.len() * TRIALS as usize;
    let chance_se = (chance * (1.0 - chance) / independent as f64).sqrt();
    for (condition, senses) in CONDITIONS {
        let (templates, trials) = (seen(&known, senses), seen(&asked, senses));
        for kappa in [0.0, 0.5, 1.0, 2.0] {
            let judge = Judge::new(templates.clone(), kappa);
            let confusion = Confusion::of(&judge, &trials, if kappa == 0.0 { 1 } else { 10 }, 11);
            let each: Vec<String> = (0..6).map(|plate| format!("{:.2}", confusion.right(plate))).collect();
            println!("{condition:>6}, κ = {kappa}: mean {:.3}; {}", confusion.mean(), each.join(" "));
            if kappa == 1.0 {
                confusion.counts.iter().zip(PLATES).for_each(|(row, plate)| println!("{plate:>12} {row:?}"));
            }
        }
        // Templates dealt out to the plates in turn: nothing is left to learn.
        let mut shuffled = vec![Vec::new(); PLATES.len()];
        for (n, template) in templates.iter().flatten().enumerate() {
            shuffled[(n * 7 + n / 6) % PLATES.len()].push(template.clone());
        }
        let confusion = Confusion::of(&Judge::new(shuffled, 1.0), &trials, 10, 13);
        println!("{condition:>6}, shuffled labels: {:.3}", confusion.mean());
        assert!((confusion.mean() - chance).abs() < 2.0 * chance_se, "{condition}: {}", confusion.mean());
    }
    // A plate against itself.
    let mut right = 0.0;
    for (plate, trials) in known.iter().zip(&asked) {
        let half = |lot: &[[Percept; 2]], side: usize| -> Vec<Percept> {
            lot.iter().skip(side).step_by(2).map(|p| p[0].clone().and(&p[1])).collect()
        };
        let judge = Judge::new(vec![half(plate, 0), half(plate, 1)], 1.0);
        right +=
            Confusion::of(&judge, &[half(trials, 0), half(trials, 1)], 10, 17).mean() / PLATES.len() as f64;
    }
    println!("a plate against itself: {right:.3}");
    assert!((right - 0.5).abs() < 2.0 * (0.25 / independent as f64).sqrt(), "{right}");
}
