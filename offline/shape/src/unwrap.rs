//! Unwrapping: texture coordinates, in metres, for a surface that has none.
//!
//! | method | least | by |
//! |---|---|---|
//! | [`Method::Energy`] | change of lengths and areas (`energy`) | damped Newton steps |
//! | [`Method::Smooth`] | roughness of u and v over the mesh's graph, the rim held on a circle (`smooth`) | one linear solve |
//!
//! Source: the thesis on graphics textures, equations 4.13–4.22 and 4.24–4.27. A surface is one
//! piece with one rim: a tube or a closed body is cut open first.

mod energy;
mod smooth;

use crate::error::ShapeError;
use crate::surface_mesh::SurfaceMesh;
use crate::triangle_tree::area_vector;
use crate::vector::{Vec3, length, sub};
pub use energy::PHI;
use rustc_hash::FxHashMap;
use serde::Serialize;

/// Coordinates of a vertex, m.
pub type Uv = [f64; 2];

/// Way to unwrap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Least change of lengths, weighed φ, and areas, weighed 1 − φ.
    Energy(f64),
    /// Smooth coordinates.
    Smooth,
}

/// Coordinates, and how good they are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unwrapped {
    /// A pair a vertex, m, from (0, 0) on.
    #[serde(skip)]
    pub uv: Vec<Uv>,
    /// Name of the method.
    pub method: &'static str,
    /// Weight of lengths, where there is one.
    pub phi: Option<f64>,
    /// Value of the method's functional, m².
    pub energy: f64,
    /// Triangles that are turned over.
    pub flipped: usize,
    /// Area in the plane over area on the surface.
    pub area_distortion: Spread,
}

/// Area in the plane over area on the surface, triangle by triangle, scaled to a mean of 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean before that scaling.
    pub scale: f64,
    /// Mean: 1.
    pub mean: f64,
    /// Least.
    pub min: f64,
    /// Greatest.
    pub max: f64,
    /// Standard deviation.
    pub deviation: f64,
}

/// A surface with its edges, each once, and its rim.
struct Sheet<'a> {
    mesh: &'a SurfaceMesh,
    edges: Vec<[u32; 2]>,
    rim: Vec<u32>,
}

/// Unwraps a surface whose points are joined.
///
/// # Errors
/// When it is no single piece with one rim, or the solve fails.
pub fn unwrap(mesh: &SurfaceMesh, method: Method) -> Result<Unwrapped, ShapeError> {
    let sheet = Sheet::of(mesh)?;
    let (mut uv, name, phi, energy) = match method {
        Method::Smooth => {
            let uv = smooth::solve(&sheet, smooth::Rows::All)?;
            let roughness = smooth::roughness(&sheet, &uv);
            (uv, "smooth", None, roughness)
        }
        Method::Energy(phi) => {
            let (uv, energy) = energy::solve(&sheet, phi)?;
            (uv, "energy", Some(phi), energy)
        }
    };
    let low = [0, 1].map(|axis| uv.iter().fold(f64::INFINITY, |low, uv| low.min(uv[axis])));
    uv.iter_mut().for_each(|uv| *uv = [uv[0] - low[0], uv[1] - low[1]]);
    let flat: Vec<f64> = mesh.triangles.iter().map(|&triangle| 0.5 * det(&uv, triangle)).collect();
    let flipped = flat.iter().filter(|area| **area <= 0.0).count();
    let ratio: Vec<f64> =
        flat.iter().zip(mesh.all_corners()).map(|(a, t)| a / length(area_vector(t))).collect();
    Ok(Unwrapped { uv, method: name, phi, energy, flipped, area_distortion: Spread::of(&ratio) })
}

impl Spread {
    fn of(ratios: &[f64]) -> Self {
        let count = ratios.len().max(1) as f64;
        let scale = ratios.iter().sum::<f64>() / count;
        let scaled = || ratios.iter().map(|ratio| ratio / scale);
        let (min, max) = scaled().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let deviation = (scaled().map(|x| (x - 1.0).powi(2)).sum::<f64>() / count).sqrt();
        Self { scale, mean: 1.0, min, max, deviation }
    }
}

/// Twice the area of a triangle in the plane, below 0 where it is turned over.
fn det(uv: &[Uv], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|corner| uv[corner as usize]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl<'a> Sheet<'a> {
    fn of(mesh: &'a SurfaceMesh) -> Result<Self, ShapeError> {
        let refuse = |what: String, right: &str| ShapeError::new("--unwrap", what, right);
        let mut uses: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        for &[a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *uses.entry(edge).or_default() += 1;
            }
        }
        if let Some(((a, b), _)) = uses.iter().find(|(_, count)| **count > 1) {
            let what = format!("three or more triangles meet at the edge {a}–{b}, or turn two ways");
            return Err(refuse(what, "must be a surface: two triangles at an edge"));
        }
        let next: FxHashMap<u32, u32> =
            uses.keys().filter(|(a, b)| !uses.contains_key(&(*b, *a))).copied().collect();
        let open = uses.keys().filter(|(a, b)| !uses.contains_key(&(*b, *a))).count();
        if open == 0 {
            return Err(refuse(
                "the surface is closed and has no rim".to_owned(),
                "cut it open along a seam first",
            ));
        }
        let start = next.keys().copied().min().unwrap_or(0);
        let mut rim = vec![start];
        while let Some(&to) = next.get(&rim[rim.len() - 1]).filter(|to| **to != start && rim.len() <= open) {
            rim.push(to);
        }
        let mut edges: Vec<[u32; 2]> = uses.keys().map(|&(a, b)| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        let pieces = pieces(mesh.points.len(), &edges);
        if pieces != 1 {
            return Err(refuse(
                format!("the surface has {pieces} pieces"),
                "must be one: name it with --part",
            ));
        }
        let euler = mesh.points.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64;
        if rim.len() != open || euler != 1 {
            let what = "the surface is a tube, has holes or touches itself in a point";
            return Err(refuse(what.to_owned(), "must have one rim: cut it open, or close its holes, first"));
        }
        Ok(Self { mesh, edges, rim })
    }

    /// Length of an edge, m.
    fn length_m(&self, [a, b]: [u32; 2]) -> f64 {
        let point = |i: u32| -> Vec3 { self.mesh.points[i as usize] };
        length(sub(point(a), point(b)))
    }
}

/// Pieces that edges leave of so many vertices.
fn pieces(points: usize, edges: &[[u32; 2]]) -> usize {
    let mut root: Vec<u32> = (0..points as u32).collect();
    let find = |mut at: u32, root: &mut Vec<u32>| {
        while root[at as usize] != at {
            root[at as usize] = root[root[at as usize] as usize];
            at = root[at as usize];
        }
        at
    };
    let mut count = points;
    for &[a, b] in edges {
        let (a, b) = (find(a, &mut root), find(b, &mut root));
        if a != b {
            root[a as usize] = b;
            count -= 1;
        }
    }
    count
}
