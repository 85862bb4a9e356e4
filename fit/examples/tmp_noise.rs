#[path = "../tests/common/mod.rs"]
mod common;
use asperity_dsp::rng::Rng;
use asperity_fit::{FitOptions, Recording, fit};
fn main() {
    let draws: u64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let which: Vec<String> = std::env::args().skip(2).collect();
    for kind in which {
        let (mut silent, mut list) = (0, vec![]);
        let clock = common::cpu_seconds();
        for draw in 0..draws {
            let mut rng = Rng::new(70_000 + draw);
            let mut pink = [0.0_f64; 10];
            let mut last = 0.0;
            let samples: Vec<f64> = (0..88_200)
                .map(|_| {
                    let w = rng.normal();
                    0.1 * if kind == "pink" {
                        // Sum of one-poles an octave apart, each of equal power: 1/f.
                        let mut s = 0.0;
                        for (k, p) in pink.iter_mut().enumerate() {
                            let a = 0.5 * 0.5_f64.powi(k as i32);
                            let n = rng.normal();
                            *p += a * (n - *p);
                            s += *p / a.sqrt();
                        }
                        s
                    } else {
                        let pole: f64 = kind.parse().unwrap();
                        last += pole * (w - last);
                        last
                    }
                })
                .collect();
            let r = Recording::from_samples("made", samples, 44_100.0).unwrap();
            let f = fit(&r, &FitOptions { threads: 1, ..Default::default() }, &mut |_| {}).unwrap();
            if f.modes.is_empty() {
                silent += 1
            } else {
                list.push(
                    f.modes
                        .iter()
                        .take(3)
                        .map(|m| format!("{:.0}/{:.0}", m.frequency_hz, m.decay_per_s))
                        .collect::<Vec<_>>()
                        .join(",")
                        + &format!(" of {}", f.modes.len()),
                );
            }
        }
        println!(
            "{kind}: {silent} of {draws}, {:.1} s each; {list:?}",
            (common::cpu_seconds() - clock) / draws as f64
        );
    }
}
