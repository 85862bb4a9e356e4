//! Touches of sand: what a contact gives the simulation, and what it gets.

use super::super::around::{Around, level_around, seen_level_m};
use super::super::hand_over::{Link, Near, fade_samples, give_back};
use super::super::law::BEARING_DEPTH_M;
use super::super::simulation::Pose;
use super::SandSource;
use crate::height_field::{MAX_BLOCK, Reaction, Touch};

/// A tip's depth is stated below the sand so many radii of its print around it: beyond the heap
/// that it pushes up itself, which would change its own force by 2 % (twice as wide as where the
/// tool's level is looked for).
const WIDE: f64 = 2.0;

impl SandSource {
    /// Lets sand slide for the frames in which nothing touched it.
    fn catch_up(&mut self, sample: u64) {
        let Link::Here(simulation) = &mut self.link else { return };
        while sample >= self.next_frame + self.frame_samples && !simulation.is_at_rest() {
            simulation.frame();
            self.next_frame += self.frame_samples;
        }
    }

    /// Hands the simulation a touch and takes what it has to say.
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

    /// The force at which the sand carries a tip `depth_m` below the untouched bed, N.
    pub(super) fn support_force_n(&self, position_m: [f64; 2], depth_m: f64) -> f64 {
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
    pub(super) fn land(&mut self, touch: &Touch) {
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
    pub(super) fn press(&mut self, touch: &Touch) -> Reaction {
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
