#[path = "../tests/support/exact_brownian.rs"]
mod exact_brownian;
use asperity_texture::raster::Raster;
use exact_brownian::{ExactBrownian, quantise};
fn rms(r: &Raster, lag: usize) -> f64 {
    let mut s = 0.0;
    let mut n = 0.0;
    for y in 0..r.height {
        for x in lag..r.width {
            let d = r.at(x, y) - r.at(x - lag, y);
            s += d * d;
            n += 1.0;
            let d = r.at(y, x) - r.at(y, x - lag);
            s += d * d;
            n += 1.0;
        }
    }
    (s / n as f64).sqrt()
}
fn mrc(h: &[f32], w: usize, reach: usize, limit: f32) -> f64 {
    let c = w - 16;
    let mut p = vec![0u16; c];
    let mut s = 0.0;
    for y in (8..w - 8).step_by(3) {
        p.fill(0);
        let ce = &h[y * w + 8..][..c];
        for r in y - reach..=y + reach {
            for l in 8 - reach..=8 + reach {
                let o = &h[r * w + l..][..c];
                for ((k, a), b) in p.iter_mut().zip(ce).zip(o) {
                    *k += u16::from((a - b).abs() <= limit);
                }
            }
        }
        s += p.iter().map(|&m| 1.0 / m as f64).sum::<f64>();
    }
    s
}
fn main() {
    for levels in [256u32, 65536] {
        let sets: Vec<Vec<Raster>> = (1..=9)
            .map(|t| {
                let d = 2.0 + 0.1 * t as f64;
                let g = ExactBrownian::new(256, 3.0 - d);
                (0..2)
                    .flat_map(|s| g.pair(77 * t as u64 + 10_000 * s))
                    .map(|s| quantise(&s, levels))
                    .collect()
            })
            .collect();
        for round in [false, true] {
            for half in [false, true] {
                for target in [3.0, 4.0, 5.0, 6.0, 7.0, 8.5, 10.0] {
                    let mut mae = 0.0;
                    let mut out = String::new();
                    for (i, set) in sets.iter().enumerate() {
                        let d = 2.1 + 0.1 * i as f64;
                        let mut m = 0.0;
                        for r in set {
                            let sc = target / rms(r, 17);
                            let lo = r.range().0;
                            let h: Vec<f32> = r
                                .values
                                .iter()
                                .map(|v| {
                                    let z = (v - lo) * sc;
                                    (if round { z.round() } else { z }) as f32
                                })
                                .collect();
                            let pts: Vec<(f64, f64)> = [3usize, 5, 7, 9, 13, 17]
                                .iter()
                                .map(|&l| {
                                    (
                                        (l as f64).ln(),
                                        mrc(
                                            &h,
                                            256,
                                            l / 2,
                                            if half { l as f32 * 0.5 } else { (l / 2) as f32 },
                                        )
                                        .ln(),
                                    )
                                })
                                .collect();
                            let n = 6.0;
                            let mx = pts.iter().map(|p| p.0).sum::<f64>() / n;
                            let my = pts.iter().map(|p| p.1).sum::<f64>() / n;
                            let sl = pts.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
                                / pts.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>();
                            mae += (-sl - d).abs() / (9.0 * set.len() as f64);
                            m += -sl / set.len() as f64;
                        }
                        out += &format!(" {m:.3}");
                    }
                    println!("{levels} round {round} half {half} rms {target}: {mae:.4} {out}");
                }
            }
        }
    }
}
