//! The seven solid-noise materials of the sandpaper study, judged by touch by the frozen observer
//! with people's noise.
//!
//! People named 95 of 112 (0.848); gravel and pebbles best, wood and granite least. What the
//! observer says is printed and stands in `docs/lab/feel.md`, whatever it is; held to is the
//! control: shuffled labels at chance.

use crate::common;

use asperity::surface::solid_materials::SolidMaterial;
use asperity_evidence::observer::{Confusion, Judge, Percept, constants};
use asperity_evidence::plates;
use common::exploration::percepts;
use common::si_config;

const TEMPLATES: u64 = 16;
/// People had 16 trials a material.
const TRIALS: u64 = 16;

fn lot(from: u64, count: u64) -> Vec<Vec<Percept>> {
    let of = |(index, material): (usize, &SolidMaterial)| {
        let trial = |n: u64| {
            let seed = from + 1000 * index as u64 + n;
            let surface = plates::material(*material, seed).unwrap();
            let [felt, _] = percepts(si_config(), surface, seed, constants::LISTENING_PA, false);
            felt
        };
        (0..count).map(trial).collect()
    };
    SolidMaterial::SEVEN.iter().enumerate().map(of).collect()
}

#[test]
fn the_observer_names_seven_materials_and_none_when_shuffled() {
    println!("observer {}", constants::constants_sha256());
    let (templates, trials) = (lot(50_000, TEMPLATES), lot(90_000, TRIALS));
    for kappa in [0.0, 0.5, 1.0, 2.0] {
        let judge = Judge::new(templates.clone(), kappa);
        let confusion = Confusion::of(&judge, &trials, if kappa == 0.0 { 1 } else { 10 }, 11);
        println!("κ = {kappa}: mean {:.3}", confusion.mean());
        for (material, class) in SolidMaterial::SEVEN.iter().zip(0..) {
            println!("{:>12} {:.2} {:?}", material.name(), confusion.right(class), confusion.counts[class]);
        }
    }
    let mut shuffled = vec![Vec::new(); 7];
    for (n, template) in templates.iter().flatten().enumerate() {
        shuffled[(n * 5 + n / 7) % 7].push(template.clone());
    }
    let confusion = Confusion::of(&Judge::new(shuffled, 1.0), &trials, 10, 13);
    let chance = 1.0 / 7.0;
    let se = (chance * (1.0 - chance) / (7.0 * TRIALS as f64)).sqrt();
    println!("shuffled labels: {:.3}", confusion.mean());
    assert!((confusion.mean() - chance).abs() < 2.0 * se, "{}", confusion.mean());
}
