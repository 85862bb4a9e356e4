//! The seven materials are told apart by the heights under a finger and by the force on a tool; the
//! example `materials_blind` asks about many more strokes and pieces.

use crate::materials;

use materials::{Question, force, height_rate, identified, seven, stroke};

const QUESTION: Question = Question { strokes: 30, strokes_seed: 2024, known_piece: 9, asked_piece: 9 };

#[test]
fn materials_are_told_apart_by_the_heights_under_the_finger() {
    let (score, confusions) = identified(QUESTION, &seven(), |m, rng| height_rate(m, &stroke(rng)));
    println!("heights: {score:.3}, {confusions:?}");
    assert!(score >= 0.95, "{score}");
}

#[test]
fn materials_differ_by_the_force_on_a_tool_through_pebbles() {
    let (score, confusions) = identified(QUESTION, &seven(), |m, rng| force(m, &stroke(rng)));
    // Table 1 as printed, where granite and pebbles differ by their magnitude alone.
    let mut dry = seven();
    for p in &mut dry {
        p.viscosity_n_s_m = 0.0;
        p.friction = 0.4;
    }
    let (without, _) = identified(QUESTION, &dry, |m, rng| force(m, &stroke(rng)));
    println!("forces: {score:.3}, without viscosity {without:.3}, {confusions:?}");
    assert!(score >= 0.95, "{score}");
    assert!(without < score, "the medium is what parts granite and pebbles");
}
