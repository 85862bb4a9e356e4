//! Volume meshes made here: a block cut into cells of six tetrahedra, and maps of it.

// Each test uses some of them.
#![allow(dead_code)]

use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::vector::Vec3;
use asperity_shape::volume_mesh::VolumeMesh;

/// A block from 0 to `sides`, `cells` cells along each, every cell cut into six tetrahedra around
/// its diagonal.
pub fn block(sides: Vec3, cells: [usize; 3]) -> VolumeMesh {
    let [nx, ny, nz] = cells;
    let index = |i: usize, j: usize, k: usize| (i + (nx + 1) * (j + (ny + 1) * k)) as u32;
    let mut points = Vec::new();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let at = [i as f64 / nx as f64, j as f64 / ny as f64, k as f64 / nz as f64];
                points.push(std::array::from_fn(|c| sides[c] * at[c]));
            }
        }
    }
    let mut tets = Vec::new();
    // Paths from one corner of a cell to the opposite one, an axis at a time.
    for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
        let odd = matches!(order, [0, 2, 1] | [2, 1, 0] | [1, 0, 2]);
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let mut at = [i, j, k];
                    let mut tet = [index(i, j, k); 4];
                    for (n, &axis) in order.iter().enumerate() {
                        at[axis] += 1;
                        tet[n + 1] = index(at[0], at[1], at[2]);
                    }
                    if odd {
                        tet.swap(2, 3);
                    }
                    tets.push(tet);
                }
            }
        }
    }
    VolumeMesh { points, tets }
}

/// The boundary of a volume mesh.
pub fn surface_of(mesh: &VolumeMesh) -> SurfaceMesh {
    SurfaceMesh { points: mesh.points.clone(), triangles: mesh.boundary() }
}

/// A box of twelve triangles from 0 to `sides`.
pub fn box_surface(sides: Vec3) -> SurfaceMesh {
    surface_of(&block(sides, [1, 1, 1]))
}

/// A block from −1 to 1 whose points are moved by `place`.
pub fn mapped(cells: [usize; 3], place: impl Fn(Vec3) -> Vec3) -> VolumeMesh {
    let mut mesh = block([2.0; 3], cells);
    mesh.points.iter_mut().for_each(|p| *p = place(p.map(|x| x - 1.0)));
    mesh
}

/// A solid ball.
pub fn ball(radius_m: f64, cells: usize) -> VolumeMesh {
    mapped([cells; 3], |p| {
        let r = p.iter().fold(0.0_f64, |r, x| r.max(x.abs()));
        let l = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        if l == 0.0 { p } else { p.map(|x| radius_m * x * r / l) }
    })
}

/// A body of revolution: `profile(along, across)` gives radius and height for 0–1 along the wall
/// and 0–1 across it; a radius of 0 is the axis.
pub fn lathe(cells: [usize; 3], profile: impl Fn(f64, f64) -> (f64, f64)) -> VolumeMesh {
    let [around, along, across] = cells;
    let grid = block([1.0; 3], cells);
    let number = |p: &Vec3| {
        let i = (p[0] * around as f64).round() as usize % around;
        let j = (p[1] * along as f64).round() as usize;
        let k = (p[2] * across as f64).round() as usize;
        let on_axis = profile(j as f64 / along as f64, k as f64 / across as f64).0 == 0.0;
        let i = if on_axis { 0 } else { i };
        (i + around * (j + (along + 1) * k)) as u32
    };
    let mut points = vec![[0.0; 3]; around * (along + 1) * (across + 1)];
    for p in &grid.points {
        let (r, z) = profile(p[1], p[2]);
        let (s, c) = (std::f64::consts::TAU * (p[0] * around as f64).round() / around as f64).sin_cos();
        if p[0] < 1.0 {
            points[number(p) as usize] = [r * c, r * s, z];
        }
    }
    let tets = grid.tets.iter().map(|t| t.map(|i| number(&grid.points[i as usize])));
    let whole = |t: &[u32; 4]| (0..4).all(|i| (0..i).all(|j| t[i] != t[j]));
    VolumeMesh { points, tets: tets.filter(whole).collect() }.checked(&mut Vec::new()).unwrap()
}

/// Half a hollow ball, open below.
pub fn bowl(mean_radius_m: f64, wall_m: f64, cells: [usize; 3]) -> VolumeMesh {
    lathe(cells, |along, across| {
        if along == 0.0 {
            return (0.0, mean_radius_m + wall_m * (across - 0.5));
        }
        let (s, c) = (0.5 * std::f64::consts::PI * along).sin_cos();
        let r = mean_radius_m + wall_m * (across - 0.5);
        (r * s, r * c)
    })
}
