//! Laps: texture coordinates that wrap come back to the same place on every source, without a seam.

use crate::common;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::Options;
use asperity::{ContactBlock, Extent, Surface, Tap, Wrap};
use asperity_surface::combine::Sum;
use asperity_surface::height_map::HeightMap;
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::sand::{SandDesign, SandSource};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use common::{SIDE_M, peak, plate, render_tapped, si_config};

/// A lap takes 1.4 s: 61 740 samples, 84 reports.
const SPEED_M_S: f64 = 0.1;
const LAP: usize = 61_740;

#[derive(Default)]
struct Rows {
    height_m: Vec<f64>,
    contact_force_n: Vec<f64>,
    along_m: Vec<f64>,
}

impl Tap for Rows {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        for (row, position) in block.contact_samples.iter().zip(block.position_m) {
            self.height_m.push(row.height_m);
            self.contact_force_n.push(row.contact_force_n);
            self.along_m.push(position[0]);
        }
    }
}

/// Three laps along u, with the texture coordinate as `wrap` reports it.
fn laps(u_per_tile: f64, wrap: impl Fn(f64) -> f64) -> ContactLog {
    laps_at(SPEED_M_S, u_per_tile, wrap)
}

fn laps_at(speed_m_s: f64, u_per_tile: f64, wrap: impl Fn(f64) -> f64) -> ContactLog {
    let sample = |t: f64| ContactSample {
        uv: [wrap(0.05 + u_per_tile * speed_m_s * t / SIDE_M), 0.31],
        velocity_m_s: Some([speed_m_s, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let begin = LogEvent::begin(1, "s", 0, sample(0.0));
    let mut lines = vec![LogLine { t: 0.0, event: begin }];
    for step in 1..275 {
        let t = f64::from(step) / 60.0;
        lines.push(LogLine { t, event: LogEvent::moved(1, sample(t)) });
    }
    ContactLog { lines }
}

fn raster() -> Raster {
    let height = |i: usize| {
        let (x, y) = ((i % 128) as f64 / 128.0, (i / 128) as f64 / 128.0);
        2e-4 * (44.0 * x).sin() + 3e-4 * (y - x * x)
    };
    Raster { width: 128, height: 128, values: (0..128 * 128).map(height).collect() }
}

fn surface(source: impl asperity_surface::height_field::HeightField + 'static) -> Surface {
    Surface::new(source, SIDE_M, SIDE_M).unwrap()
}

fn solid(material: SolidMaterial) -> SolidNoise {
    SolidNoise::new(material.parameters(), 5).unwrap()
}

fn map(wrap: Wrap) -> HeightMap {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    HeightMap::new(&raster(), extent, wrap).unwrap()
}

type Named = (&'static str, Box<dyn Fn() -> Surface>);

/// Every source that belongs to places, each with the overlay.
fn sources() -> Vec<Named> {
    let mut all: Vec<Named> = vec![
        ("flat", Box::new(|| plate(0.8))),
        ("map", Box::new(|| surface(map(Wrap::Repeat)))),
        (
            "map and gravel",
            Box::new(|| {
                surface(Sum::new(vec![Box::new(map(Wrap::Repeat)), Box::new(solid(SolidMaterial::Gravel))]))
            }),
        ),
        (
            "oblique lattice",
            Box::new(|| {
                surface(Lattice::new(&raster().map(|h| 0.3 * h), [0.013, 0.001], [0.004, 0.011]).unwrap())
            }),
        ),
        (
            "map of another size",
            Box::new(|| {
                let extent = Extent { width_m: 0.2, height_m: 0.2, relief_m: 1.0 };
                surface(HeightMap::new(&raster(), extent, Wrap::Repeat).unwrap())
            }),
        ),
    ];
    // A square relief laid over the tile, and one of another size than it.
    #[cfg(feature = "brownian")]
    for (name, side_m) in [("brownian", SIDE_M), ("brownian, cut from a larger one", 1.3 * SIDE_M)] {
        all.push((
            name,
            Box::new(move || {
                let relief = asperity_surface::brownian::BrownianDesign::new(0.5, 1e-4, 7).surface().unwrap();
                let extent = Extent { width_m: side_m, height_m: side_m, relief_m: 1.0 };
                surface(HeightMap::new(&relief, extent, Wrap::Repeat).unwrap())
            }),
        ));
    }
    for material in SolidMaterial::SEVEN {
        all.push((material.name(), Box::new(move || surface(solid(material)))));
    }
    all
}

fn felt(surface: Surface, log: &ContactLog) -> (Rows, Vec<f32>) {
    let mut rows = Rows::default();
    let take =
        render_tapped(si_config(), surface, log, &Options { tail_s: 0.0, ..Options::default() }, &mut rows);
    assert_eq!(take.stats.jumps, 0, "a wrap is no jump");
    (rows, take.haptic.into_iter().next().unwrap())
}

fn corner(x: &[f32]) -> f64 {
    x.windows(3)
        .map(|x| (f64::from(x[0]) - 2.0 * f64::from(x[1]) + f64::from(x[2])).abs())
        .fold(0.0, f64::max)
}

#[test]
fn the_same_place_has_the_same_height_lap_after_lap() {
    for (name, make) in sources() {
        let (rows, haptic) = felt(make(), &laps(1.0, |u| u - u.floor()));
        let worst = (10_000..10_000 + LAP)
            .map(|i| {
                assert!((rows.along_m[i] + 2.0 * SIDE_M - rows.along_m[i + 2 * LAP]).abs() < 1e-9);
                let second = (rows.height_m[i] - rows.height_m[i + LAP]).abs();
                second.max((rows.height_m[i] - rows.height_m[i + 2 * LAP]).abs())
            })
            .fold(0.0, f64::max);
        // Around the seam nothing stands out: it lies 1.33 s after each lap's beginning.
        let seam = 58_653..60_653;
        let elsewhere = 20_000..50_000;
        let hardest = |range: std::ops::Range<usize>| {
            rows.contact_force_n[range].iter().fold(0.0f64, |most, f| most.max(*f))
        };
        let (over, before) = (hardest(seam.clone()), hardest(elsewhere.clone()));
        let step = corner(&haptic[seam]) - 2.0 * corner(&haptic[elsewhere.clone()]);
        println!("{name}: {worst:.1e} m, {:.2} x force, step {:.1e} m", over / before, step.max(0.0));
        assert!(worst < 1e-9, "{name}: {worst} m");
        assert!(over < 2.0 * before, "{name}: {over} N over {before} N");
        assert!(step < 1e-3 * peak(&haptic[elsewhere]), "{name}: a step of {step} m");
    }
}

#[test]
fn a_wrapped_and_an_unwrapped_report_are_the_same_stroke() {
    for (name, make) in sources() {
        let (wrapped, _) = felt(make(), &laps(1.0, |u| u - u.floor()));
        let (plain, _) = felt(make(), &laps(1.0, |u| u));
        for (i, (a, b)) in wrapped.height_m.iter().zip(&plain.height_m).enumerate() {
            assert!((a - b).abs() < 1e-9, "{name}, row {i}: {a} and {b}");
        }
    }
}

#[test]
fn a_mirrored_map_wraps_at_every_second_tile() {
    let (rows, _) = felt(surface(map(Wrap::Mirror)), &laps(1.0, |u| u - 2.0 * (u / 2.0).floor()));
    let (plain, _) = felt(surface(map(Wrap::Mirror)), &laps(1.0, |u| u));
    for (i, (a, b)) in rows.height_m.iter().zip(&plain.height_m).enumerate() {
        assert!((a - b).abs() < 1e-9, "row {i}: {a} and {b}");
    }
}

#[test]
fn a_jump_at_a_clamped_edge_and_on_sand_is_no_blow() {
    let clamped = || surface(map(Wrap::Clamp)).micro_relief_m(0.0);
    let sand = || {
        surface(
            SandSource::synchronous(
                &SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 128, ..SandDesign::default() },
                1,
            )
            .unwrap(),
        )
    };
    for (name, make) in [("clamp", &clamped as &dyn Fn() -> Surface), ("sand", &sand)] {
        let mut rows = Rows::default();
        let log = laps(1.0, |u| u - u.floor());
        let take = render_tapped(si_config(), make(), &log, &Options::default(), &mut rows);
        assert_eq!(take.stats.jumps, 3, "{name}");
        // Against the first lap, which comes to the edge and no further.
        let hardest = |rows: &[f64]| rows.iter().fold(0.0f64, |most, f| most.max(*f));
        let (own, all) = (hardest(&rows.contact_force_n[..57_000]), hardest(&rows.contact_force_n));
        println!("{name}: {own} N in the first lap, {all} N in all");
        assert!(all <= 2.0 * own, "{name}: {all} N over {own} N");
    }
}

/// Zeros with one ridge at the far edge, at a resolution; 0 texels = a constant map.
fn ridge_far_away(texels: usize) -> Surface {
    let n = texels.max(1);
    let row = |i: usize| f64::from(u8::from(texels > 0 && i / n == n - 1));
    let raster = Raster { width: n, height: n, values: (0..n * n).map(row).collect() };
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 4e-3 };
    surface(HeightMap::new(&raster, extent, Wrap::Repeat).unwrap().with_roughness(0.9).unwrap())
}

#[test]
fn a_flat_place_is_as_rough_as_a_constant_map() {
    for (texels, speed_m_s) in [(256, 0.1), (512, 0.2), (1024, 0.1), (2048, 0.1), (4096, 0.2)] {
        let level = |texels: usize| {
            let (_, haptic) = felt(ridge_far_away(texels), &laps_at(speed_m_s, 2.0, |u| u));
            common::rms(&haptic[4410..])
        };
        let db = 20.0 * (level(texels) / level(0)).log10();
        println!("{texels} texels: {db:.3} dB");
        assert!(db.abs() < 0.5, "{texels} texels: {db} dB");
    }
}

#[test]
fn a_rough_map_is_not_rough_twice() {
    let mut rng = asperity_dsp::rng::Rng::new(3);
    let values = (0..256 * 256).map(|_| 5e-5 * rng.normal()).collect();
    let relief = Raster { width: 256, height: 256, values };
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = || HeightMap::new(&relief, extent, Wrap::Repeat).unwrap();
    let level = |surface: Surface| common::rms(&felt(surface, &laps(1.0, |u| u)).1[4410..]);
    let db = 20.0 * (level(surface(map())) / level(surface(map()).micro_relief_m(0.0))).log10();
    // 9 µm of micro-relief at R = 0.5, below two texels, on 50 µm of its own.
    assert!(db.abs() < 0.8, "{db} dB");
}
