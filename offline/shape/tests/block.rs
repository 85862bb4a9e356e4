//! A rectangular block against Rayleigh–Ritz, which knows no elements, and against a measured one.

use crate::common;

use asperity_shape::Elastic;
use asperity_shape::eigenmodes::{Wanted, solve};
use asperity_shape::system::System;

/// The aluminium of H. Ogi, K. Sato, T. Asada & M. Hirao, JASA 112, 2553 (2002): C11 and C44 in Pa,
/// kg/m³.
const C11_PA: f64 = 109.26e9;
const C44_PA: f64 = 26.72e9;
const DENSITY_KG_M3: f64 = 2788.0;
/// Its sides, m.
const SIDES_M: [f64; 3] = [11.92e-3, 10.93e-3, 9.86e-3];
/// What they measured, kHz: the lowest 30 resonances.
const MEASURED_KHZ: [f64; 30] = [
    116.716, 143.783, 158.081, 166.5, 169.523, 177.846, 183.875, 186.047, 190.341, 197.386, 201.133, 207.386,
    209.836, 214.753, 223.548, 231.266, 233.538, 234.717, 250.98, 251.256, 252.742, 256.122, 257.595,
    258.118, 259.035, 268.54, 277.113, 278.762, 282.311, 293.686,
];
/// The same block by tests/oracles/rayleigh_ritz.py at degree 12, Hz; degree 10 differs by less
/// than 0.01 %.
const RITZ_HZ: [f64; 20] = [
    116_254.32, 143_396.18, 158_346.89, 166_079.32, 169_342.85, 178_475.81, 184_714.18, 185_238.45,
    190_191.84, 197_671.42, 201_563.88, 207_096.86, 211_187.77, 215_650.27, 223_544.21, 231_149.08,
    233_325.93, 235_062.66, 250_960.37, 251_174.59,
];

#[test]
fn a_block_rings_as_rayleigh_ritz_and_the_laboratory_say() {
    let lambda = C11_PA - 2.0 * C44_PA;
    let material = Elastic {
        young_pa: C44_PA * (3.0 * lambda + 2.0 * C44_PA) / (lambda + C44_PA),
        poisson: lambda / (2.0 * (lambda + C44_PA)),
        density_kg_m3: DENSITY_KG_M3,
    };
    let mesh = common::block(SIDES_M, [10; 3]).checked(&mut Vec::new()).unwrap();
    let system = System::assemble(&mesh, &material);
    assert!((system.mass_kg() / (DENSITY_KG_M3 * SIDES_M.iter().product::<f64>()) - 1.0).abs() < 1e-12);
    let modes = solve(&system, &material, &Wanted { up_to_hz: None, most: 30 }, &mut |_| ()).unwrap();
    for (hz, ritz) in modes.frequency_hz.iter().zip(RITZ_HZ) {
        assert!((hz / ritz - 1.0).abs() < 1e-3, "{hz} against {ritz}");
    }
    let squares =
        modes.frequency_hz.iter().zip(MEASURED_KHZ).map(|(hz, khz)| (hz / (1e3 * khz) - 1.0).powi(2));
    let rms = (squares.sum::<f64>() / 30.0).sqrt();
    assert!(rms < 3e-3, "rms {rms}");
    assert!(modes.worst_residual < 1e-8);
    let omega2 = |hz: f64| (std::f64::consts::TAU * hz).powi(2);
    // Mass-normalised: the Rayleigh quotient's denominator is 1, its numerator ω².
    let phi = modes.motions.col_as_slice(7);
    let mut product = vec![0.0; system.unknowns()];
    system.times_mass(phi, &mut product);
    let mass: f64 = phi.iter().zip(&product).map(|(a, b)| a * b).sum();
    system.times_stiffness(phi, &mut product);
    let stiffness: f64 = phi.iter().zip(&product).map(|(a, b)| a * b).sum();
    assert!((mass - 1.0).abs() < 1e-9 && (stiffness / omega2(modes.frequency_hz[7]) - 1.0).abs() < 1e-9);
}

#[test]
fn every_mode_below_a_frequency_is_found_and_no_other() {
    let material = Elastic { young_pa: 200e9, poisson: 0.29, density_kg_m3: 7850.0 };
    // A cube has its modes in twos and threes.
    let mesh = common::block([0.1; 3], [4; 3]).checked(&mut Vec::new()).unwrap();
    let system = System::assemble(&mesh, &material);
    let all = solve(&system, &material, &Wanted { up_to_hz: None, most: 60 }, &mut |_| ()).unwrap();
    let at = 0.5 * (all.frequency_hz[30] + all.frequency_hz[35]);
    let wanted = Wanted { up_to_hz: Some(at), most: usize::MAX };
    let below = solve(&system, &material, &wanted, &mut |_| ()).unwrap();
    assert_eq!(below.frequency_hz.len(), all.frequency_hz.iter().filter(|&&hz| hz < at).count());
    assert!(below.frequency_hz.iter().zip(&all.frequency_hz).all(|(a, b)| (a / b - 1.0).abs() < 1e-9));
}
