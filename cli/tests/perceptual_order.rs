//! Order of modes by a masking model, on named tables of measured modes: how many nobody would miss, and what the ear's excitation says.

use asperity_dsp::masking::{
    Ranked, audible_count, erb_number, excitation_db, perceptual_order, quiet_db_spl,
};
use asperity_dsp::mode::Mode;
use asperity_measure::corpus::corpus;
use serde_json::Value;

const LOUDEST_DB_SPL: f64 = 70.0;
const SAFETY_DB: f64 = 6.0;

fn ranked(modes: &[Mode]) -> Vec<Ranked> {
    let mut order = vec![Ranked::default(); modes.len()];
    perceptual_order(modes, LOUDEST_DB_SPL, modes.len(), &mut order);
    order
}

fn table(name: &str) -> Option<Vec<Mode>> {
    let text = std::fs::read_to_string(corpus(&format!("modal/{name}.json"))?).unwrap();
    let table: Value = serde_json::from_str(&text).unwrap();
    let column = |key: &str| -> Vec<f64> {
        table[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (hz, db, t60_s) = (column("cf"), column("op"), column("rt"));
    let mode = |i: usize| Mode {
        frequency_hz: hz[i],
        decay_per_s: 6.908 / t60_s[i],
        amplitude: 10f64.powf(db[i] / 20.0),
        phase_rad: 0.0,
    };
    Some((0..hz.len()).map(mode).collect())
}

/// Excitation of some modes in an ERB band during a frame of 20 ms, with the threshold in quiet, as a power.
fn excitation(modes: &[Mode], which: &[usize], erb: f64, time_s: f64) -> f64 {
    let loudest = modes.iter().fold(0.0f64, |most, mode| most.max(mode.amplitude));
    let hz = (10f64.powf(erb / 21.4) - 1.0) / 0.00437;
    let of = |index: &usize| {
        let mode = &modes[*index];
        let level_db =
            LOUDEST_DB_SPL + 20.0 * (mode.amplitude / loudest).log10() - 8.686 * mode.decay_per_s * time_s;
        10f64.powf(0.1 * excitation_db(level_db, erb_number(mode.frequency_hz), erb))
    };
    which.iter().map(of).sum::<f64>() + 10f64.powf(0.1 * quiet_db_spl(hz))
}

#[test]
fn dense_tables_need_a_fraction_of_their_modes_and_excite_the_ear_within_a_decibel() {
    for (name, at_least) in
        [("tdw_ceramic_0_mm", 4.0), ("tdw_wood_medium_0_mm", 1.5), ("tdw_stone_1_mm", 1.0)]
    {
        let Some(modes) = table(name) else { continue };
        let order = ranked(&modes);
        let count = audible_count(&order, SAFETY_DB);
        let kept: Vec<usize> = order[..count].iter().map(|ranked| ranked.index).collect();
        let all: Vec<usize> = (0..modes.len()).collect();
        let mut apart_db: Vec<f64> = (0..50)
            .flat_map(|frame| (4..40).map(move |erb| (f64::from(erb), 0.01 + 0.02 * f64::from(frame))))
            .map(|(erb, time_s)| {
                let ratio = excitation(&modes, &all, erb, time_s) / excitation(&modes, &kept, erb, time_s);
                10.0 * ratio.log10()
            })
            .collect();
        apart_db.sort_by(f64::total_cmp);
        let within = apart_db.iter().filter(|apart| **apart <= 1.0).count() as f64 / apart_db.len() as f64;
        let fewer = modes.len() as f64 / count as f64;
        println!(
            "{name}: {} modes, {count} at {LOUDEST_DB_SPL} dB SPL ({fewer:.2} times fewer); {:.1} % of cells within 1 dB, worst {:.2} dB",
            modes.len(),
            100.0 * within,
            apart_db[apart_db.len() - 1]
        );
        assert!(fewer >= at_least, "{name}: {count} of {}", modes.len());
        assert!(within >= 0.99, "{name}: {within}");
    }
}

#[test]
fn the_order_does_not_depend_on_how_the_modes_were_sorted() {
    let Some(modes) = table("tdw_ceramic_0_mm") else { return };
    let turned: Vec<Mode> = modes.iter().rev().copied().collect();
    let [one, other] = [&modes, &turned].map(|modes| {
        let order = ranked(modes);
        let kept = &order[..audible_count(&order, SAFETY_DB)];
        let mut hz: Vec<f64> = kept.iter().map(|ranked| modes[ranked.index].frequency_hz).collect();
        hz.sort_by(f64::total_cmp);
        hz
    });
    assert_eq!(one, other);
}
