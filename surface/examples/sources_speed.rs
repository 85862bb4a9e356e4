//! Prints nanoseconds per sample of every surface, of a map under a point and under a ball in soft
//! ground, and milliseconds per frame of sand.

use asperity_surface::footprint::sample_under;
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::sand::simulation::Pose;
use asperity_surface::sand::{SandDesign, SandSimulation, SandSource};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use asperity_surface::wrap::Wrap;
use std::hint::black_box;
use std::time::Instant;

/// Best of many blocks, ns a sample.
fn block_ns(source: &mut dyn HeightField) -> f64 {
    ns_of(true, |path, out| source.sample(path, out))
}

/// The same of whatever samples, with slopes or without.
fn ns_of(slopes: bool, mut sample: impl FnMut(&PathBlock<'_>, &mut SurfaceBlock)) -> f64 {
    let mut out = SurfaceBlock::default();
    let mut best = f64::INFINITY;
    for block in 0..5000_u64 {
        let at = |i: usize| [0.01 + 2e-6 * (64 * block + i as u64) as f64, 0.02];
        let position: [[f64; 2]; MAX_BLOCK] = core::array::from_fn(at);
        let path = PathBlock {
            position_m: &position,
            velocity_m_s: &[[0.0882, 0.0]; MAX_BLOCK],
            footprint_m: &[2e-6; MAX_BLOCK],
            normal_force_n: &[],
            first_sample: 64 * block,
            contact: 0,
            slopes,
            ..PathBlock::default()
        };
        let clock = Instant::now();
        sample(black_box(&path), &mut out);
        best = best.min(clock.elapsed().as_secs_f64());
        black_box(&out);
    }
    best * 1e9 / MAX_BLOCK as f64
}

fn main() {
    for material in SolidMaterial::SEVEN {
        if let Ok(mut source) = SolidNoise::new(material.parameters(), 1) {
            println!("solid {:12} {:6.1} ns a sample", material.name(), block_ns(&mut source));
        }
    }
    let cell = Raster::from_fn(64, 64, |x, y| 1e-5 * (x * y % 7) as f64);
    if let Ok(mut source) = Lattice::new(&cell, [0.01, 0.0], [0.003, 0.01]) {
        println!("lattice            {:6.1} ns a sample", block_ns(&mut source));
    }
    let heights = Raster::from_fn(1024, 1024, |x, y| ((x * 7 + y * 13) % 31) as f64 / 31.0);
    let extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 1e-3 };
    if let Ok(mut map) = HeightMap::new(&heights, extent, Wrap::Repeat) {
        println!("map, a point       {:6.1} ns a sample", ns_of(false, |path, out| map.sample(path, out)));
        for radius_m in [1e-4, 1e-3, 3e-3] {
            let ns = |map: &mut HeightMap, slopes| {
                ns_of(slopes, |path, out| sample_under(map, path, &[radius_m; MAX_BLOCK], out))
            };
            let (heard, pushed) = (ns(&mut map, false), ns(&mut map, true));
            println!("map, a ball {radius_m} m wide in it {heard:6.1} ns a sample, with slopes {pushed:6.1}");
        }
    }
    if let Ok(mut source) = SandSource::synchronous(&SandDesign::default(), 1) {
        println!("sand               {:6.1} ns a sample", block_ns(&mut source));
    }
    let design = SandDesign { width_m: 1.0, height_m: 1.0, cells: 1000, ..SandDesign::default() };
    let Ok(mut sand) = SandSimulation::new(&design) else { return };
    let mut times: Vec<f64> = (0..600)
        .map(|n| {
            let t = f64::from(n) / 60.0;
            let position_m = [0.5 + 0.25 * (1.1 * t).sin(), 0.5 + 0.2 * (2.3 * t).cos()];
            let velocity_m_s = [0.275 * (1.1 * t).cos(), -0.46 * (2.3 * t).sin()];
            sand.set_pose(Pose { contact: 0, position_m, velocity_m_s, normal_force_n: 5.0, landed: false });
            let clock = Instant::now();
            sand.frame();
            clock.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("sand 1000 × 1000: median {:.3} ms a frame, 95 % {:.3} ms", times[300], times[570]);
}
