//! Tracked tip: a pose becomes a contact with a force.

use crate::error::refused;
use crate::sources::Sources;
use asperity::files::scene_file::{SceneFile, SurfaceEntry};
use asperity::{ContactSample, Tip, TipCoupling, TipStep, TipSurface};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Event, surface, uv, velocity along u and v, force, and closing speed of a step.
type Told = (Option<&'static str>, Option<String>, Option<[f64; 2]>, Option<[f64; 2]>, f64, f64);

/// One tracked tip over the surfaces of a scene that have a frame.
#[pyclass(module = "asperity._native")]
pub struct TrackedTip {
    tip: Tip,
    names: Vec<String>,
}

#[pymethods]
impl TrackedTip {
    #[new]
    #[pyo3(signature = (scene, files, stiffness_n_m=None, mass_kg=None, max_force_n=None))]
    fn new(
        scene: PathBuf,
        files: &Bound<'_, PyDict>,
        stiffness_n_m: Option<f64>,
        mass_kg: Option<f64>,
        max_force_n: Option<f64>,
    ) -> PyResult<Self> {
        let sources = Sources::of(files)?;
        let file = SceneFile::load_from(&sources, &scene).map_err(|error| sources.told(error))?;
        let surfaces: Result<Vec<_>, _> = file.surfaces.iter().map(rectangle).collect();
        let mut coupling = TipCoupling::default();
        coupling.stiffness_n_m = stiffness_n_m.unwrap_or(coupling.stiffness_n_m);
        coupling.mass_kg = mass_kg.unwrap_or(coupling.mass_kg);
        coupling.max_force_n = max_force_n.unwrap_or(coupling.max_force_n);
        let tip = Tip::new(surfaces?, coupling).map_err(refused)?;
        Ok(Self { tip, names: file.surfaces.into_iter().map(|entry| entry.name).collect() })
    }

    fn step(&mut self, dt: f64, position_m: [f64; 3]) -> PyResult<Told> {
        let step = self.tip.step(dt, position_m).map_err(refused)?;
        Ok(self.told(step))
    }

    fn lift(&mut self) -> Told {
        let step = self.tip.lift();
        self.told(step)
    }
}

impl TrackedTip {
    fn told(&self, step: TipStep) -> Told {
        let name = |index: usize| Some(self.names[index].clone());
        let touches = |event, index: usize, sample: ContactSample| {
            let ContactSample { uv, velocity_m_s, normal_force_n, closing_m_s, .. } = sample;
            (Some(event), name(index), Some(uv), velocity_m_s, normal_force_n, closing_m_s)
        };
        match step {
            TipStep::Free => (None, None, None, None, 0.0, 0.0),
            TipStep::Begin(index, sample) => touches("begin", index, sample),
            TipStep::Move(index, sample) => touches("move", index, sample),
            TipStep::End(index) => (Some("end"), name(index), None, None, 0.0, 0.0),
        }
    }
}

fn rectangle(entry: &SurfaceEntry) -> PyResult<TipSurface> {
    let frame = entry.frame.ok_or_else(|| {
        let right = "a tracked tip must know where it lies: give it origin_m, u_axis and v_axis";
        refused(format!("surface \"{}\": frame: is missing; {right}", entry.name))
    })?;
    Ok(TipSurface { frame, size_m: [entry.width_m, entry.height_m] })
}
