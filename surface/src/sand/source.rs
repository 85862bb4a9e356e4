//! Sand as a surface: the hand-over between the simulation and the audio half.
//!
//! | who | does what |
//! |---|---|
//! | audio half, every 64 samples | sends the contact's pose, takes the newest patch, gives the old one back |
//! | simulation, 60 times a second | takes the poses, moves tools, lets sand slide, sends a patch a contact |
//!
//! Neither end ever waits (`hand_over`). From one patch to the next the height fades over a frame
//! on absolute samples.
//!
//! *Synchronous* sand ([`SandSource::synchronous`]) keeps the simulation in the source and runs a
//! frame wherever a contact's touch crosses a multiple of the frame length on the absolute sample
//! grid: renders are reproducible and do not depend on how time is split into blocks. It is for
//! rendering offline; a frame may take a millisecond.
//!
//! Height = the sand of the patch + grains (solid noise finer than a cell). A contact sinks as deep
//! as its print, d(F) of the [law](super::law), but not below the bottom of the bed; its drag is
//! the answer along the surface, instead of Coulomb friction and of the grains' slope, and grain
//! impacts that to a touch. A tip that stands at a depth is carried by the law at that depth below
//! the sand as it lies around it. A contact reads the sand it lands on until its first patch has
//! faded in; a patch that shows nothing new does not fade, and once none fades the sand does not
//! stir under a resting contact, which may sleep.

mod touches;

use super::grid::SandPicture;
use super::hand_over::{
    Link, PATCHES_A_CONTACT, Slot, circulating, fade_samples, frame_samples, patches, rings,
};
use super::law::SandLaw;
use super::patch::Patch;
use super::simulation::{SandDesign, SandFigures, SandSimulation};
use super::tool::Tool;
use super::worker::SandWorker;
use crate::fade::Fade;
use crate::force_output::ForceAt;
use crate::height_field::{
    Extension, Finish, HeightField, MAX_BLOCK, PathBlock, Properties, Reaction, Setup, SurfaceBlock, Touch,
    TouchKind, WavelengthBand,
};
use crate::moving_picture::MovingPicture;
use crate::solid_materials::SolidMaterial;
use crate::solid_noise::SolidNoise;
use crate::tip_law::TipLaw;
use asperity_dsp::DesignError;
use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// A surface of sand.
pub struct SandSource {
    link: Link,
    slots: Vec<Slot>,
    overview: Box<Patch>,
    spare: Vec<Box<Patch>>,
    law: Fade<SandLaw>,
    grains: SolidNoise,
    grain_relief: SurfaceBlock,
    sample_rate_hz: f64,
    frame_samples: u64,
    next_frame: u64,
    longest_m: f64,
    /// Depth of the untouched bed, metres.
    depth_m: f64,
    tool: Tool,
    moving_picture: Arc<MovingPicture>,
}

impl SandSource {
    /// Sand that is simulated inside the source, for rendering offline.
    ///
    /// # Errors
    /// Names the field that is out of its range.
    pub fn synchronous(design: &SandDesign, seed: u64) -> Result<Self, DesignError> {
        let simulation = SandSimulation::new(design)?;
        let picture = simulation.moving_picture().clone();
        Self::new(Link::Here(Box::new(simulation)), picture, design, seed)
    }

    /// Sand that is simulated elsewhere: the surface, and the worker to be run on another thread.
    ///
    /// # Errors
    /// Names the field that is out of its range.
    pub fn threaded(design: &SandDesign, seed: u64) -> Result<(Self, SandWorker), DesignError> {
        let simulation = SandSimulation::new(design)?;
        let picture = simulation.moving_picture().clone();
        // A contact that lands reads its ground there.
        picture.make();
        let (far, near) = rings(simulation.contacts());
        let line = Arc::new(Mutex::new(None));
        let worker = SandWorker { simulation, far, line: line.clone(), frames: 0 };
        Ok((Self::new(Link::Elsewhere { near, line }, picture, design, seed)?, worker))
    }

