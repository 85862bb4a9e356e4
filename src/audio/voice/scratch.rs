//! The work space of a stretch, at rest.

use super::{PadSample, Scratch, VoiceBlock};
use asperity_dsp::hertz::FORCE_HISTORY;
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, SurfaceBlock};

impl Scratch {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self {
            points: [PathPoint::default(); MAX_BLOCK],
            position_m: [[0.0; 2]; MAX_BLOCK],
            at_m: [[0.0; 3]; MAX_BLOCK],
            velocity_m_s: [[0.0; 2]; MAX_BLOCK],
            footprint_m: [0.0; MAX_BLOCK],
            noise_footprint_m: [0.0; MAX_BLOCK],
            force_n: [0.0; MAX_BLOCK],
            uv: [[0.0; 2]; MAX_BLOCK],
            force_impulse_n_s: [0.0; FORCE_HISTORY + MAX_BLOCK],
            surface: SurfaceBlock::default(),
            rough: SurfaceBlock::default(),
            pad: [PadSample::default(); MAX_BLOCK],
            shown: [PadSample::default(); MAX_BLOCK],
            shown_n_s: [0.0; MAX_BLOCK],
            output_force_n: [[0.0; 3]; MAX_BLOCK],
            out: VoiceBlock {
                haptic: [0.0; MAX_BLOCK],
                impulse_n_s: [0.0; MAX_BLOCK],
                excites: false,
                collisions: 0,
                shortened: 0,
                resets: 0,
            },
        })
    }
}
