use super::*;
use crate::block::bounds;
use crate::raster::Raster;
use crate::wrap::Wrap;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Isa;

/// Every level that this machine can run.
fn levels() -> impl Iterator<Item = Level> {
    Isa::ALL.into_iter().filter_map(Level::find)
}

/// Value and slopes at one position, in plain arithmetic.
fn alone(spline: &Spline, position_m: [f64; 2]) -> (f64, [f64; 2]) {
    let (x, y) = (spline.axes[0].place(position_m[0]), spline.axes[1].place(position_m[1]));
    let p = at_level!(Level::PORTABLE, s => spline.cell(Four(s), x.texel, y.texel)).powers;
    let t = x.fraction;
    // The four powers of y side by side.
    let (mut level, mut rise) = ([0.0; 4], [0.0; 4]);
    for j in 0..4 {
        level[j] = ((p[3][j] * t + p[2][j]) * t + p[1][j]) * t + p[0][j];
        rise[j] = (3.0 * p[3][j] * t + 2.0 * p[2][j]) * t + p[1][j];
    }
    let t = y.fraction;
    let along_u = ((rise[3] * t + rise[2]) * t + rise[1]) * t + rise[0];
    let along_v = (3.0 * level[3] * t + 2.0 * level[2]) * t + level[1];
    let value = ((level[3] * t + level[2]) * t + level[1]) * t + level[0];
    (value, [along_u * x.slope, along_v * y.slope])
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn blocks_on_every_instruction_set_give_the_bits_of_single_samples() {
    let mut rng = Rng::new(5);
    let raster = Raster::from_fn(19, 23, |_, _| rng.uniform());
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let mut spline = Spline::new(&raster, |v| v, [0.19, 0.23], wrap);
        for level in levels() {
            spline.level = level;
            // From many samples a texel to several texels a sample, blocks of every length.
            for len in 1..=64 {
                let step = [1e-4, 1e-3, 0.03][len % 3];
                let start = [rng.uniform() - 0.5, rng.uniform() - 0.5];
                let position_m: Vec<_> = (0..len)
                    .map(|n| [start[0] + step * n as f64, start[1] - 0.7 * step * n as f64])
                    .collect();
                let (mut places, mut out) = (Places::new(), Samples::EMPTY);
                spline.sample_block::<true>(&position_m, None, &mut places, &mut out);
                // The same where it is known between which corners they lie; the second time as
                // another map of the grid.
                let bounds_m = bounds(&position_m);
                let mut known = Samples::EMPTY;
                places.forget();
                for _ in 0..2 {
                    spline.sample_block::<false>(&position_m, Some(&bounds_m), &mut places, &mut known);
                    assert_eq!(bits(&known.value[..len]), bits(&out.value[..len]), "{level:?}, {wrap:?}");
                }
                for (n, position_m) in position_m.iter().enumerate() {
                    let block = (out.value[n], [out.slope_u[n], out.slope_v[n]]);
                    assert_eq!(block, alone(&spline, *position_m), "{level:?}, {wrap:?}, {position_m:?}");
                }
            }
        }
    }
}
