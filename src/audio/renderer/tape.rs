//! Pitch that bends with time: everything is rendered in the game's time, and read from a tape that
//! runs slower or faster.
//!
//! ```text
//! out(n) = Σₖ c h(c (p(n) − k)) x(k)      p(n + 1) = p(n) + scale      c = min(1, 1/scale)
//! ```
//! h is a sinc of [`LOBES`] zero crossings to either side under a Kaiser window, its pass band that
//! of the slower of the two sides: nothing folds back. At rest the tape costs a copy of the last
//! samples of each block; while it runs, events lag by the reach of the kernel, [`LOBES`] samples
//! over scale at most. Back at scale 1, p glides onto a whole sample within [`GLIDE`] samples, what
//! lies ahead is played out, and the tape stands still again.

use crate::resource::sinc::{self, LOBES};

/// Largest scale.
pub(crate) const FASTEST: f64 = 2.0;
/// Reach of the kernel at the largest scale, samples.
const REACH: usize = LOBES * FASTEST as usize;
/// Samples of a channel that are kept.
const KEPT: usize = 128;
/// Samples in which the position becomes whole again.
const GLIDE: f64 = 512.0;

/// Samples of every channel, and the place from which they are read.
pub(crate) struct Tape {
    /// Haptic channels, then buses, then pickups.
    channels: Box<[[f32; KEPT]]>,
    /// Samples written so far.
    written: u64,
    /// Place of the next sample that leaves: whole, and beyond it.
    whole: u64,
    beyond: f64,
    scale: f64,
    /// Step while the position becomes whole again.
    glide: Option<f64>,
    runs: bool,
    weights: [f32; 2 * REACH],
}

impl Tape {
    pub(crate) fn new(channels: usize, written: u64) -> Self {
        sinc::prepare();
        Self {
            channels: vec![[0.0; KEPT]; channels].into(),
            written,
            whole: written,
            beyond: 0.0,
            scale: 1.0,
            glide: None,
            runs: false,
            weights: [0.0; 2 * REACH],
        }
    }

    /// Tests whether what is rendered leaves through the tape.
    pub(crate) fn runs(&self) -> bool {
        self.runs
    }

    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Runs at another speed from the next sample that leaves.
    pub(crate) fn set_scale(&mut self, scale: f64) {
        self.glide = None;
        self.runs |= scale != 1.0;
        self.scale = scale;
    }

    /// Writes what was rendered, `n` samples a channel from `at` on; they have left already where
    /// the tape did not run.
    pub(crate) fn write(
        &mut self,
        (at, n): (usize, usize),
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
        split: [usize; 2],
        ran: bool,
    ) {
        let skipped = n.saturating_sub(KEPT);
        for (index, channel) in self.channels.iter_mut().enumerate() {
            let Some(from) = output(index, split, haptic, audio, pickups) else { continue };
            for (i, x) in from[at + skipped..at + n].iter().enumerate() {
                channel[(self.written as usize + skipped + i) % KEPT] = *x;
            }
        }
        self.written += n as u64;
        if !ran {
            self.whole = self.written;
        }
    }

    /// Samples that have to be written before the next one leaves.
    pub(crate) fn missing(&self) -> usize {
        (self.whole + self.reach() + 1).saturating_sub(self.written) as usize
    }

    /// Most samples that are written while `frames` leave.
    pub(crate) fn most_written(&self, frames: usize) -> usize {
        if !self.runs {
            return frames;
        }
        let last = self.whole as f64 + self.beyond + self.scale.max(1.0) * frames as f64 + 2.0;
        (last as u64 + self.reach()).saturating_sub(self.written) as usize
    }

    fn reach(&self) -> u64 {
        let plays_out = self.scale == 1.0 && self.beyond == 0.0;
        if plays_out { 0 } else { (LOBES as f64 * self.scale.max(1.0)).ceil() as u64 }
    }

    /// The next sample that leaves, of every channel, at `at`.
    pub(crate) fn read(
        &mut self,
        at: usize,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
        split: [usize; 2],
    ) {
        let reach = self.reach() as usize;
        let cutoff = 1.0 / self.scale.max(1.0);
        for (i, weight) in self.weights[..2 * reach].iter_mut().enumerate() {
            let distance = (i as f64 + 1.0 - reach as f64 - self.beyond).abs() * cutoff;
            *weight = cutoff as f32 * sinc::kernel(distance);
        }
        let first = (self.whole + 1).wrapping_sub(reach as u64) as usize;
        for (index, channel) in self.channels.iter().enumerate() {
            let sample = if reach == 0 {
                channel[self.whole as usize % KEPT]
            } else {
                let taps = self.weights[..2 * reach].iter().enumerate();
                taps.map(|(i, weight)| weight * channel[first.wrapping_add(i) % KEPT]).sum()
            };
            output(index, split, haptic, audio, pickups).into_iter().for_each(|out| out[at] = sample);
        }
        self.go_on();
    }

    fn go_on(&mut self) {
        let mut step = self.scale;
        if self.scale == 1.0 && self.beyond > 0.0 {
            step += *self.glide.get_or_insert((1.0 - self.beyond) / GLIDE);
        }
        let next = self.beyond + step;
        self.whole += next as u64;
        self.beyond = next.fract();
        if self.glide.is_some() && !(1e-9..1.0 - 1e-9).contains(&self.beyond) {
            self.whole += u64::from(self.beyond > 0.5);
            (self.beyond, self.glide) = (0.0, None);
        }
        self.runs = self.scale != 1.0 || self.beyond > 0.0 || self.whole < self.written;
    }
}

/// The output of a channel of the tape; buses begin at the first of `split`, pickups at the second.
fn output<'a>(
    index: usize,
    split: [usize; 2],
    haptic: &'a mut [&mut [f32]],
    audio: &'a mut [&mut [f32]],
    pickups: &'a mut [&mut [f32]],
) -> Option<&'a mut [f32]> {
    match index {
        i if i < split[0] => haptic.get_mut(i).map(|out| &mut **out),
        i if i < split[1] => audio.get_mut(i - split[0]).map(|out| &mut **out),
        i => pickups.get_mut(i - split[1]).map(|out| &mut **out),
    }
}
