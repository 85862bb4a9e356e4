//! A view into every contact while it is rendered: traces, force output, tests.
//!
//! A tap runs on the audio half. One that is used live must not allocate, lock or wait.

use crate::model::event::{ChannelId, ContactId};
use asperity_dsp::micro_contact::ContactSample as PadSample;
use asperity_surface::height_field::MAX_BLOCK;

/// One contact during up to [`MAX_BLOCK`](asperity_surface::height_field::MAX_BLOCK) consecutive
/// samples; all slices are equally long and describe the same instants.
#[derive(Debug, Clone, Copy)]
pub struct ContactBlock<'a> {
    /// Absolute index of the first sample.
    pub first_sample: u64,
    /// The contact.
    pub contact: ContactId,
    /// Who feels it; none = it is heard only.
    pub actuator: Option<ChannelId>,
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

impl ContactBlock<'_> {
    /// Columns of a trace at each sample: u, v, height_m, normal_force_n, pad_m, pad_velocity_m_s,
    /// finger_m, contact_force_n, impulse_n_s.
    pub fn trace(&self) -> impl Iterator<Item = [f64; 9]> {
        let rows = self.uv.iter().zip(self.contact_samples).zip(self.impulse_n_s);
        rows.map(|(([u, v], row), impulse_n_s)| {
            let PadSample { height_m, normal_force_n, pad_m, pad_velocity_m_s, .. } = *row;
            let PadSample { finger_m, contact_force_n, .. } = *row;
            [
                *u,
                *v,
                height_m,
                normal_force_n,
                pad_m,
                pad_velocity_m_s,
                finger_m,
                contact_force_n,
                *impulse_n_s,
            ]
        })
    }
}

/// Memory of a [`ContactBlock`].
pub(crate) struct ContactRows {
    pub(crate) position_m: [[f64; 2]; MAX_BLOCK],
    pub(crate) uv: [[f64; 2]; MAX_BLOCK],
    pub(crate) velocity_m_s: [[f64; 2]; MAX_BLOCK],
    pub(crate) contact_samples: [PadSample; MAX_BLOCK],
    pub(crate) impulse_n_s: [f64; MAX_BLOCK],
    pub(crate) force_n: [[f64; 3]; MAX_BLOCK],
    pub(crate) cap_n: [f64; MAX_BLOCK],
}

impl ContactRows {
    pub(crate) fn new() -> Self {
        Self {
            position_m: [[0.0; 2]; MAX_BLOCK],
            uv: [[0.0; 2]; MAX_BLOCK],
            velocity_m_s: [[0.0; 2]; MAX_BLOCK],
            contact_samples: [PadSample::default(); MAX_BLOCK],
            impulse_n_s: [0.0; MAX_BLOCK],
            force_n: [[0.0; 3]; MAX_BLOCK],
            cap_n: [0.0; MAX_BLOCK],
        }
    }

    /// The first `count` rows, of which the first is that of sample `first_sample`.
    pub(crate) fn block(
        &self,
        contact: ContactId,
        actuator: Option<ChannelId>,
        first_sample: u64,
        count: usize,
    ) -> ContactBlock<'_> {
        ContactBlock {
            first_sample,
            contact,
            actuator,
            position_m: &self.position_m[..count],
            uv: &self.uv[..count],
            velocity_m_s: &self.velocity_m_s[..count],
            contact_samples: &self.contact_samples[..count],
            impulse_n_s: &self.impulse_n_s[..count],
            force_n: &self.force_n[..count],
            cap_n: &self.cap_n[..count],
        }
    }
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
