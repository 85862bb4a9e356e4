//! Strike position as a field, against bodies whose shapes are closed forms.

use crate::closed_forms;

use asperity::StrikeField;
use asperity::dsp::rng::Rng;
use closed_forms::{PLATE_M, bar, bar_shape, plate, plate_of, plate_shape, shapes};
use std::f64::consts::PI;

fn db(ratio: f64) -> f64 {
    20.0 * ratio.abs().max(1e-12).log10()
}

#[test]
fn a_free_bar_sounds_as_euler_and_bernoulli_say_everywhere() {
    let field = StrikeField::new(bar());
    let mut worst = 0.0_f64;
    for step in 0..=997 {
        let x = f64::from(step) / 997.0;
        let place = field.place([0.5 * x, 0.011, 0.003], None).unwrap();
        for (m, amplitude) in field.amplitudes(&place).into_iter().enumerate() {
            let exact = bar_shape(m, x) / 0.2_f64.sqrt();
            // Against 2, the shape at the ends: a level at a node is no level.
            if exact.abs() > 0.1 * 2.0 / 0.2_f64.sqrt() {
                worst = worst.max((db(amplitude) - db(exact)).abs());
            }
            // The inward normal of the upper side points down.
            assert!(exact.abs() < 1e-2 || (amplitude < 0.0) == (exact > 0.0));
        }
    }
    println!("worst {worst:.3} dB");
    assert!(worst <= 0.3, "{worst} dB");
}

#[test]
fn a_mode_struck_on_its_node_line_is_silent() {
    // 16 points in the shortest half wave, none of them on a node line of purpose.
    let field = StrikeField::new(plate_of([101, 83]));
    let mut worst = f64::NEG_INFINITY;
    for m in 0..30 {
        let [a, b] = closed_forms::plate_orders(m);
        for line in 1..a as usize {
            for y in [0.031, 0.117, 0.209] {
                let x = PLATE_M[0] * line as f64 / a;
                let place = field.place([x, y, 0.0], None).unwrap();
                let struck = field.amplitudes(&place)[m];
                // Against what it sounds with where it swings most.
                let (x, y) = (0.5 * PLATE_M[0] / a, 0.5 * PLATE_M[1] / b);
                let best = field.amplitudes(&field.place([x, y, 0.0], None).unwrap())[m];
                worst = worst.max(db(struck / best));
            }
        }
    }
    println!("at most {worst:.1} dB");
    assert!(worst <= -40.0, "{worst} dB");
}

/// Level errors of all modes at 1000 points of the surface, dB, sorted; those below a hundredth of
/// the greatest level left out.
fn errors(
    field: &StrikeField,
    point: impl Fn(&mut Rng) -> [f64; 3],
    exact: impl Fn(usize, [f64; 3]) -> f64,
) -> Vec<f64> {
    let mut rng = Rng::new(1000);
    let modes = field.shapes().gains.len();
    let mut errors = Vec::new();
    for _ in 0..1000 {
        let p = point(&mut rng);
        let found = field.amplitudes(&field.place(p, None).unwrap());
        for (m, amplitude) in found.into_iter().enumerate().take(modes) {
            let level = exact(m, p);
            if level.abs() > 0.02 {
                errors.push((db(amplitude) - db(level)).abs());
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    errors
}

#[test]
fn at_a_thousand_points_a_plate_sounds_as_its_full_basis_says() {
    let field = StrikeField::new(plate());
    let point = |rng: &mut Rng| [PLATE_M[0] * rng.uniform(), PLATE_M[1] * rng.uniform(), 0.0];
    let errors = errors(&field, point, plate_shape);
    let (median, p90) = (errors[errors.len() / 2], errors[errors.len() * 9 / 10]);
    println!("median {median:.3} dB, p90 {p90:.3} dB");
    assert!(median <= 1.0 && p90 <= 2.0, "median {median}, p90 {p90}");
}

#[test]
fn at_a_thousand_points_a_sphere_sounds_as_its_full_basis_says() {
    // A grid of latitudes and longitudes; zonal and sectoral harmonics.
    let (points, triangles) = closed_forms::sheet([2.0 * PI, PI], [48, 24]);
    let ball = |p: &[f64; 3]| [p[1].sin() * p[0].cos(), p[1].sin() * p[0].sin(), p[1].cos()].map(|x| 0.1 * x);
    let points: Vec<_> = points.iter().map(ball).collect();
    // Latitudes run downwards: the other way round to be anticlockwise from outside.
    let triangles: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let shape = |m: usize, p: [f64; 3]| {
        let [x, y, z] = p.map(|x| x / 0.1);
        match m {
            0 => z,
            1 => 1.5 * z * z - 0.5,
            2 => 2.5 * z * z * z - 1.5 * z,
            3 => x * x - y * y,
            4 => x * (x * x - 3.0 * y * y),
            _ => (35.0 * z.powi(4) - 30.0 * z * z + 3.0) / 8.0,
        }
    };
    let field = StrikeField::new(shapes((points, triangles), 6, |p| p.map(|x| x / 0.1), shape));
    let point = |rng: &mut Rng| {
        let p = [rng.normal(), rng.normal(), rng.normal()];
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| 0.1 * x / length)
    };
    let errors = errors(&field, point, shape);
    let (median, p90) = (errors[errors.len() / 2], errors[errors.len() * 9 / 10]);
    println!("median {median:.3} dB, p90 {p90:.3} dB");
    assert!(median <= 1.0 && p90 <= 2.0, "median {median}, p90 {p90}");
}

#[test]
fn a_direction_turns_the_sound_and_its_length_does_not() {
    let field = StrikeField::new(plate());
    let at = [0.13, 0.07, 0.5];
    let down = field.amplitudes(&field.place(at, None).unwrap());
    let up = field.amplitudes(&field.place(at, Some([0.0, 0.0, 3.0])).unwrap());
    let along = field.amplitudes(&field.place(at, Some([1.0, 0.0, 0.0])).unwrap());
    let slanted = field.amplitudes(&field.place(at, Some([0.5, 0.0, -0.5])).unwrap());
    for m in 0..30 {
        assert_eq!(down[m], -up[m]);
        assert_eq!(along[m], 0.0);
        assert!((slanted[m] - down[m] / 2.0_f64.sqrt()).abs() < 1e-6);
    }
    assert!(field.place([f64::NAN, 0.0, 0.0], None).is_none());
    assert_eq!(field.place(at, Some([0.0; 3])), field.place(at, None));
}