    fn new(
        link: Link,
        moving_picture: Arc<MovingPicture>,
        design: &SandDesign,
        seed: u64,
    ) -> Result<Self, DesignError> {
        // Grains fill the wavelengths below two cells.
        let mut grains = SolidMaterial::Sand.parameters();
        let cell_m = design.width_m / design.cells as f64;
        grains.texture_factor_per_m =
            grains.texture_factor_per_m.max(1.0 / (cell_m * grains.modules[0].frequency)).min(1e6);
        let mut sand = Self {
            link,
            moving_picture,
            slots: Vec::new(),
            depth_m: design.depth_m,
            overview: Box::new(Patch::flat()),
            spare: Vec::new(),
            law: Fade::new(design.law.under(design.tool.bearing(), design.tool.tip_radius_m())),
            tool: design.tool.clone(),
            grains: SolidNoise::new(grains, seed)?,
            grain_relief: SurfaceBlock::default(),
            sample_rate_hz: Setup::default().sample_rate_hz,
            frame_samples: 1,
            next_frame: 0,
            longest_m: design.width_m.max(design.height_m),
        };
        sand.get_ready(&Setup::default());
        Ok(sand)
    }

    /// Room for so many contacts that touch nothing yet, and the frames of a rate.
    fn get_ready(&mut self, setup: &Setup<'_>) {
        self.slots = (0..setup.voices).map(|_| Slot::new()).collect();
        let frame_samples = frame_samples(setup.sample_rate_hz);
        let next_frame = (self.next_frame as f64 * setup.sample_rate_hz / self.sample_rate_hz) as u64;
        self.next_frame = next_frame / frame_samples * frame_samples;
        (self.frame_samples, self.sample_rate_hz) = (frame_samples, setup.sample_rate_hz);
        match &mut self.link {
            Link::Here(simulation) => {
                simulation.make_room(setup.voices);
                self.spare = patches(setup.voices * PATCHES_A_CONTACT);
            }
            Link::Elsewhere { near, line } => {
                let far;
                (far, *near) = rings(setup.voices);
                self.spare = Vec::with_capacity(circulating(setup.voices));
                // Never locked by the audio half. A worker that died with it is no reader either.
                *line.lock().unwrap_or_else(PoisonError::into_inner) = Some(far);
            }
        }
    }

    /// Law that a device's loop feels of it.
    #[must_use]
    pub fn tip_law(&self) -> TipLaw {
        TipLaw::Sand(self.law.target())
    }

    /// The simulation, when it runs inside the source.
    #[must_use]
    pub fn simulation(&self) -> Option<&SandSimulation> {
        if let Link::Here(simulation) = &self.link { Some(simulation) } else { None }
    }

    /// Shapes synchronous sand before it is touched; nothing happens to sand that is elsewhere.
    pub fn shape(&mut self, height_m: impl FnMut(usize, usize) -> f64) {
        if let Link::Here(simulation) = &mut self.link {
            simulation.shape(height_m);
            simulation.write_overview(&mut self.overview);
        }
    }

    /// Lifts all tools, settles the sand and says what is left: volumes, slope, picture. `None`
    /// when the simulation is elsewhere ([`super::SandThread::stop`] gives it back).
    pub fn finish(&mut self) -> Option<(SandFigures, SandPicture)> {
        let Link::Here(simulation) = &mut self.link else { return None };
        simulation.settle();
        Some((simulation.figures(), simulation.picture()))
    }

    /// The drag of the law, and what a stone's flank pushes, in the place of what slopes and
    /// friction would push.
    fn answer(&self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let law = self.law.target();
        for (i, velocity_m_s) in path.velocity_m_s.iter().enumerate().take(MAX_BLOCK) {
            let weights = self.law.weights(path.first_sample + i as u64);
            let drag_s_per_m: f64 =
                weights.iter().zip(self.law.values()).map(|(w, l)| w * l.drag_s_per_m).sum();
            let met = law.met(path.position_m[i], out.height_m[i]);
            let aside = law.push_per_n(met.as_ref(), path.pressed_n(i));
            let push_per_n = [0, 1].map(|a| out.gradient[i][a] + aside[a] - drag_s_per_m * velocity_m_s[a]);
            out.answer.set(i, ForceAt { push_per_n, cap_n: law.cap_n, ..ForceAt::NONE });
        }
    }
}

