//! A body of another size.

use asperity::{Material, ModalModel, ModalModelError, Mode, Stock};

#[test]
fn a_scaled_stock_body_sounds_as_one_made_so_large() {
    for (shape, material) in
        [(Stock::Bar, Material::STEEL), (Stock::Plate, Material::WOOD), (Stock::Bowl, Material::CERAMIC)]
    {
        for size in [0.7, 1.5] {
            let scaled = shape.modes(&material, 0.2).unwrap().scaled(size, &material).unwrap();
            let made = shape.modes(&material, 0.2 * size).unwrap();
            assert!(made.modes.len() > 3);
            for mode in made.modes.iter().filter(|mode| (20.0..10_000.0).contains(&mode.frequency_hz)) {
                let nearest = scaled.modes.iter().min_by(|a, b| {
                    let apart = |m: &Mode| (m.frequency_hz / mode.frequency_hz).ln().abs();
                    apart(a).total_cmp(&apart(b))
                });
                let nearest = nearest.unwrap();
                // Shapes keep their proportions; the damped frequency of a mode that is not yet
                // damped so moves a little.
                let cents = 1200.0 * (nearest.frequency_hz / mode.frequency_hz).log2();
                assert!(cents.abs() < 2.0, "{shape:?} x {size}: {} Hz, {cents} cents", mode.frequency_hz);
                let decay = nearest.decay_per_s / mode.decay_per_s;
                assert!(
                    (decay - 1.0).abs() < 0.01,
                    "{shape:?} x {size}: {} Hz, decay x {decay}",
                    mode.frequency_hz
                );
            }
        }
    }
}

#[test]
fn impossible_sizes_are_refused_and_size_one_changes_nothing() {
    let bowl = Stock::Bowl.modes(&Material::GLASS, 0.1).unwrap();
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = bowl.clone().scaled(size, &Material::GLASS);
        assert!(matches!(refused, Err(ModalModelError::BadValue { field, .. }) if field == "size"), "{size}");
    }
    assert!(bowl.clone().scaled(1e-9, &Material::GLASS).is_err(), "no mode is so high");
    assert_eq!(bowl.clone().scaled(1.0, &Material::GLASS).unwrap().modes, bowl.modes);
    let empty = ModalModel::silent().scaled(3.0, &Material::GLASS).unwrap();
    assert!(empty.modes.is_empty());
}
