mod common;
use asperity_shape::Elastic;
use asperity_shape::eigenmodes::{Wanted, solve};
use asperity_shape::filling::Body;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::system::System;
use asperity_shape::volume_mesh::VolumeMesh;
use std::time::Instant;
const STEEL: Elastic = Elastic { young_pa: 200e9, poisson: 0.29, density_kg_m3: 7850.0 };
fn modes(mesh: &VolumeMesh, count: usize) -> Vec<f64> {
    let t = Instant::now();
    let system = System::assemble(mesh, &STEEL);
    let m = solve(&system, &STEEL, &Wanted { up_to_hz: None, most: count }, &mut |_| ());
    match m {
        Ok(m) => {
            println!(
                "   {} unknowns {} tets vol {:.4e} {:?} res {:.1e}",
                system.unknowns(),
                mesh.tets.len(),
                mesh.volume_m3(),
                t.elapsed(),
                m.worst_residual
            );
            m.frequency_hz
        }
        Err(e) => {
            println!("   {e}");
            vec![]
        }
    }
}
fn fill(s: SurfaceMesh, unknowns: f64) -> Option<VolumeMesh> {
    let t = Instant::now();
    let mut told = vec![];
    let s = s.joined(&mut told).unwrap().closed(&mut told).unwrap();
    let body = Body::new(s).unwrap();
    let h = body.spacing_m(unknowns);
    let mesh = body.fill(h, &mut told);
    println!(
        "   wall {} spacing {h} expected {} {told:?} {:?}",
        body.wall_m,
        body.expected_unknowns(h),
        t.elapsed()
    );
    match mesh {
        Ok(m) => Some(m),
        Err(e) => {
            println!("   {e}");
            None
        }
    }
}
fn compare(name: &str, reference: &VolumeMesh, surface: SurfaceMesh, unknowns: &[f64]) {
    println!("{name}");
    let r = modes(reference, 20);
    println!("   {:.0?}", r);
    for &n in unknowns {
        if let Some(m) = fill(surface.clone(), n) {
            let f = modes(&m, 20);
            let e: Vec<f64> = f.iter().zip(&r).map(|(a, b)| 100.0 * (a / b - 1.0)).collect();
            println!("   worst {:.3} %  {:.2?}", e.iter().fold(0.0_f64, |w, x| w.max(x.abs())), e);
        }
    }
}
#[test]
fn probe() {
    let which = std::env::var("W").unwrap_or_default();
    let n: Vec<f64> =
        std::env::var("N").unwrap_or("8000,20000".into()).split(',').map(|x| x.parse().unwrap()).collect();
    if which.contains("box") {
        let s = [0.12, 0.08, 0.05];
        compare("box", &common::block(s, [12, 8, 6]), common::box_surface(s), &n);
    }
    if which.contains("plate") {
        let s = [0.2, 0.15, 0.003];
        compare("plate", &common::block(s, [32, 24, 1]), common::box_surface(s), &n);
    }
    if which.contains("ball") {
        let m = common::ball(0.05, 8);
        let s = common::surface_of(&common::ball(0.05, 24));
        compare("ball", &m, s, &n);
    }
    if which.contains("bowl") {
        let m = common::bowl(0.05, 0.004, [48, 16, 1]);
        let s = common::surface_of(&common::bowl(0.05, 0.004, [72, 24, 1]));
        compare("bowl", &m, s, &n);
    }
}
