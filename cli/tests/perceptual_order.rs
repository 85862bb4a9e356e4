//! Order of modes by a masking model, on named tables of measured modes: how many nobody would
//! miss, and what the ear's excitation says.

use asperity::{Config, ContactEvent, Impact, Material, ModalModel};
use asperity_dsp::masking::{
    Ranked, audible_count, erb_number, excitation_db, perceptual_order, quiet_db_spl,
};
use asperity_dsp::modal_bank::shedding_order;
use asperity_dsp::mode::Mode;
use asperity_evidence::corpus::corpus;
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

/// Excitation of some modes in an ERB band during a frame of 20 ms, with the threshold in quiet, as
/// a power.
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
fn dense_tables_need_a_fraction_of_their_modes() {
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

/// What the engine makes of a strike whose loudest mode is at [`LOUDEST_DB_SPL`], a second of it,
/// where the governor is at a level.
fn struck(modes: &[Mode], level: usize) -> Vec<f32> {
    const IMPULSE_N_S: f64 = 1e-2;
    let config = Config { culling: None, ..Config::default() };
    let asperity::Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let body = scene.add_body(ModalModel::new(modes.to_vec(), IMPULSE_N_S).unwrap()).unwrap();
    // Its own work is most of its time, and then it is late once for each level.
    (0..31).for_each(|_| renderer.report_load(0.7));
    (0..level).for_each(|_| renderer.report_load(0.9));
    // A contact of 10 µs, which is flat to 20 kHz.
    let impact = Impact::from_impulse(body, IMPULSE_N_S, 20.0, 1.0).striker(Material::STEEL, 2.5e-4, 2e-5);
    scene.report(0.0, ContactEvent::Impact(impact)).unwrap();
    let (mut haptic, mut audio) = (vec![0.0; 44_100], vec![0.0; 44_100]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    assert_eq!(scene.stats().shed > 0, level > 0 && modes.len() > 16);
    audio
}

/// Mean squares of a frame of 20 ms in bands of a quarter of an ERB, by a Hann window.
fn bands(frame: &[f32]) -> Vec<f64> {
    let count = frame.len();
    let windowed: Vec<f64> = (0..count)
        .map(|n| {
            let turn = std::f64::consts::TAU * n as f64 / count as f64;
            f64::from(frame[n]) * (0.5 - 0.5 * turn.cos())
        })
        .collect();
    let turns: Vec<[f64; 2]> = (0..count)
        .map(|n| {
            let (sin, cos) = (std::f64::consts::TAU * n as f64 / count as f64).sin_cos();
            [cos, sin]
        })
        .collect();
    let mut bands = vec![0.0; 4 * 44];
    for bin in 1..count / 2 {
        let mut sum = [0.0; 2];
        for (n, x) in windowed.iter().enumerate() {
            let [cos, sin] = turns[bin * n % count];
            sum = [sum[0] + x * cos, sum[1] + x * sin];
        }
        let hz = bin as f64 * 44_100.0 / count as f64;
        // The squares of the window are 3/8 in the mean.
        let power = 2.0 * (sum[0] * sum[0] + sum[1] * sum[1]) / (count as f64 * count as f64 * 0.375);
        bands[(4.0 * erb_number(hz)) as usize] += power;
    }
    bands
}

/// Excitation in each ERB from 4 to 39 of what is heard in bands, with the threshold in quiet, as a
/// power.
fn excited(bands: &[f64], loudest: f64) -> Vec<f64> {
    let at = |erb: f64| {
        let hz = (10f64.powf(erb / 21.4) - 1.0) / 0.00437;
        let of = |(band, power): (usize, &f64)| {
            let level_db = LOUDEST_DB_SPL + 10.0 * (power / (0.5 * loudest * loudest)).max(1e-30).log10();
            10f64.powf(0.1 * excitation_db(level_db, (band as f64 + 0.5) / 4.0, erb))
        };
        bands.iter().enumerate().map(of).sum::<f64>() + 10f64.powf(0.1 * quiet_db_spl(hz))
    };
    (4..40).map(|erb| at(f64::from(erb))).collect()
}

/// The bands of every 20 ms of a strike at a level, in the mean over strikes whose modes begin at
/// other phases: two tones within an ERB beat, and of a beat it is chance which frame it falls in.
fn heard_at(modes: &[Mode], level: usize) -> Vec<Vec<f64>> {
    const STRIKES: usize = 8;
    let mut rng = asperity_dsp::rng::Rng::new(17);
    let mut sum = vec![vec![0.0; 4 * 44]; 50];
    for _ in 0..STRIKES {
        let turned: Vec<Mode> = modes
            .iter()
            .map(|mode| Mode { phase_rad: std::f64::consts::TAU * rng.uniform(), ..*mode })
            .collect();
        let sound = struck(&turned, level);
        for (sum, frame) in sum.iter_mut().zip(sound.chunks(882)) {
            sum.iter_mut().zip(bands(frame)).for_each(|(sum, power)| *sum += power / STRIKES as f64);
        }
    }
    sum
}

#[test]
fn the_first_level_of_load_stays_within_a_decibel_of_excitation() {
    for (name, at_least) in
        [("tdw_ceramic_0_mm", 4.0), ("tdw_wood_medium_0_mm", 1.5), ("tdw_stone_1_mm", 1.0)]
    {
        let Some(modes) = table(name) else { continue };
        let loudest = modes.iter().fold(0.0f64, |most, mode| most.max(mode.amplitude));
        let mut order = vec![Ranked::default(); modes.len()];
        let levels = shedding_order(&modes, 1e-4, LOUDEST_DB_SPL, &mut order);
        let whole = heard_at(&modes, 0);
        let less = heard_at(&modes, 1);
        let mut apart_db: Vec<f64> = whole
            .iter()
            .zip(&less)
            .flat_map(|(whole, less)| {
                let pairs = excited(whole, loudest).into_iter().zip(excited(less, loudest));
                pairs.map(|(a, b)| (10.0 * (a / b).log10()).abs()).collect::<Vec<f64>>()
            })
            .collect();
        apart_db.sort_by(f64::total_cmp);
        let within = apart_db.iter().filter(|apart| **apart <= 1.0).count() as f64 / apart_db.len() as f64;
        let fewer = levels[0] as f64 / levels[1] as f64;
        println!(
            "{name}: {} of {} groups ({fewer:.2} times fewer); {:.1} % of cells within 1 dB, 99 % within {:.2} dB",
            levels[1],
            levels[0],
            100.0 * within,
            apart_db[apart_db.len() * 99 / 100]
        );
        assert!(fewer >= at_least, "{name}: {levels:?} groups");
        assert!(within >= 0.99, "{name}: {within}");
    }
}
