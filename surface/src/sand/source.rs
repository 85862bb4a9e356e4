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

use super::around::{Around, level_around, seen_level_m};
use super::grid::SandPicture;
use super::hand_over::{
    Link, Near, PATCHES_A_CONTACT, Slot, circulating, fade_samples, frame_samples, give_back, patches, rings,
};
use super::law::{BEARING_DEPTH_M, SandLaw};
use super::patch::Patch;
use super::simulation::{Pose, SandDesign, SandFigures, SandSimulation};
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

/// A tip's depth is told below the sand so many radii of its print around it: beyond the heap that
/// it pushes up itself, which would tell on its own force by 2 % (twice as wide as where the tool's
/// level is looked for).
const WIDE: f64 = 2.0;

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

    /// Lets sand slide for the frames in which nothing touched it.
    fn catch_up(&mut self, sample: u64) {
        let Link::Here(simulation) = &mut self.link else { return };
        while sample >= self.next_frame + self.frame_samples && !simulation.is_at_rest() {
            simulation.frame();
            self.next_frame += self.frame_samples;
        }
    }

    /// Tells the simulation about a touch and takes what it has to say.
    fn exchange(&mut self, touch: &Touch) {
        // Whoever was lifted, or comes here with a surface that was replaced, lands without being
        // announced.
        if self.slots.get(touch.contact).is_some_and(|slot| slot.next_touch != Some(touch.sample)) {
            self.land(touch);
        }
        self.catch_up(touch.sample);
        let Some(slot) = self.slots.get_mut(touch.contact) else { return };
        slot.next_touch = Some(touch.sample + MAX_BLOCK as u64);
        let pose = Pose { landed: slot.landed, ..pose(touch) };
        match &mut self.link {
            Link::Here(simulation) => {
                simulation.set_pose(pose);
                slot.landed = false;
                if touch.sample < self.next_frame {
                    return;
                }
                self.next_frame = (touch.sample / self.frame_samples + 1) * self.frame_samples;
                simulation.frame();
                simulation.write_overview(&mut self.overview);
                for (contact, slot) in self.slots.iter_mut().enumerate() {
                    if simulation.is_down(contact)
                        && let Some(mut patch) = slot.waiting.take().or_else(|| self.spare.pop())
                    {
                        simulation.write_patch(contact, &mut patch);
                        slot.waiting = Some(patch);
                    }
                }
            }
            Link::Elsewhere { near: Near { poses, patches, back, .. }, .. } => {
                let (poses, patches, back) = (poses.get_mut(), patches.get_mut(), back.get_mut());
                // A full ring: the simulation is late and will hear the next pose.
                if poses.push(pose).is_ok() {
                    slot.landed = false;
                }
                while let Ok(patch) = patches.pop() {
                    let replaced = match self.slots.get_mut(patch.contact) {
                        Some(slot) => slot.waiting.replace(patch),
                        None => Some(core::mem::replace(&mut self.overview, patch)),
                    };
                    give_back(replaced, back, &mut self.spare);
                }
                while let Some(patch) = self.spare.pop() {
                    if let Err(rtrb::PushError::Full(patch)) = back.push(patch) {
                        self.spare.push(patch);
                        break;
                    }
                }
            }
        }
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

    /// The force at which the sand carries a tip `depth_m` below the untouched bed, N.
    fn support_force_n(&self, position_m: [f64; 2], depth_m: f64) -> f64 {
        // A tip on its way up still stands between the heaps of its way down.
        let radius_m = WIDE * self.tool.print_radius_m(depth_m.max(BEARING_DEPTH_M));
        let level_m = match &self.link {
            Link::Here(simulation) => Some(simulation.level_m(position_m, radius_m)),
            Link::Elsewhere { .. } => seen_level_m(&self.moving_picture, position_m, radius_m),
        };
        // Before the simulation has run, the bed is untouched.
        let above_m = level_m.map_or(0.0, |level_m| level_m - self.depth_m);
        let law = self.law.target();
        law.force_over_n(law.met(position_m, above_m).as_ref(), depth_m + above_m)
    }

    /// Another contact begins here.
    fn land(&mut self, touch: &Touch) {
        self.catch_up(touch.sample);
        let Some(slot) = self.slots.get_mut(touch.contact) else { return };
        // Its patches belong to another place.
        self.spare.extend(slot.old.take().into_iter().chain(slot.new.take()).chain(slot.waiting.take()));
        slot.landed = true;
        slot.next_touch = Some(touch.sample.next_multiple_of(MAX_BLOCK as u64));
        match &self.link {
            Link::Here(simulation) => simulation.write_landing(&pose(touch), &mut slot.ground),
            Link::Elsewhere { .. } => {
                let sinks_m = self.law.target().depth_m(touch.normal_force_n);
                let radius_m = self.tool.print_radius_m(sinks_m);
                match seen_level_m(&self.moving_picture, touch.position_m, radius_m) {
                    Some(level_m) => {
                        let (picture, pose) = (&self.moving_picture, &pose(touch));
                        let (cell_m, depth_m) = (picture.cell_m(), self.depth_m);
                        let cell_at = |at| picture.height_at(at).unwrap_or(level_m);
                        let level_at = |at| level_around(cell_m, at, radius_m, cell_at);
                        let around = Around { pose, radius_m, cell_m, depth_m, sinks_m };
                        around.write(level_m, cell_at, level_at, &mut slot.ground);
                    }
                    // The simulation has not run yet.
                    None => slot.ground.clone_from(&self.overview),
                }
            }
        }
    }

    /// A contact presses on.
    fn press(&mut self, touch: &Touch) -> Reaction {
        self.exchange(touch);
        let turned = self
            .slots
            .get_mut(touch.contact)
            .map(|slot| slot.turn_over(touch.sample, fade_samples(self.frame_samples), &mut self.spare));
        let (wakes_contact, displaced_m2) = turned.unwrap_or((false, 0.0));
        let law = self.law.target();
        let speed = libm::hypot(touch.velocity_m_s[0], touch.velocity_m_s[1]);
        let (grain_rate_per_s, grain_impulse_n_s) = law.grains(displaced_m2, speed);
        Reaction { grain_rate_per_s, grain_impulse_n_s, wakes_contact, support_force_n: None }
    }
}

/// Place of a touch; a contact that has just landed says so itself.
fn pose(touch: &Touch) -> Pose {
    Pose {
        contact: touch.contact,
        position_m: touch.position_m,
        velocity_m_s: touch.velocity_m_s,
        normal_force_n: touch.normal_force_n,
        landed: false,
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
