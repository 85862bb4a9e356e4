use super::*;

#[test]
fn roughness_maps_to_the_exponents_of_the_paper() {
    assert_eq!(FractalNoise::alpha(0.0), 2.5);
    assert_eq!(FractalNoise::alpha(1.0), 1.0);
    assert_eq!(FractalNoise::alpha(-3.0), 2.5);
}

#[test]
fn a_field_is_its_seed() {
    assert_eq!(FractalNoise::new(4), FractalNoise::new(4));
    assert_ne!(FractalNoise::new(4), FractalNoise::new(4 + (1 << 40)));
}
