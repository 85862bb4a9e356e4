//! A view into every contact while it is rendered: traces, force output, tests.
//!
//! A tap runs on the audio half. One that is used live must not allocate, lock or wait.

use crate::model::event::{Actuator, ContactId};
use asperity_dsp::micro_contact::ContactSample as PadSample;

/// One contact during up to [`MAX_BLOCK`](asperity_texture::height_field::MAX_BLOCK) consecutive
/// samples; all slices are equally long and describe the same instants.
#[derive(Debug, Clone, Copy)]
pub struct ContactBlock<'a> {
    /// Absolute index of the first sample.
    pub first_sample: u64,
    /// The contact.
    pub contact: ContactId,
    /// Who feels it; none = it is heard only.
    pub actuator: Option<Actuator>,
    /// Smoothed path on the surface, metres.
    pub position_m: &'a [[f64; 2]],
    /// Texture coordinates of the path.
    pub uv: &'a [[f64; 2]],
    /// Tangential velocity, m/s.
    pub velocity_m_s: &'a [[f64; 2]],
    /// The micro-contact model, sample by sample.
    pub contact_samples: &'a [PadSample],
    /// Momentum sent to the body at each sample, N·s.
    pub impulse_n_s: &'a [f64],
    /// 3-D force on the finger, N: along u, v and out of the surface.
    pub force_n: &'a [[f64; 3]],
    /// Largest force of the device behind the surface, N; infinite where none is given. `force_n`
    /// keeps to it, and what is made of it has to.
    pub cap_n: &'a [f64],
}

/// Receives what contacts do.
///
/// ```
/// use asperity::{ContactBlock, Tap};
///
/// /// The hardest press so far.
/// struct Hardest(f64);
///
/// impl Tap for Hardest {
///     fn contact(&mut self, block: &ContactBlock<'_>) {
///         self.0 = block.force_n.iter().fold(self.0, |most, [_, _, out]| most.max(*out));
///     }
/// }
/// ```
pub trait Tap {
    /// Tests whether blocks are to be shown at all; a tap that says no costs nothing.
    fn is_watching(&self) -> bool {
        true
    }

    /// Tests whether samples are shown at the rate inside
    /// ([`Config::inner_rate_hz`](crate::Config::inner_rate_hz)), and not only those that leave;
    /// [`ContactBlock::first_sample`] then counts inner samples. While a port watches too, it gets
    /// what it expects and this is no.
    fn wants_inner_samples(&self) -> bool {
        false
    }

    /// Called once for each contact and stretch of samples, in order of time.
    fn contact(&mut self, block: &ContactBlock<'_>);

    /// Asked by an offline render before each block, with the samples done and the samples wanted:
    /// `false` stops it. Nobody asks live.
    fn goes_on(&mut self, _done: u64, _of: u64) -> bool {
        true
    }
}

/// Looks at nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoTap;

impl Tap for NoTap {
    fn is_watching(&self) -> bool {
        false
    }

    #[inline]
    fn contact(&mut self, _block: &ContactBlock<'_>) {}
}
