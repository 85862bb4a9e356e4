//! Octaves, slope and told errors of made strokes.

use super::made::{Made, make, octave_rms, options};
use asperity_dsp::rng::Rng;
use asperity_stroke::fit;

#[test]
fn octaves_and_slope_of_a_made_ground_come_back_within_their_told_errors() {
    let mut rng = Rng::new(7);
    let (mut errors, mut slopes, mut covered, mut count) = (Vec::new(), Vec::new(), 0, 0);
    for seed in 0..40 {
        let pick = |rng: &mut Rng, low: f64, high: f64| low * (high / low).powf(rng.uniform());
        let made = Made {
            alpha: 1.0 + 2.5 * rng.uniform(),
            at_1mm_m: pick(&mut rng, 1e-6, 6e-6),
            speed_m_s: pick(&mut rng, 0.03, 0.3),
            force_n: pick(&mut rng, 0.3, 3.0),
            snr_db: 20.0 + 20.0 * rng.uniform(),
            ripple: if seed % 2 == 0 { 0.0 } else { 0.1 * rng.uniform() },
            seed: 100 + seed,
            ..Made::default()
        };
        let stroke = make(&made); let began = std::time::Instant::now();
        let found = match fit(&[stroke], None, &options()) {
            Ok(found) => found,
            Err(error) => {
                println!("refused {error} {made:?}");
                continue;
            }
        };
        if seed < 3 { println!("fit took {:?}", began.elapsed()); }
        slopes.push(found.law.alpha - made.alpha);
        for octave in &found.octaves {
            let hz = made.speed_m_s / octave.wavelength_m;
            if octave.is_extrapolated || !(20.0 * 1.41..1000.0 / 1.41).contains(&hz) {
                continue;
            }
            let error = 20.0 * (octave.rms_m / octave_rms(&made, octave.wavelength_m)).log10();
            errors.push(error);
            count += 1;
            covered += usize::from(error.abs() <= 2.0 * octave.se_db);
            if error.abs() > 0.8 {
                println!("octave {:.2e} {error:.2} se {:.2} {made:?}", octave.wavelength_m, octave.se_db);
            }
        }
        if (found.law.alpha - made.alpha).abs() > 0.04 {
            println!("alpha {} se {} outer {} {made:?} lift {}", found.law.alpha, found.law.alpha_se, found.law.outer_scale_m, found.lift);
        }
    }
    let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt();
    let mut sizes: Vec<f64> = slopes.iter().map(|x| x.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    println!("alpha rms {:.3} 95 % {:.3} worst {:.3}", rms(&slopes), sizes[sizes.len() * 95 / 100 - 1], sizes[sizes.len() - 1]);
    let worst = errors.iter().fold(0.0f64, |w, e| w.max(e.abs()));
    println!("octaves {} rms {:.3} worst {:.2} covered {:.3}", errors.len(), rms(&errors), worst, covered as f64 / count as f64);
}
