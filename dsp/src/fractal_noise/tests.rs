use super::*;

#[test]
fn roughness_maps_to_the_exponents_of_the_paper() {
    assert_eq!(FractalNoise::alpha(0.0), 2.5);
    assert_eq!(FractalNoise::alpha(1.0), 1.0);
    assert_eq!(FractalNoise::alpha(-3.0), 2.5);
}

#[test]
fn the_polynomials_are_the_powers_they_stand_for() {
    for n in 0..=100 {
        let r = n as f32 / 100.0;
        let exact = libm::pow(2.0, -0.75 * (1.0 - f64::from(r)));
        assert!((f64::from(octave_ratio(r)) / exact - 1.0).abs() < 2e-6, "{r}");
        assert!((f64::from(inverse_octave_ratio(r)) * exact - 1.0).abs() < 2e-6, "{r}");
    }
}

#[test]
fn fixed_point_keeps_every_place_to_four_picometres() {
    for cells in [0.0, 0.25, -0.25, 1.0 / 3.0, -123_456.789, 8.5e6, -8.5e6 + 0.1] {
        let fixed = fixed_point(cells) as i64;
        assert!((fixed as f64 / 4_294_967_296.0 - cells).abs() * LONGEST_CELL_M < 4e-12, "{cells}: {fixed}");
    }
}

#[test]
fn an_octave_fades_between_four_and_two_samples_a_cell() {
    assert_eq!((footprint_weight(1.9), footprint_weight(2.0)), (0.0, 0.0));
    assert_eq!((footprint_weight(4.0), footprint_weight(1e9)), (1.0, 1.0));
    assert!((footprint_weight(3.0) - 0.5).abs() < 1e-6);
}

#[test]
fn a_field_is_its_seed() {
    assert_eq!(
        FractalNoise::with_kernel(4, Kernel::Portable),
        FractalNoise::with_kernel(4, Kernel::Portable)
    );
    assert_ne!(FractalNoise::new(4), FractalNoise::new(4 + (1 << 40)));
}
