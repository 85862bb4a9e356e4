//! The force law of solid noise: what a tool feels that stands in the block.
//!
//! ```text
//! F = L · n_p(T · x) along the law's direction, no more than the cap, − b v        while F_n > 0, else 0
//! ```
//!
//! The document returns a texture force only when the tool penetrates the object, and adds it to
//! the contact and friction forces; the relief of the same noise then does not push a second time.

use super::{ForceDirection, SolidNoise, SolidNoiseParameters};
use crate::force_output::ForceAt;
use crate::height_field::{MAX_BLOCK, NO_TOUCH_N, PathBlock, SurfaceBlock};

impl SolidNoise {
    /// Force of the texture and the medium on a tool at `position_m`: along u, v and out of the
    /// surface, newtons; none for a tool that does not press. `footprint_m` is the distance between
    /// two readings.
    #[must_use]
    pub fn force_n(
        &self,
        position_m: [f64; 2],
        velocity_m_s: [f64; 2],
        normal_force_n: f64,
        footprint_m: f64,
        sample: u64,
    ) -> [f64; 3] {
        let mut force = [0.0; 3];
        for (weight, parameters) in self.parameters.weights(sample).iter().zip(self.parameters.values()) {
            if *weight != 0.0 {
                let texture = self.texture_at(parameters, position_m, footprint_m, sample);
                let one = parameters.force_n(texture, velocity_m_s, normal_force_n);
                for (sum, one) in force.iter_mut().zip(one) {
                    *sum += weight * one;
                }
            }
        }
        force
    }

    /// n_p(T x) as far as a footprint resolves it, in units of magnitude.
    fn texture_at(
        &self,
        parameters: &SolidNoiseParameters,
        position_m: [f64; 2],
        footprint_m: f64,
        sample: u64,
    ) -> f64 {
        let flown_m = self.flown_m(parameters, sample);
        let point = self.cut.at(position_m);
        let point: [f64; 3] = core::array::from_fn(|a| point[a] - flown_m[a]);
        let mut texture = 0.0;
        for (module, lattices) in parameters.modules.iter().zip(&self.lattices) {
            for (index, lattice) in lattices.iter().enumerate().take(module.octaves) {
                let (per_m, amplitude) = parameters.octave(module, index);
                let whole = super::resolved(footprint_m * per_m);
                let mean = module.kind.mean();
                texture += amplitude * (1.0 - whole) * mean;
                if amplitude * whole != 0.0 {
                    let noise = module.kind.at(lattice, point.map(|x| x * per_m));
                    texture += amplitude * whole * f64::from(noise.value);
                }
            }
        }
        texture
    }

    /// Answers along a path: the law in the place of the relief's own push.
    pub(super) fn answer(
        parameters: &SolidNoiseParameters,
        path: &PathBlock<'_>,
        weight: &[f64; MAX_BLOCK],
        texture: &[f64; MAX_BLOCK],
        out: &mut SurfaceBlock,
    ) {
        for (i, velocity_m_s) in path.velocity_m_s.iter().enumerate().take(MAX_BLOCK) {
            let force_n = parameters.force_n(texture[i], *velocity_m_s, path.pressed_n(i));
            let push_per_n = [0.0; 2];
            out.answer.add(i, &ForceAt { force_n, push_per_n, cap_n: f64::INFINITY }, weight[i]);
        }
    }
}

impl SolidNoiseParameters {
    /// The law for n_p = `texture`, in units of magnitude.
    #[must_use]
    pub fn force_n(&self, texture: f64, velocity_m_s: [f64; 2], normal_force_n: f64) -> [f64; 3] {
        if normal_force_n <= NO_TOUCH_N {
            return [0.0; 3];
        }
        let proportion = if self.proportional_to_contact { normal_force_n } else { 1.0 };
        let texture = (self.limit_n * texture * proportion).clamp(-self.cap_n, self.cap_n);
        let speed = libm::hypot(velocity_m_s[0], velocity_m_s[1]);
        let direction = match self.direction {
            ForceDirection::X => [1.0, 0.0, 0.0],
            ForceDirection::Normal => [0.0, 0.0, 1.0],
            ForceDirection::Tangent if speed > 0.0 => [velocity_m_s[0] / speed, velocity_m_s[1] / speed, 0.0],
            ForceDirection::Tangent => [0.0; 3],
        };
        let drag = self.viscosity_n_s_m;
        [
            texture * direction[0] - drag * velocity_m_s[0],
            texture * direction[1] - drag * velocity_m_s[1],
            texture * direction[2],
        ]
    }
}
