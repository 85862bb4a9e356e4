use super::*;
use crate::model::modal_model::MAX_POSITIONS;
use asperity_dsp::rng::Rng;

/// A material of which every stock shape of 0.3 m has its lowest modes in the audible range.
const EVEN: Material = Material { poisson: 0.3, alpha_per_s: 0.0, eta: 0.0, beta_s: 0.0, ..Material::STEEL };

fn frequencies_hz(shape: Stock, material: &Material, size_m: f64) -> Vec<f64> {
    shape.modes(material, size_m).unwrap().modes.iter().map(|mode| mode.frequency_hz).collect()
}

fn ratios(shape: Stock) -> Vec<f64> {
    let modes = shape.shape(&EVEN, 0.3).modes;
    modes.iter().map(|(omega, _)| omega / modes[0].0).collect()
}

fn assert_close(ours: &[f64], published: &[f64], within: f64) {
    for (ours, published) in ours.iter().zip(published) {
        assert!((ours / published - 1.0).abs() < within, "{ours} against {published}");
    }
}

#[test]
fn a_bar_matches_an_independent_timoshenko_solver_within_a_hundredth() {
    // tests/independent/stock_modes.py: ω L² √(ρ A / (E I)) of a free bar 30 times as long as
    // thick.
    let exact = [22.283, 60.967, 118.24, 192.77, 283.2, 388.07, 505.86, 635.08, 774.34, 922.34];
    let gyration_m = 0.01 / 12f64.sqrt();
    let unit = gyration_m * EVEN.rod_speed_m_s() / 0.09;
    let ours: Vec<f64> = bar(&EVEN, 0.3).modes.iter().map(|(omega, _)| omega / unit).collect();
    assert_close(&ours, &exact, 0.01);
}

#[test]
fn a_slender_bar_has_its_closed_forms_roots_and_shapes() {
    // Blevins, Formulas for natural frequency and mode shape: 4.730041, 7.853205, 10.995608.
    for (n, root) in [(1, 4.730_040_74), (2, 7.853_204_62), (3, 10.995_607_8), (4, 14.137_165_5)] {
        assert!((bending_root(n) - root).abs() < 1e-7, "{n}");
        // An end moves twice the root mean square; the nodes of the first mode lie at 0.2242
        // lengths.
        assert!((bending_shape(root, 0.0) - 2.0).abs() < 1e-6);
    }
    assert!(bending_shape(bending_root(1), 0.22416).abs() < 1e-4);
    for n in [1, 5, 24] {
        let points = 20_000;
        let square = |i| bending_shape(bending_root(n), (i as f64 + 0.5) / points as f64).powi(2);
        let mean: f64 = (0..points).map(square).sum::<f64>() / points as f64;
        assert!((mean - 1.0).abs() < 1e-3, "mode {n}: mean square {mean}");
    }
}

#[test]
fn stock_shapes_have_the_published_ratios_of_their_modes() {
    // Rayleigh, Theory of sound, section 235.
    assert_close(&ratios(Stock::Bowl), &[1.0, 2.8102, 5.4316], 1e-4);
    // Leissa, J. Sound Vib. 31 (1973), upper bounds of a Ritz method with fewer terms: 13.489,
    // 19.789, 24.432, 35.024.
    assert_close(&ratios(Stock::Plate), &[1.0, 19.789 / 13.489, 24.432 / 13.489, 35.024 / 13.489], 0.01);
    // Leissa, NASA SP-160 (1969), table 2.5, at ν = 0.33: 5.253, 9.084, 12.23, 20.52, 21.6.
    assert_close(
        &ratios(Stock::Disc),
        &[1.0, 9.084 / 5.253, 12.23 / 5.253, 20.52 / 5.253, 21.6 / 5.253],
        0.04,
    );
    // Hoppe's ring: √(m² (m² − 1)² / (m² + 1)), m = 2, 3, 4.
    assert_close(&ratios(Stock::Ring), &[1.0, 2.8284, 5.4233], 1e-4);
}

