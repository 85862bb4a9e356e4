use asperity_fit::{ChannelChoice, FitOptions, fit, load};
fn main() {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let fits: Vec<_> = paths
        .iter()
        .map(|p| {
            let r = load(p, ChannelChoice::Loudest).unwrap();
            fit(&r, &FitOptions { max_modes: 60, threads: 1, ..Default::default() }, &mut |_| {}).unwrap()
        })
        .collect();
    for f in &fits {
        println!(
            "{} {} modes snr {:.2} offset {:.2} ms",
            f.source,
            f.modes.len(),
            f.resynthesis_snr_db,
            f.start_offset_s * 1e3
        );
    }
    for m in &fits[0].modes {
        let near: Vec<_> = fits[1..]
            .iter()
            .map(|f| {
                f.modes
                    .iter()
                    .min_by(|a, b| {
                        (a.frequency_hz - m.frequency_hz)
                            .abs()
                            .total_cmp(&(b.frequency_hz - m.frequency_hz).abs())
                    })
                    .unwrap()
            })
            .collect();
        print!(
            "{:9.2}/{:6.1} {:6.1} dB std {:.2} |",
            m.frequency_hz,
            m.decay_per_s,
            10.0 * m.energy.log10(),
            m.frequency_std_hz
        );
        for (n, f) in near.iter().zip(&fits[1..]) {
            let _ = f;
            print!(
                " {:9.2} ({:+.4} %) d {:6.1} {:6.1} dB{}",
                n.frequency_hz,
                100.0 * (n.frequency_hz / m.frequency_hz - 1.0),
                n.decay_per_s,
                10.0 * n.energy.log10(),
                if (n.frequency_hz / m.frequency_hz - 1.0).abs() < 1e-3 { "*" } else { " " }
            );
        }
        println!();
    }
}
