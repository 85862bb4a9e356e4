//! The documents' laws at the ticks of a device, at every rate, and solids that are one.

use super::stroke::{SIDE_M, Stroke, block_of};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::{SolidCut, SolidNoise};
use asperity::{ContactSample, Surface, SurfaceFrame};
use std::collections::HashMap;

#[test]
fn the_law_agrees_with_plain_python_at_5_khz() {
    let text = include_str!("../independent/solid_force.csv");
    let mut forces: HashMap<&str, Vec<[f64; 3]>> = HashMap::new();
    for line in text.lines().skip(1) {
        let mut cells = line.split(',');
        let name = cells.next().unwrap();
        let numbers: Vec<f64> = cells.map(|cell| cell.parse().unwrap()).collect();
        forces.entry(name).or_default().push([numbers[0] / 5000.0, numbers[2], numbers[3]]);
    }
    for material in SolidMaterial::SEVEN {
        let noise = SolidNoise::new(material.parameters(), 7).unwrap();
        let rows = &forces[material.name()];
        let velocity = [0.12, -0.05];
        let mut worst = 0.0f64;
        for [t, u_n, v_n] in rows {
            let at = [0.0312 + velocity[0] * t, 0.0417 + velocity[1] * t];
            let found = noise.force_n(at, velocity, 0.5, 0.0, 0);
            worst = worst.max((found[0] - u_n).abs()).max((found[1] - v_n).abs());
        }
        println!("{}: {} rows, {worst:.1e} N apart", material.name(), rows.len());
        assert!(rows.len() == 160 && worst < 2e-6, "{material:?}: {worst}");
    }
}

#[test]
fn the_force_of_seven_materials_is_the_law_within_one_percent() {
    for sample_rate_hz in [22_050.0, 44_100.0, 192_000.0] {
        for material in SolidMaterial::SEVEN {
            let noise = SolidNoise::new(material.parameters(), 7).unwrap();
            let velocity = [0.14, -0.05];
            let stroke = Stroke { sample_rate_hz, rows_hz: 5000.0, reports_hz: 60.0, seconds: 0.4 };
            let felt = stroke.run(block_of(material), |t| {
                let uv = [0, 1].map(|a| (0.05 + 0.1 * a as f64 + velocity[a] * t) / SIDE_M);
                ContactSample::new(uv, 0.5).sliding(velocity)
            });
            let first = felt.first.unwrap() as f64;
            let (mut error, mut power, mut count) = (0.0, 0.0, 0);
            for row in &felt.received {
                let at = row.tick as f64 / 5000.0 * sample_rate_hz - first;
                let index = at.floor() as usize;
                if !(0.1..0.35).contains(&(row.tick as f64 / 5000.0)) || index + 1 >= felt.path.len() {
                    continue;
                }
                let (here, next) = (felt.path[index], felt.path[index + 1]);
                let between = |a: f64, b: f64| a + (at - index as f64) * (b - a);
                let place = [0, 1].map(|a| between(here.0[a], next.0[a]));
                let wanted = noise.force_n(place, here.1, 0.5, 0.0, 0);
                for (given_n, wanted_n) in row.force_n.iter().zip(&wanted[..2]) {
                    error += (given_n - wanted_n).powi(2);
                    power += wanted_n * wanted_n;
                }
                count += 1;
            }
            let (rms, off) = ((power / f64::from(count)).sqrt(), (error / power).sqrt());
            println!("{sample_rate_hz} {}: rms {rms:.3} N, {:.3} % off", material.name(), 1e2 * off);
            assert!(count > 1200 && rms > 0.005 && off < 0.01, "{material:?} at {sample_rate_hz}: {off}");
        }
    }
}

