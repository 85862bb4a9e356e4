//! Soft ground: stones and shells that a finger meets in sand, and what a ball feels that stands in
//! a cloth.

use crate::common;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::Options;
use asperity::surface::footprint::footprint_radius_m;
use asperity::surface::height_map::HeightMap;
use asperity::surface::raster::Raster;
use asperity::surface::sand::{Buried, SandDesign, SandLaw, SandSource};
use asperity::{Config, ContactBlock, Extent, Probe, Surface, Tap, TipLaw, Wrap};
use common::{render_tapped, si_config};

const SIDE_M: f64 = 0.1;
const STONE: Buried =
    Buried { at_m: [0.05, 0.05], top_m: 0.0015, half_m: [0.008, 0.008], height_m: 0.004, hardness: 30.0 };

/// A bed with a stone, or without.
fn bed(buried: Option<Buried>) -> SandDesign {
    let mut law = SandLaw::default();
    law.buried[0] = buried;
    SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 256, law, ..SandDesign::default() }
}

fn sand(buried: Option<Buried>) -> Surface {
    Surface::new(SandSource::synchronous(&bed(buried), 1).unwrap(), SIDE_M, SIDE_M).unwrap().wraps(false)
}

/// Where a contact was, the ground under it, and the force on it along u and out of the surface.
#[derive(Default)]
struct Felt {
    rows: Vec<([f64; 2], f64, [f64; 2])>,
}

impl Tap for Felt {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        let rows = block.position_m.iter().zip(block.contact_samples).zip(block.force_n);
        self.rows.extend(rows.map(|((at_m, row), force_n)| (*at_m, row.height_m, [force_n[0], force_n[2]])));
    }
}

/// Reports of one contact at 1 kHz along u.
fn along_u(
    seconds: f64,
    from_m: f64,
    speed_m_s: f64,
    mut sample: impl FnMut([f64; 2]) -> ContactSample,
) -> ContactLog {
    let steps = (seconds * 1000.0) as usize;
    let event = |step: usize, sample| match step {
        0 => LogEvent::begin(1, "s", 0, sample),
        _ => LogEvent::moved(1, sample),
    };
    let mut line = |step: usize| {
        let t = step as f64 / 1000.0;
        let uv = [(from_m + speed_m_s * t) / SIDE_M, 0.5];
        LogLine {
            t,
            event: event(step, ContactSample { velocity_m_s: Some([speed_m_s, 0.0]), ..sample(uv) }),
        }
    };
    let mut lines: Vec<LogLine> = (0..steps).map(&mut line).collect();
    lines.push(LogLine { t: seconds, event: LogEvent::End { contact: 1 } });
    ContactLog { lines }
}

fn felt(config: Config, surface: Surface, log: &ContactLog) -> Felt {
    let mut felt = Felt::default();
    let render = render_tapped(config, surface, log, &Options::default(), &mut felt);
    assert_eq!(render.stats.quarantined, 0);
    felt
}

#[test]
fn a_finger_in_sand_rides_over_a_stone_by_the_law() {
    let force_n = 3.0;
    let log = along_u(0.9, 0.02, 0.07, |uv| ContactSample {
        normal_force_n: force_n,
        uv,
        ..ContactSample::default()
    });
    let (over, beside) = (felt(si_config(), sand(Some(STONE)), &log), felt(si_config(), sand(None), &log));
    let law = bed(Some(STONE)).law;
    let (mut worst_m, mut rise_m) = (0.0_f64, 0.0_f64);
    let after_landing = 4410;
    for (stony, sandy) in over.rows.iter().zip(&beside.rows).skip(after_landing) {
        let wanted_m = law.depth_m(force_n) - law.depth_over_m(law.met(stony.0, 0.0).as_ref(), force_n);
        worst_m = worst_m.max((stony.1 - sandy.1 - wanted_m).abs());
        rise_m = rise_m.max(stony.1 - sandy.1);
    }
    println!("rises by {:.3} mm, off the law by {:.3} mm", 1e3 * rise_m, 1e3 * worst_m);
    // The heap that the finger pushes lies over the stone as well.
    assert!(rise_m > 1.4e-3 && worst_m < 0.1 * rise_m, "{rise_m} {worst_m}");
    // Uphill it is pushed back, downhill on: beside the drag.
    let aside = |from_m: f64, until_m: f64| {
        let pairs =
            over.rows.iter().zip(&beside.rows).filter(|(row, _)| (from_m..until_m).contains(&row.0[0]));
        let sum = pairs.fold((0.0, 0), |(sum, n), (stony, sandy)| (sum + stony.2[0] - sandy.2[0], n + 1));
        sum.0 / f64::from(sum.1)
    };
    let (uphill_n, downhill_n) = (aside(0.045, 0.048), aside(0.052, 0.055));
    println!("pushed by {uphill_n:.3} N before its top, {downhill_n:.3} N behind it");
    assert!(uphill_n < -0.1 && downhill_n > 0.1);
}