#[test]
fn pitch_falls_with_size_and_rises_with_the_speed_of_sound() {
    let mut rng = Rng::new(5);
    for (name, shape) in Stock::ALL {
        for _ in 0..20 {
            let factor = 0.5 + rng.uniform();
            let base = shape.shape(&EVEN, 0.3);
            let larger = shape.shape(&EVEN, 0.3 * factor);
            let stiffer = shape.shape(&Material { young_pa: EVEN.young_pa * factor, ..EVEN }, 0.3);
            for ((base, _), ((larger, _), (stiffer, _))) in
                base.modes.iter().zip(larger.modes.iter().zip(&stiffer.modes))
            {
                assert!((larger * factor / base - 1.0).abs() < 1e-9, "{name}");
                assert!((stiffer / (base * factor.sqrt()) - 1.0).abs() < 1e-9, "{name}");
            }
            assert!((larger.mass_kg / (base.mass_kg * factor.powi(3)) - 1.0).abs() < 1e-9, "{name}");
        }
    }
}

#[test]
fn every_shape_of_every_material_is_a_model_the_engine_takes() {
    for (name, shape) in Stock::ALL {
        for preset in Material::PRESETS {
            for size_m in [SIZE_M.low, 0.02, 0.3, 3.0, SIZE_M.high] {
                let model = shape.modes(&preset.material, size_m).unwrap();
                let checked = ModalModel::new(model.modes.clone(), model.impulse_n_s).unwrap();
                let placed = checked.with_positions(model.positions.clone());
                assert!(placed.is_ok(), "{name} of {}, {size_m} m: {placed:?}", preset.name);
                assert!(model.position_count() <= MAX_POSITIONS);
                assert!(model.modes.iter().all(|m| (LOWEST_HZ..=HIGHEST_HZ).contains(&m.frequency_hz)));
            }
        }
    }
    assert_eq!(Stock::Bar.modes(&Material::STEEL, 0.0).unwrap_err().field, "size_m");
    assert_eq!(Stock::Bar.modes(&Material { eta: f64::NAN, ..EVEN }, 0.3).unwrap_err().field, "eta");
}

#[test]
fn a_steel_bar_of_twenty_centimetres_has_its_closed_forms_pitch() {
    // f = 1.0279 h √(E/ρ) / L² for a free bar of thickness h (Fletcher and Rossing, The physics of
    // musical instruments, section 2.16).
    let lowest_hz = frequencies_hz(Stock::Bar, &Material::STEEL, 0.2)[0];
    let closed_form_hz = 1.0279 * (0.2 / 30.0) * (200e9f64 / 7850.0).sqrt() / 0.04;
    assert!((lowest_hz / closed_form_hz - 1.0).abs() < 6e-3, "{lowest_hz} against {closed_form_hz}");
}

#[test]
fn a_strike_at_a_node_leaves_that_mode_out() {
    let model = Stock::Bar.modes(&Material::STEEL, 0.3).unwrap();
    // The second mode has its node in the middle, the first its largest motion between two nodes.
    assert!(model.positions[0][1].abs() < 1e-6 * model.modes[1].amplitude.abs());
    assert!(model.positions[0][0].abs() > 0.3 * model.modes[0].amplitude.abs());
}

#[test]
fn a_door_is_the_published_plate_and_hollow_things_ring_lower() {
    // Leissa, J. Sound Vib. 31 (1973), free plate with sides 5 : 2: ω a² √(ρ h / D) of the longer
    // side.
    let published = [21.643, 33.050, 60.137, 71.484, 117.45];
    let stiffness = (plate_stiffness_n_m(&EVEN, 0.02) / (EVEN.density_kg_m3 * 0.02)).sqrt();
    let ours: Vec<f64> =
        Stock::Door.shape(&EVEN, 1.0).modes.iter().map(|(omega, _)| omega / stiffness).collect();
    assert_close(&ours, &published, 0.013);
    // Rayleigh's bound: a bottom holds a can's wall, so that it rings above the free cylinder of
    // its middle surface.
    let (radius, wall) = (1.0 / 3.0, 1.0 / 60.0);
    let free = wall / (12f64.sqrt() * radius * radius) * 6.0 / 5f64.sqrt();
    let can = Stock::Can.shape(&EVEN, 1.0).modes[0].0 / EVEN.rod_speed_m_s();
    assert!((free..1.3 * free).contains(&can), "{can} beside {free}");
    let lowest_hz = |shape: Stock| frequencies_hz(shape, &Material::SOFTWOOD, 0.4)[0];
    assert!(lowest_hz(Stock::Box) < 0.4 * lowest_hz(Stock::Block));
}
