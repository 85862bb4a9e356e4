//! Heights as the sources define them, without the render path: for comparison with traces.

use super::{Scene, TOML};
use std::fs;

/// Extent of the traced surface, m: no square, so that the axes cannot be mixed up.
pub const EXTENT_M: [f64; 2] = [0.1, 0.08];
/// Seed of the traced scene.
pub const SEED: u64 = 7;
/// Rate of the traced scene, Hz.
pub const RATE_HZ: f64 = 44_100.0;

/// One row of a trace.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub sample: u64,
    pub position_m: [f64; 2],
    pub height_m: f64,
    pub normal_force_n: f64,
}

/// A stroke of `count` events, 60 a second, and its end at `end_s`: place (metres) and velocity at
/// a time.
fn stroke(count: u32, end_s: f64, normal_force_n: f64, path: impl Fn(f64) -> [[f64; 2]; 2]) -> String {
    let mut lines = String::new();
    for index in 0..count {
        let t = f64::from(index) / 60.0;
        let kind = if index == 0 {
            r#""event":"begin","surface":"plate","actuator":0,"closing_m_s":0.0"#
        } else {
            r#""event":"move""#
        };
        let [at, velocity] = path(t);
        let [u, v] = [0, 1].map(|axis| at[axis] / EXTENT_M[axis]);
        lines += &format!(
            "{{\"t\":{t},{kind},\"contact\":1,\"uv\":[{u},{v}],\"velocity_m_s\":{velocity:?},\"normal_force_n\":{normal_force_n:?}}}\n",
        );
    }
    lines + &format!("{{\"t\":{end_s:?},\"event\":\"end\",\"contact\":1}}\n")
}

/// 0.3 s in a bow at 0.06 to 0.1 m/s, 60 events a second.
pub fn bow() -> String {
    stroke(18, 0.3, 0.6, |t| {
        let at = [0.031 + 0.07 * t, 0.043 + 0.02 * t + 0.005 * (9.0 * t).sin()];
        [at, [0.07, 0.02 + 0.045 * (9.0 * t).cos()]]
    })
}

/// Velocity of [`straight`], m/s.
pub const STRAIGHT_M_S: [f64; 2] = [0.06, 0.01];

/// A second straight on, pressed with 2 N.
pub fn straight() -> String {
    stroke(60, 1.0, 2.0, |t| [[0.02 + STRAIGHT_M_S[0] * t, 0.03 + STRAIGHT_M_S[1] * t], STRAIGHT_M_S])
}

/// A scene whose surface has the given source and no micro-relief.
pub fn scene_of(source: &str) -> String {
    let surface = format!("micro_relief_m = 0.0\n{source}");
    format!("seed = {SEED}\nsample_rate_hz = {RATE_HZ}\n{TOML}")
        .replace("height_m = 0.1", "height_m = 0.08")
        .replace("roughness = 0.7", &surface)
}

/// Renders a source with `--trace` at the command line.
pub fn trace(scene: &Scene, source: &str) -> Vec<Row> {
    scene.write("scene.toml", scene_of(source));
    scene.report(&["--trace"]);
    rows(scene)
}

/// The rows of `out.trace.csv`.
pub fn rows(scene: &Scene) -> Vec<Row> {
    let text = fs::read_to_string(scene.path("out.trace.csv")).unwrap();
    text.lines()
        .skip(1)
        .map(|line| {
            let number: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            Row {
                sample: (number[0] * RATE_HZ).round() as u64,
                position_m: [number[2] * EXTENT_M[0], number[3] * EXTENT_M[1]],
                height_m: number[4],
                normal_force_n: number[5],
            }
        })
        .collect()
}

/// The interpolating cubic spline of a periodic image: the definition, solved by iteration.
pub struct PeriodicSpline {
    width: usize,
    height: usize,
    coefficients: Vec<f64>,
}

impl PeriodicSpline {
    pub fn new(width: usize, height: usize, values: &[f64]) -> Self {
        let mut coefficients = values.to_vec();
        for y in 0..height {
            let line: Vec<f64> = (0..width).map(|x| coefficients[y * width + x]).collect();
            coefficients[y * width..(y + 1) * width].copy_from_slice(&solve(&line));
        }
        for x in 0..width {
            let line: Vec<f64> = (0..height).map(|y| coefficients[y * width + x]).collect();
            for (y, c) in solve(&line).into_iter().enumerate() {
                coefficients[y * width + x] = c;
            }
        }
        Self { width, height, coefficients }
    }

    /// Value at (a, b), where 1 is the whole image and texel centres lie at (i + ½)/N.
    pub fn at(&self, [a, b]: [f64; 2]) -> f64 {
        let (across, down) = (weights(a, self.width), weights(b, self.height));
        let row =
            |y: usize| across.iter().map(|(x, w)| w * self.coefficients[y * self.width + x]).sum::<f64>();
        down.iter().map(|&(y, w)| w * row(y)).sum()
    }
}

/// c with (c[i−1] + 4 c[i] + c[i+1]) / 6 = line[i]; every step halves the error.
fn solve(line: &[f64]) -> Vec<f64> {
    let n = line.len();
    let mut c = line.to_vec();
    for _ in 0..60 {
        c = (0..n).map(|i| (6.0 * line[i] - c[(i + n - 1) % n] - c[(i + 1) % n]) / 4.0).collect();
    }
    c
}

fn weights(t: f64, n: usize) -> [(usize, f64); 4] {
    let t = t * n as f64 - 0.5;
    let (first, f) = (t.floor(), t - t.floor());
    let g = 1.0 - f;
    let w = [g.powi(3), 4.0 - 6.0 * f * f + 3.0 * f.powi(3), 4.0 - 6.0 * g * g + 3.0 * g.powi(3), f.powi(3)];
    std::array::from_fn(|k| ((first as i64 - 1 + k as i64).rem_euclid(n as i64) as usize, w[k] / 6.0))
}

/// A 16-bit picture, as rows of grey from 0 to 65 535.
pub fn picture(width: u32, height: u32) -> image::ImageBuffer<image::Luma<u16>, Vec<u16>> {
    image::ImageBuffer::from_fn(width, height, |x, y| {
        let wave = (f64::from(x) * 0.7).sin() * (f64::from(y) * 0.45 + 0.3).cos();
        image::Luma([(32_768.0 + 24_000.0 * wave + f64::from((x * 37 + y * 101) % 4096)) as u16])
    })
}

/// The picture as a binary PGM file, which is read in a few lines.
pub fn pgm(picture: &image::ImageBuffer<image::Luma<u16>, Vec<u16>>) -> Vec<u8> {
    let mut file = format!("P5\n{} {}\n65535\n", picture.width(), picture.height()).into_bytes();
    file.extend(picture.pixels().flat_map(|p| p.0[0].to_be_bytes()));
    file
}

/// Its values from 0 to 1.
pub fn values(picture: &image::ImageBuffer<image::Luma<u16>, Vec<u16>>) -> Vec<f64> {
    picture.pixels().map(|p| f64::from(p.0[0]) / 65_535.0).collect()
}

/// 3t² − 2t³ over the 0.1 s of a change at `at_s`.
pub fn faded(sample: u64, at_s: f64) -> f64 {
    let t = ((sample as f64 - at_s * RATE_HZ) / (0.1 * RATE_HZ)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
