//! What `--damping-from` learns from a recording, judged on the half of its modes that it was not
//! shown.

use asperity::Material;
use asperity_dsp::mode::Mode;
use asperity_evidence::corpus::{corpus, skip};
use asperity_shape::damping_fit::{fit, resonances};
use std::process::Command;

/// Recordings of bodies of one material, and what the table of materials calls it.
const RECORDINGS: [(&str, Material); 12] = [
    ("glockenspiel_2096.57", Material::STEEL),
    ("js30_metal-ping-1", Material::STEEL),
    ("kenney_impactBell_heavy_000", Material::BRASS),
    ("kenney_impactGlass_light_000", Material::GLASS),
    ("kenney_impactMetal_light_000", Material::STEEL),
    ("sonicpi_perc_bell", Material::BRASS),
    ("vcsl_Agogo_High_v1_rr1_Mid", Material::STEEL),
    ("vcsl_Agogo_High_v2_rr1_Mid", Material::STEEL),
    ("vcsl_Agogo_High_v3_rr1_Mid", Material::STEEL),
    ("vcsl_Claves1_Hit_v3_rr1_Mid", Material::WOOD),
    ("vcsl_xylo_medium_C5_ff", Material::WOOD),
    ("vcsl_xylo_medium_C5_pp", Material::WOOD),
];

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}

/// The strongest resonances of a recording as `asperity fit` finds them, by frequency.
fn recorded(name: &str) -> Option<Vec<Mode>> {
    let wav = corpus(&format!("impacts/{name}.wav"))?;
    let folder = tempfile::tempdir().unwrap();
    let modes = folder.path().join("hit.modes.json");
    let output = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .arg("fit")
        .arg(&wav)
        .arg("-o")
        .arg(&modes)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut found = resonances(&asperity::ModalModel::load(&modes).unwrap().modes);
    found.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    Some(found)
}

/// Decays told by the law of the other half, over those recorded: each half holds back the other
/// once.
fn held_back(modes: &[Mode]) -> Vec<f64> {
    let half = |which: usize| -> Vec<Mode> { modes.iter().skip(which).step_by(2).copied().collect() };
    let message = |from: &[Mode], of: &[Mode]| -> Vec<f64> {
        let law = fit(from).unwrap();
        of.iter().map(|m| law.decay_per_s(m.frequency_hz) / m.decay_per_s).collect()
    };
    let (even, odd) = (half(0), half(1));
    [message(&even, &odd), message(&odd, &even)].concat()
}

#[test]
fn the_median_of_held_back_decays_is_within_a_quarter() {
    let mut off_by_the_book = Vec::new();
    for (name, textbook) in RECORDINGS {
        let Some(modes) = recorded(name) else { return skip("no corpus of recordings") };
        let learned = held_back(&modes);
        let book: Vec<f64> =
            modes.iter().map(|m| textbook.damping().decay_per_s(m.frequency_hz) / m.decay_per_s).collect();
        let each = median(learned.iter().map(|r| r.ln().abs()).collect()).exp();
        let (learned, book) = (median(learned), median(book));
        println!(
            "{name:30} {:3} resonances: median {learned:.2}, textbook {book:.2}; one mode in two within a factor of {each:.2}",
            modes.len()
        );
        assert!((0.75..=1.25).contains(&learned), "{name}: {learned}");
        off_by_the_book.push(book.ln().abs().exp());
    }
    assert!(median(off_by_the_book) > 1.25, "the textbook would have done");
}