#[test]
fn a_thousand_rows_a_second_feel_sandpaper_at_15_cm_s() {
    let rms = |speed_m_s: f64, force_n: f64| {
        let stroke = Stroke { sample_rate_hz: 22_050.0, rows_hz: 1000.0, reports_hz: 60.0, seconds: 0.5 };
        let felt = stroke.run(block_of(SolidMaterial::Sandpaper), |t| {
            let sample = ContactSample::new([(0.03 + speed_m_s * t) / SIDE_M, 0.4], force_n);
            let landing = if t == 0.0 && force_n == 0.0 { 1e-3 } else { 0.0 };
            sample.sliding([speed_m_s, 0.0]).landing(landing)
        });
        let x: Vec<f64> = felt.received.iter().map(|row| row.force_n[0]).collect();
        (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
    };
    let [slow, fast] = [0.05, 0.15].map(|speed| rms(speed, 0.5));
    println!("sandpaper: {slow:.4} N at 0.05 m/s, {fast:.4} N at 0.15 m/s");
    assert!(fast > 0.5 * slow, "{fast} for {slow}");
    assert_eq!(rms(0.15, 0.0), 0.0);
}

#[test]
fn every_row_tells_another_force_at_every_rate() {
    // It was one value in 64 samples, held.
    let stroke = Stroke { sample_rate_hz: 22_050.0, rows_hz: 5000.0, reports_hz: 60.0, seconds: 0.3 };
    let felt = stroke.run(block_of(SolidMaterial::Gravel), |t| {
        ContactSample::new([(0.03 + 0.1 * t) / SIDE_M, 0.4], 0.5).sliding([0.1, 0.0])
    });
    let moving = &felt.received[200..];
    assert!(moving.len() > 1000 && moving.windows(2).all(|pair| pair[0].force_n[0] != pair[1].force_n[0]));
}

/// The height under a contact that rests.
fn height(surface: Surface, sample: ContactSample) -> f64 {
    let stroke = Stroke { sample_rate_hz: 44_100.0, rows_hz: 1000.0, reports_hz: 60.0, seconds: 0.1 };
    stroke.run(surface, |_| sample).path.last().unwrap().2
}

#[test]
fn a_sphere_and_a_cube_are_cut_from_one_block() {
    let granite = || SolidNoise::new(SolidMaterial::Granite.parameters(), 7).unwrap();
    let plane = |frame: SurfaceFrame| {
        let [u_axis, v_axis] = frame.axes();
        let noise = granite().with_cut(SolidCut::of_body(frame.origin_m(), u_axis, v_axis));
        Surface::new(noise, SIDE_M, SIDE_M).unwrap().wraps(false).frame(frame).micro_relief_m(0.0)
    };
    // Repeats, as a mesh's texture coordinates do: places do not.
    let sphere = || Surface::new(granite(), SIDE_M, SIDE_M).unwrap().micro_relief_m(0.0);
    let (mut worst, mut range) = (0.0f64, [f64::INFINITY, f64::NEG_INFINITY]);
    for k in 0..12 {
        // Points of a sphere of 4 cm about the cube's corner that lie on the cube's faces z = 0 and
        // y = 0.
        let angle = 0.1 + 0.5 * f64::from(k);
        let (s, c) = angle.sin_cos();
        for (point, frame) in [
            ([0.04 * c, 0.04 * s, 0.0], SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])),
            ([0.04 * c, 0.0, 0.04 * s], SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0])),
        ] {
            let on_cube = height(plane(frame.unwrap()), ContactSample::new([0.0; 2], 0.5).placed(point));
            let uv = [0.1 * f64::from(k), 0.9];
            let on_sphere = height(sphere(), ContactSample::new(uv, 0.5).placed(point));
            worst = worst.max((on_cube - on_sphere).abs());
            range = [range[0].min(on_sphere), range[1].max(on_sphere)];
        }
    }
    println!("{worst:.1e} m apart, heights from {:.1e} to {:.1e} m", range[0], range[1]);
    assert!(worst < 1e-9 && range[1] - range[0] > 1e-5);
}
