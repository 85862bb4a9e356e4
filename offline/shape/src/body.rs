//! A mesh becomes a body that rings: solved, with its shapes on a triangulation of its surface.

use crate::eigenmodes::{Eigenmodes, MOST_MODES, Wanted, solve_within};
use crate::elastic::Elastic;
use crate::error::ShapeError;
use crate::facets::round_out;
use crate::factor::MOST_STEPS;
use crate::filling::Body;
use crate::mesh::Mesh;
use crate::repair::Cracks;
use crate::surface_field::{SurfaceField, surface_field};
use crate::surface_mesh::SurfaceMesh;
use crate::system::System;
use crate::triangle_tree::TriangleTree;
use crate::vector::{add_scaled, distance, longest_side};
use crate::volume_mesh::{EDGES, MOST_DEGREES_OF_FREEDOM, VolumeMesh, check_side};

/// Spacings to the shortest wave through the body and along a wall: the highest mode is then right
/// to about 1 %.
const PER_SHEAR_WAVE: f64 = 6.0;
const PER_BENDING_WAVE: f64 = 11.0;
/// A body longer than this is likely to be in other units, m: a 5-inch print is read as 5 m.
const LARGE_M: f64 = 2.0;
/// A body shorter than this is likely to be in other units, m.
const SMALL_M: f64 = 0.002;

/// Settings for making a body of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Making {
    /// Material.
    pub material: Elastic,
    /// Longest side it shall have, m; scales about the origin of its frame.
    pub size_m: Option<f64>,
    /// Length of the mesh's unit, m, unless a size is given; none: metres, and doubtful sizes are
    /// told.
    pub unit_m: Option<f64>,
    /// Thickness of the sheet that the surface is, m.
    pub thickness_m: Option<f64>,
    /// Which modes are wanted.
    pub wanted: Wanted,
}

/// Fineness of the filling of a surface: what a solve may cost, which grows with about the square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Unknowns of a mesh that neither walls nor waves want finer.
    pub ordinary_unknowns: f64,
    /// Unknowns that short waves may ask for; walls may ask for more.
    pub most_unknowns: f64,
}

impl Fineness {
    /// For a solve that somebody waits for: a cup's upper modes are 0.6 % off.
    pub const FULL: Self =
        Self { ordinary_unknowns: 55_000.0, most_unknowns: 0.8 * MOST_DEGREES_OF_FREEDOM as f64 };
    /// For a preview, in some hundredths of the time: upper modes are some per cent too high.
    pub const PREVIEW: Self = Self { ordinary_unknowns: 10_000.0, most_unknowns: 10_000.0 };
}

/// A solved body.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedBody {
    /// Undamped frequencies, Hz, rising.
    pub frequency_hz: Vec<f64>,
    /// Shapes of the modes on the surface.
    pub field: SurfaceField,
    /// Unknowns that were solved for.
    pub degrees_of_freedom: usize,
    /// Tetrahedra.
    pub elements: usize,
    /// Volume, m³.
    pub volume_m3: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Repairs and doubts, one line each.
    pub remarks: Vec<String>,
}

/// Makes a body of a mesh; `progress` gets the part done, 0 to 1.
///
/// ```
/// use asperity_shape::eigenmodes::Wanted;
/// use asperity_shape::{Elastic, Fineness, Making, make_as_fine_as, parse};
///
/// // A glass brick of 2 × 3 × 5 cm, as a mesh of eight points.
/// let obj = "v 0 0 0\nv .02 0 0\nv .02 .03 0\nv 0 .03 0\nv 0 0 .05\nv .02 0 .05\nv .02 .03 .05\nv 0 .03 .05\n\
///            f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
/// let mesh = parse("brick.obj".as_ref(), obj.as_bytes())?;
/// let glass = Elastic { young_pa: 70e9, poisson: 0.22, density_kg_m3: 2500.0 };
/// let wanted = Wanted { up_to_hz: None, most: 4 };
/// let making = Making { material: glass, size_m: None, unit_m: None, thickness_m: None, wanted };
/// let brick = make_as_fine_as(mesh, &making, &Fineness::PREVIEW, &mut |_| {})?;
/// assert!((brick.mass_kg - 0.075).abs() < 1e-4);
/// # Ok::<(), asperity_shape::ShapeError>(())
/// ```
///
/// # Errors
/// When the mesh is no body (open, empty, in parts, with walls too thin), a number is out of its
/// range, or the modes cannot be solved for.
pub fn make(mesh: Mesh, making: &Making, progress: &mut dyn FnMut(f64)) -> Result<SolvedBody, ShapeError> {
    make_as_fine_as(mesh, making, &Fineness::FULL, progress)
}

