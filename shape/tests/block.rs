//! A rectangular block against Rayleigh–Ritz.

mod common;

use asperity_shape::Elastic;
use asperity_shape::eigenmodes::{Wanted, solve};
use asperity_shape::system::System;
use std::time::Instant;

#[test]
fn probe() {
    let n: usize = std::env::var("N").ok().and_then(|n| n.parse().ok()).unwrap_or(6);
    let (c11, c44) = (109.26e9, 26.72e9);
    let lambda = c11 - 2.0 * c44;
    let material = Elastic {
        young_pa: c44 * (3.0 * lambda + 2.0 * c44) / (lambda + c44),
        poisson: lambda / (2.0 * (lambda + c44)),
        density_kg_m3: 2788.0,
    };
    let mesh = common::block([11.92e-3, 10.93e-3, 9.86e-3], [n, n, n]).checked(&mut Vec::new()).unwrap();
    let t = Instant::now();
    let system = System::assemble(&mesh, &material);
    println!("{} unknowns, {} kg, assembled {:?}", system.unknowns(), system.mass_kg(), t.elapsed());
    let modes = solve(&system, &material, &Wanted { up_to_hz: None, most: 46 }, &mut |x| {
        println!("{x:.2} {:?}", t.elapsed())
    })
    .unwrap();
    println!("{:?} residual {:e}", t.elapsed(), modes.worst_residual);
    println!("{:.1?}", modes.frequency_hz);
}