#[test]
fn a_finger_prints_less_deeply_over_a_stone_and_keeps_the_volume() {
    let log =
        along_u(0.3, 0.05, 0.0, |uv| ContactSample { normal_force_n: 3.0, uv, ..ContactSample::default() });
    for (buried, wanted_m) in [(None, 0.003), (Some(STONE), 0.00155)] {
        let render =
            render_tapped(si_config(), sand(buried), &log, &Options::default(), &mut Felt::default());
        let figures = render.sand[0].figures;
        println!("print {:.3} mm", 1e3 * figures.print_m);
        assert_eq!(figures.drift_units, 0);
        assert!((figures.print_m / wanted_m - 1.0).abs() < 0.03, "{} m", figures.print_m);
    }
}

#[test]
fn a_device_meets_the_stone_with_the_engines_own_force() {
    let law = TipLaw::Sand(bed(Some(STONE)).law);
    for (u_m, depth_m) in [(0.05, 0.001), (0.05, 0.0018), (0.047, 0.0022), (0.054, 0.0026), (0.02, 0.0026)] {
        let log = along_u(0.2, u_m, 0.0, |uv| ContactSample {
            depth_m: Some(depth_m),
            uv,
            ..ContactSample::default()
        });
        let rows = felt(si_config(), sand(Some(STONE)), &log).rows;
        let [x_n, z_n] = rows[rows.len() - 100].2;
        let wanted = law.answer_at_n([u_m, 0.05], depth_m, [0.0; 2]);
        println!("{u_m} m, {depth_m} m: {x_n:.3}, {z_n:.3} N, law {:.3}, {:.3} N", wanted[0], wanted[2]);
        assert!((z_n - wanted[2]).abs() <= 0.01 * wanted[2], "{z_n} {wanted:?}");
        assert!((x_n - wanted[0]).abs() <= 0.01 * wanted[2], "{x_n} {wanted:?}");
    }
}

/// Waves along u of a micrometre, so that a ball rides in every valley of hard ground.
fn waves(count: usize) -> Surface {
    let height = |x: usize, _| (core::f64::consts::TAU * count as f64 * (x as f64 + 0.5) / 2048.0).sin();
    let raster = Raster::from_fn(2048, 4, height).map(|x| 0.5e-6 * x);
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = HeightMap::new(&raster, extent, Wrap::Repeat).unwrap();
    Surface::from_map(map).unwrap().micro_relief_m(0.0)
}

/// Height of the waves under a contact over their own, by fitting sine and cosine to where it was.
fn height_felt(felt: &Felt, count: usize) -> f64 {
    let rows = &felt.rows[4410..felt.rows.len() - 100];
    let mean_m = rows.iter().map(|row| row.1).sum::<f64>() / rows.len() as f64;
    let sum = rows.iter().fold([0.0; 2], |sum, row| {
        let angle = core::f64::consts::TAU * count as f64 * row.0[0] / SIDE_M;
        let height_m = row.1 - mean_m;
        [sum[0] + height_m * angle.sin(), sum[1] + height_m * angle.cos()]
    });
    sum[0].hypot(sum[1]) * 2.0 / rows.len() as f64 / 0.5e-6
}

/// J₂ by its series.
fn bessel_j2(x: f64) -> f64 {
    let (mut term, mut sum) = (x * x / 8.0, 0.0);
    for k in 1..60 {
        sum += term;
        term *= -x * x / 4.0 / (f64::from(k) * f64::from(k + 2));
    }
    sum
}

/// What a ball of this radius feels of waves on ground of this compliance, over what a point feels
/// of them.
fn share_felt(count: usize, tip_radius_m: f64, compliance_m_n: f64, force_n: f64) -> f64 {
    let log = along_u(1.1, 0.01, 0.06, |uv| ContactSample {
        normal_force_n: force_n,
        uv,
        ..ContactSample::default()
    });
    let [ball, point] = [tip_radius_m, 0.0].map(|tip_radius_m| {
        let config = Config { probe: Probe { tip_radius_m, ..Probe::default() }, ..si_config() };
        height_felt(&felt(config, waves(count).compliance_m_n(compliance_m_n), &log), count)
    });
    assert!((point - 1.0).abs() < 0.02, "a point feels {point} of the waves");
    ball / point
}

#[test]
fn a_ball_on_a_soft_map_rides_the_mean_of_the_relief() {
    let mut worst = 0.0_f64;
    for (tip_radius_m, compliance_m_n, force_n) in
        [(1e-3, 1e-4, 0.5), (1e-3, 1e-3, 0.3), (5e-4, 3e-4, 0.4), (4e-3, 5e-4, 1.0)]
    {
        for count in [20, 50, 100, 150] {
            let found = share_felt(count, tip_radius_m, compliance_m_n, force_n);
            let depth_m = compliance_m_n * force_n;
            let wave_m = SIDE_M / count as f64;
            let kappa = core::f64::consts::TAU * footprint_radius_m(tip_radius_m, depth_m) / wave_m;
            let wanted = (8.0 * bessel_j2(kappa) / (kappa * kappa)).abs();
            println!("r {tip_radius_m}, {depth_m:.1e} m deep, kappa {kappa:.2}: {found:.4}, law {wanted:.4}");
            worst = worst.max((found - wanted).abs());
        }
    }
    println!("{worst:.4} of the wave at most");
    assert!(worst <= 0.01, "{worst}");
}