impl HeightField for SandSource {
    /// The box has walls.
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let shortest_m = self.grains.properties(tile_m).band.shortest_m;
        Properties {
            extension: Extension::Edge,
            tip_law: Some(self.tip_law()),
            picture: Some(self.moving_picture.clone()),
            ..Properties::of(WavelengthBand { shortest_m, longest_m: self.longest_m })
        }
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.law.prepare(setup.sample_rate_hz);
        self.get_ready(setup);
        self.grains.prepare(setup)
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        self.grains.sample(&PathBlock { at_m: &[], full_power_m2: None, ..*path }, &mut self.grain_relief);
        out.clear(n);
        let fade_length = fade_samples(self.frame_samples) as f64;
        let Some(slot) = self.slots.get(path.contact) else { return };
        let ground = if slot.next_touch.is_some() { &slot.ground } else { &self.overview };
        let old = slot.old.as_ref().unwrap_or(ground);
        for i in 0..n {
            let at = path.position_m[i];
            let sample = path.first_sample + i as u64;
            let (mut height, mut slope) = (0.0, [0.0; 2]);
            let mut add = |weight: f64, patch: &Patch| {
                if weight != 0.0 {
                    let (h, g) = patch.at(at);
                    height += weight * h;
                    slope = [slope[0] + weight * g[0], slope[1] + weight * g[1]];
                }
            };
            match &slot.new {
                None => add(1.0, old),
                Some(new) => {
                    let t = (sample.saturating_sub(slot.fade_start) as f64 / fade_length).min(1.0);
                    let w = t * t * (3.0 - 2.0 * t);
                    add(1.0 - w, old);
                    add(w, new);
                }
            }
            out.height_m[i] = height + self.grain_relief.height_m[i];
            out.gradient[i] = [0, 1].map(|a| slope[a] + self.grain_relief.gradient[i][a]);
            let pressed_n = path.pressed_n(i);
            if pressed_n > 0.0 {
                let mut sinks_m = 0.0;
                for (weight, law) in self.law.weights(sample).iter().zip(self.law.values()) {
                    if *weight != 0.0 {
                        sinks_m += weight * law.depth_over_m(law.met(at, height).as_ref(), pressed_n);
                    }
                }
                // The bottom of the bed carries what the sand does not.
                out.compliance_m_n[i] = sinks_m.min((self.depth_m + height).max(0.0)) / pressed_n;
            }
        }
        if path.slopes {
            self.answer(path, out);
        }
    }

    fn touch(&mut self, touch: &Touch) -> Reaction {
        match touch.kind {
            TouchKind::Begins => {
                self.land(touch);
                Reaction::default()
            }
            TouchKind::Presses => self.press(touch),
            TouchKind::Stands { depth_m } => Reaction {
                support_force_n: Some(self.support_force_n(touch.position_m, depth_m)),
                ..Reaction::default()
            },
        }
    }

    /// Takes a [`SandLaw`], and gives its figures and picture to a [`Finish`].
    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        if let Some(Finish(results)) = change.downcast_ref() {
            let finished = self.finish().map(|finished| -> Box<dyn Any> { Box::new(finished) });
            results.borrow_mut().extend(finished);
            return true;
        }
        let Some(law) = change.downcast_ref::<SandLaw>() else { return false };
        if law.check().is_err() {
            return false;
        }
        self.law.set(law.under(self.tool.bearing(), self.tool.tip_radius_m()), sample);
        match &mut self.link {
            Link::Here(simulation) => simulation.set_law(*law),
            // A full ring: five changes within a frame, of which the simulation misses one.
            Link::Elsewhere { near, .. } => drop(near.laws.get_mut().push(*law)),
        }
        true
    }
}

crate::opaque::debug_by_name!(SandSource);