/// Solves as fine as is asked, where the mesh is a surface; a solid is solved as it is.
///
/// # Errors
/// Those of [`make`].
pub fn make_as_fine_as(
    mesh: Mesh,
    making: &Making,
    fineness: &Fineness,
    progress: &mut dyn FnMut(f64),
) -> Result<SolvedBody, ShapeError> {
    let material = making.material.checked()?;
    let mut remarks = Vec::new();
    let mut mesh = mesh.used();
    let middle = mesh.centre();
    if let Mesh::Surface(surface) = mesh {
        let cracks = if making.thickness_m.is_some() { Cracks::Hair } else { Cracks::Wide };
        let mut surface = surface.joined(cracks, &mut remarks)?;
        surface.leave_specks_out(&mut remarks);
        mesh = Mesh::Surface(surface);
    }
    let scale = making.scale(&mesh, &mut remarks)?;
    mesh.change(|p| p.map(|x| x * scale));
    // A mesh without points is refused below, for what it lacks.
    if !mesh.points().is_empty() {
        check_side(longest_side(mesh.points()))?;
    }
    let mut body = match mesh {
        Mesh::Volume(_) | Mesh::Curved(..) if making.thickness_m.is_some() => Err(ShapeError::new(
            "--thickness",
            "the mesh is a solid",
            "leave it out: only a sheet has a thickness",
        )),
        Mesh::Volume(volume) => from_volume(volume, None, &material, making, remarks, progress),
        Mesh::Curved(volume, surface) => {
            from_volume(volume, Some(&surface), &material, making, remarks, progress)
        }
        Mesh::Surface(surface) => {
            let body = Body::new(closed(surface, making.thickness_m, &mut remarks)?)?;
            let mended = remarks.join("; ");
            from_surface(&body, &material, (making, fineness), remarks, progress)
                .map_err(|error| error.after(&mended))
        }
    }?;
    for point in &mut body.field.points {
        *point = add_scaled(*point, scale, middle);
    }
    Ok(body)
}

fn from_volume(
    volume: VolumeMesh,
    curved: Option<&SurfaceMesh>,
    material: &Elastic,
    making: &Making,
    mut remarks: Vec<String>,
    progress: &mut dyn FnMut(f64),
) -> Result<SolvedBody, ShapeError> {
    let mut volume = volume.checked(&mut remarks)?;
    if let Some(surface) = curved {
        round_out(&mut volume, &TriangleTree::new(&surface.all_corners()));
    }
    let modes = solved(MOST_STEPS, &volume, material, &making.wanted, progress)?;
    if let Some(top) = modes.1.frequency_hz.last() {
        tell_coarse(&volume, material, *top, &mut remarks);
    }
    Ok(finished(&volume, modes, remarks))
}

fn closed(
    surface: SurfaceMesh,
    thickness_m: Option<f64>,
    remarks: &mut Vec<String>,
) -> Result<SurfaceMesh, ShapeError> {
    let Some(thickness_m) = thickness_m else { return surface.closed(remarks) };
    let side = longest_side(&surface.points);
    if !(thickness_m > 0.0 && thickness_m < 0.5 * side) {
        let right = format!("must be above 0 and less than half of the longest side, {:.4} m", 0.5 * side);
        return Err(ShapeError::new("--thickness", format!("{thickness_m} is refused"), right));
    }
    surface.thickened(thickness_m).joined(Cracks::Hair, remarks)?.closed(remarks)
}

