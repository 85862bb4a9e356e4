//! scratch
use asperity_fit::*;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let fits: Vec<Fit> = (1..=3)
        .map(|v| {
            let r = load(
                format!("/work/shared/corpus/impacts/vcsl_Agogo_High_v{v}_rr1_Mid.wav"),
                ChannelChoice::Loudest,
            )
            .unwrap();
            fit(&r, &FitOptions { max_modes: n, ..FitOptions::default() }, &mut |_| {}).unwrap()
        })
        .collect();
    for v in 0..3 {
        println!("v{}", v + 1);
        for m in fits[v].modes.iter().take(14) {
            let near: Vec<String> = (0..3)
                .filter(|&o| o != v)
                .map(|o| {
                    let b = fits[o]
                        .modes
                        .iter()
                        .enumerate()
                        .min_by(|a, b| {
                            (a.1.frequency_hz - m.frequency_hz)
                                .abs()
                                .total_cmp(&(b.1.frequency_hz - m.frequency_hz).abs())
                        })
                        .unwrap();
                    format!(
                        "#{} {:.2}/{:.1} {:.3}%",
                        b.0,
                        b.1.frequency_hz,
                        b.1.decay_per_s,
                        100.0 * (b.1.frequency_hz / m.frequency_hz - 1.0)
                    )
                })
                .collect();
            println!(
                "  {:9.2}/{:7.2} std {:.3} E {:.2e} a {:.4}  {}",
                m.frequency_hz,
                m.decay_per_s,
                m.frequency_std_hz,
                m.energy,
                m.amplitude,
                near.join("   ")
            );
        }
    }
}
