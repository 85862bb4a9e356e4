//! Bodies whose shapes are closed forms: a free bar, a plate held at its edges, a sphere that
//! swells.

use asperity::{Mode, ModeShapes};
use std::f64::consts::PI;

/// βL of the first five bending modes of a free bar (Euler–Bernoulli).
pub const FREE_BAR: [f64; 5] = [4.730_040_745, 7.853_204_624, 10.995_607_838, 14.137_165_491, 17.278_759_657];

/// Bending shape of a free bar at x/L, ±2 at the ends.
pub fn bar_shape(mode: usize, x: f64) -> f64 {
    let b = FREE_BAR[mode];
    let s = (b.cosh() - b.cos()) / (b.sinh() - b.sin());
    (b * x).cosh() + (b * x).cos() - s * ((b * x).sinh() + (b * x).sin())
}

/// A grid of points over a rectangle in the plane z = 0, seen from above, and its triangles.
pub fn sheet(size_m: [f64; 2], cells: [usize; 2]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for j in 0..=cells[1] {
        for i in 0..=cells[0] {
            points.push([
                size_m[0] * i as f64 / cells[0] as f64,
                size_m[1] * j as f64 / cells[1] as f64,
                0.0,
            ]);
        }
    }
    let at = |i: usize, j: usize| (j * (cells[0] + 1) + i) as u32;
    for (i, j) in (0..cells[0]).flat_map(|i| (0..cells[1]).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    (points, triangles)
}

/// Shapes of a sheet whose motion across is `shape(mode, point)`, kg^−½.
pub fn shapes(
    (points_m, triangles): (Vec<[f64; 3]>, Vec<[u32; 3]>),
    modes: usize,
    along: impl Fn([f64; 3]) -> [f64; 3],
    shape: impl Fn(usize, [f64; 3]) -> f64,
) -> ModeShapes {
    let phi = |m: usize| points_m.iter().map(|p| along(*p).map(|n| (n * shape(m, *p)) as f32)).collect();
    ModeShapes {
        gains: vec![1.0; modes],
        phi_per_sqrt_kg: (0..modes).map(phi).collect(),
        struck_point: 1,
        points_m,
        triangles,
    }
}

/// A free bar of 0.5 m and 0.2 kg with stations every 5 mm.
pub fn bar() -> ModeShapes {
    let modal = 1.0 / 0.2_f64.sqrt();
    shapes(sheet([0.5, 0.03], [100, 2]), 5, |_| [0.0, 0.0, 1.0], |m, p| modal * bar_shape(m, p[0] / 0.5))
}

/// Indices of the modes of a plate held at its edges, 6 × 5.
pub fn plate_orders(mode: usize) -> [f64; 2] {
    [(mode % 6 + 1) as f64, (mode / 6 + 1) as f64]
}

pub const PLATE_M: [f64; 2] = [0.4, 0.3];

/// Shape of a plate held at its edges.
pub fn plate_shape(mode: usize, p: [f64; 3]) -> f64 {
    let [a, b] = plate_orders(mode);
    2.0 * (a * PI * p[0] / PLATE_M[0]).sin() * (b * PI * p[1] / PLATE_M[1]).sin()
}

/// A plate of 1 kg on a grid of 41 × 31 points.
pub fn plate() -> ModeShapes {
    plate_of([40, 30])
}

/// The same on a grid of so many cells.
pub fn plate_of(cells: [usize; 2]) -> ModeShapes {
    shapes(sheet(PLATE_M, cells), 30, |_| [0.0, 0.0, 1.0], plate_shape)
}

/// Modes of a thin plate whose first one is at `lowest_hz`, decaying alike; version 2 text of a
/// modes file.
pub fn modes_file(shapes: &ModeShapes, hz: impl Fn(usize) -> f64, decay_per_s: f64) -> String {
    let mode = |m: usize| Mode {
        frequency_hz: hz(m),
        decay_per_s,
        amplitude: shapes.gains[m] * f64::from(shapes.phi_per_sqrt_kg[m][shapes.struck_point][2]),
        phase_rad: std::f64::consts::FRAC_PI_2,
    };
    let modes: Vec<Mode> = (0..shapes.gains.len()).map(mode).collect();
    serde_json::json!({
        "format": "asperity.modes", "version": 2, "unit": "relative", "modes": modes, "shapes": shapes
    })
    .to_string()
}
