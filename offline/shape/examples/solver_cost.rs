//! What a solve costs: unknowns and seconds of a block of N³ cells, or of a bowl, 46 modes.
//!
//! `cargo run --release -p asperity-shape --example solver_cost -- 13` (or `-- bowl`)

use asperity_shape::body::{Making, make};
use asperity_shape::eigenmodes::Wanted;
use asperity_shape::elastic::Elastic;
use asperity_shape::mesh::Mesh;
use std::time::Instant;

#[path = "../tests/common/mod.rs"]
mod common;

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_else(|| "13".to_owned());
    let mesh = match wanted.parse() {
        Ok(cells) => common::block([0.1, 0.09, 0.08], [cells; 3]),
        Err(_) => common::bowl(0.05, 0.004, [72, 24, 1]),
    };
    let material = Elastic { young_pa: 70e9, poisson: 0.33, density_kg_m3: 2700.0 };
    let wanted = Wanted { up_to_hz: None, most: 46 };
    let making = Making { material, size_m: None, thickness_m: None, unit_m: None, wanted };
    let began = Instant::now();
    let body = make(Mesh::Volume(mesh), &making, &mut |_| ());
    match body {
        Ok(body) => println!(
            "{} unknowns, {} modes from {:.1} to {:.1} Hz in {:.1} s",
            body.degrees_of_freedom,
            body.frequency_hz.len(),
            body.frequency_hz[0],
            body.frequency_hz[body.frequency_hz.len() - 1],
            began.elapsed().as_secs_f64()
        ),
        Err(error) => println!("error: {error}"),
    }
}