/// Fills a surface at the spacing that walls and waves want, and once more where the highest mode
/// turns out shorter.
fn from_surface(
    body: &Body,
    material: &Elastic,
    (making, fineness): (&Making, &Fineness),
    mut remarks: Vec<String>,
    progress: &mut dyn FnMut(f64),
) -> Result<SolvedBody, ShapeError> {
    let wave = |hz: f64| {
        let bending_m = material.bending_wave_m(body.wall_m, hz) / PER_BENDING_WAVE;
        bending_m.min(material.shear_wave_m(hz) / PER_SHEAR_WAVE)
    };
    let mut spacing_m = body.spacing_m(fineness.ordinary_unknowns).min(body.longest_spacing_m());
    if let Some(hz) = making.wanted.up_to_hz.filter(|_| making.wanted.most > MOST_MODES) {
        spacing_m = spacing_m.min(wave(hz));
        let unknowns = body.expected_unknowns(spacing_m);
        if unknowns > MOST_DEGREES_OF_FREEDOM as f64 && spacing_m < body.longest_spacing_m() {
            let what = format!(
                "waves of {hz} Hz want points every {:.2} mm: {unknowns:.0} unknowns",
                1e3 * spacing_m
            );
            let right = format!("at most {MOST_DEGREES_OF_FREEDOM}: lower it, or give --max-modes");
            return Err(ShapeError::new("--up-to", what, right));
        }
    }
    let mut repairs = Vec::new();
    let mut volume = body.fill(spacing_m, &mut repairs)?;
    let first = &mut |done| progress(0.6 * done);
    let mut modes = solved(MOST_STEPS, &volume, material, &making.wanted, first)?;
    let finer_m = modes.1.frequency_hz.last().map_or(spacing_m, |top| wave(*top));
    if finer_m < 0.95 * spacing_m {
        let finest_m = body.spacing_m(fineness.most_unknowns).max(finer_m);
        if finest_m > 1.05 * finer_m {
            remarks.push(format!(
                "the mesh allowed has points every {:.2} mm, the highest modes want {:.2} mm: they are too high",
                1e3 * finest_m,
                1e3 * finer_m
            ));
        }
        // Where that is too fine for the work that is left, half of the way.
        let left = MOST_STEPS - modes.1.steps;
        for at_m in [finest_m, (finest_m * spacing_m).sqrt()] {
            if at_m >= 0.95 * spacing_m {
                break;
            }
            let mut repairs_there = Vec::new();
            let finer = body.fill(at_m, &mut repairs_there).and_then(|volume| {
                let progress = &mut |done| progress(0.6 + 0.4 * done);
                Ok((solved(left, &volume, material, &making.wanted, progress)?, volume))
            });
            match finer {
                Ok(finer) => {
                    ((modes, volume), repairs) = (finer, repairs_there);
                    break;
                }
                Err(error) => remarks.push(format!(
                    "points every {:.2} mm, which the highest modes want, cannot be solved for ({}): they are too high",
                    1e3 * at_m,
                    error.what
                )),
            }
        }
    }
    remarks.append(&mut repairs);
    Ok(finished(&volume, modes, remarks))
}

fn solved(
    most_steps: f64,
    volume: &VolumeMesh,
    material: &Elastic,
    wanted: &Wanted,
    progress: &mut dyn FnMut(f64),
) -> Result<(System, Eigenmodes), ShapeError> {
    let system = System::assemble(volume, material);
    let modes = solve_within(most_steps, &system, material, wanted, progress)?;
    Ok((system, modes))
}

fn finished(volume: &VolumeMesh, (system, modes): (System, Eigenmodes), remarks: Vec<String>) -> SolvedBody {
    SolvedBody {
        field: surface_field(volume, &system, &modes),
        degrees_of_freedom: system.unknowns(),
        elements: volume.tets.len(),
        volume_m3: volume.volume_m3(),
        mass_kg: system.mass_kg(),
        frequency_hz: modes.frequency_hz,
        remarks,
    }
}

impl Making {
    /// Metres to one unit of the mesh; a size that few objects have is reported where nothing was
    /// said about it.
    fn scale(&self, mesh: &Mesh, remarks: &mut Vec<String>) -> Result<f64, ShapeError> {
        let side = longest_side(mesh.points());
        if let Some(size_m) = self.size_m {
            if !(size_m > 0.0 && size_m.is_finite()) {
                return Err(ShapeError::new("--size", format!("{size_m} is refused"), "must be above 0 m"));
            }
            if !(side > 0.0 && side.is_finite()) {
                return Err(ShapeError::new("", "has no size", "its points must be finite and apart"));
            }
            return Ok(size_m / side);
        }
        let Some(unit_m) = self.unit_m else {
            if side > LARGE_M || (side > 0.0 && side < SMALL_M) {
                remarks.push(format!(
                    "the longest side is {side:.4} m; meshes are in metres, --unit or --size scales one in other units"
                ));
            }
            return Ok(1.0);
        };
        if unit_m > 0.0 && unit_m.is_finite() {
            return Ok(unit_m);
        }
        Err(ShapeError::new("--unit", format!("{unit_m} m is refused"), "must be above 0 m"))
    }
}

/// A given mesh is solved as it is; where its longest edge is long against the shortest wave, that
/// is told.
fn tell_coarse(volume: &VolumeMesh, material: &Elastic, top_hz: f64, remarks: &mut Vec<String>) {
    let shear_m = material.shear_wave_m(top_hz);
    let edge = |t: &[u32; 4]| {
        let c = volume.corners(*t);
        EDGES.iter().map(|&[a, b]| distance(c[a], c[b])).fold(0.0, f64::max)
    };
    let mut edges: Vec<f64> = volume.tets.iter().map(edge).collect();
    edges.sort_by(f64::total_cmp);
    let long = edges[edges.len() / 2];
    if long > shear_m / 3.0 {
        remarks.push(format!(
            "elements of {:.1} mm are long for waves of {:.1} mm at {top_hz:.0} Hz: the highest modes are too high",
            1e3 * long,
            1e3 * shear_m
        ));
    }
}
