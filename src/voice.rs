//! One contact: the signal path of the paper on one screen (Hasti, Fig. 2).
//!
//! path → profile → micro-contact → { pad displacement → actuator, impulses → body }

use crate::event::{ContactId, ContactSample};
use crate::seat::{Noise, Seat};
use crate::surface::{Excitation, SurfaceSlot};
use crate::tap::{ContactBlock, Tap};
use asperity_dsp::actuator::{ContactOutput, ContactOutputState, Quantity};
use asperity_dsp::butterworth;
use asperity_dsp::fractal_noise::FractalNoise;
use asperity_dsp::hertz::{self, FORCE_HISTORY, HertzPulse, OnsetMerge};
use asperity_dsp::micro_contact::{ContactSample as PadSample, ContactState, MicroContact, Onset};
use asperity_dsp::rng::Rng;
use asperity_dsp::trajectory::{Moved, PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use asperity_texture::height_field::{MAX_BLOCK, PathBlock, Reaction, SurfaceBlock, Touch};

/// Samples of impulse a contact can hold ahead.
const BUS_SAMPLES: usize = 2048;
/// What rounding leaves of a pad that does not move, m or m/s².
const ROUNDING: f64 = 1e-13;
/// What rounding leaves of a force that does not change, N.
const ROUNDING_N: f64 = 1e-11;
/// High-passed pad displacement that counts as still, m: −160 dB of 0.1 mm.
const STILL_M: f64 = 1e-12;
/// Pad acceleration that counts as still, m/s²: −120 dB of what a fingertip just feels.
const STILL_M_S2: f64 = 1e-6;
/// Impulse per sample below which a contact counts as silent, N·s: −120 dB of an ordinary stroke's.
const STILL_N_S: f64 = 1e-12;
/// Below this speed friction no longer jumps, m/s.
const STICK_M_S: f64 = 1e-3;

/// Landings within this distance of the lift-off can be the same touch, m: the width of a fingertip
/// (chosen; a finger at 0.5 m/s moves 8 mm between two reports at 60 Hz).
const SAME_TOUCH_M: f64 = 0.01;

/// Where a voice is before it is anybody's.
const IDLE: PathEvent =
    PathEvent { sample: 0, position_m: [0.0; 2], velocity_m_s: None, normal_force_n: 0.0 };

/// What every voice needs and none owns.
pub(crate) struct Shared {
    pub(crate) idle_path: TrajectoryDesign,
    pub(crate) idle_output: ContactOutput,
    pub(crate) sample_rate_hz: f64,
    pub(crate) micro_contact: MicroContact,
    pub(crate) noise: FractalNoise,
    /// Momentum of a micro-collision per closing speed, kg: pad mass × (1 + restitution).
    pub(crate) collision_mass_kg: f64,
    /// Octaves of noise left out because blocks run late.
    pub(crate) noise_octaves_gone: u32,
    /// The rise of a fade, 0 to 1.
    pub(crate) fade: Box<[f64]>,
}

impl Shared {
    fn fade_samples(&self) -> u32 {
        self.fade.len().saturating_sub(1) as u32
    }
}

/// Where the sound and feel of a voice stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Nobody's.
    Free,
    /// Touching.
    Sounding,
    /// Going silent within `left` samples.
    Fading { left: u32 },
}

/// One contact.
pub(crate) struct Voice {
    pub(crate) contact: ContactId,
    pub(crate) surface: usize,
    pub(crate) actuator: usize,
    pub(crate) phase: Phase,
    pub(crate) begun: u64,
    pub(crate) refreshed: u64,
    /// Whether it fades because the game said so, and not because it lapsed or was stolen.
    pub(crate) ended: bool,
    slot: usize,
    asleep: bool,
    fade_in_left: u32,
    /// Coming back out of a fade.
    rising: Option<Rising>,
    /// Gain of the last sample.
    gain: f64,
    trajectory: Trajectory,
    last_point: PathPoint,
    last_row: PadSample,
    last_felt: f64,
    pad: ContactState,
    resets_told: u32,
    merge: OnsetMerge,
    feel: ContactOutputState,
    force_high_pass: butterworth::State,
    reaction: Reaction,
    grains: Rng,
    /// The impulses of the last forces, which are still on their way to the body.
    force_history_n_s: [f64; FORCE_HISTORY],
    bus: Vec<f64>,
    bus_busy_until: u64,
}

/// A fade that turns round: its phase (0 = silent, 1 = full) slows down, stops and comes back, so that
/// the gain has no corner.
struct Rising {
    phase: f64,
    /// Per sample.
    speed: f64,
}

/// Share of a fade's length that its turning takes.
const TURN: f64 = 0.2;

impl Rising {
    /// The next gain.
    fn tick(&mut self, fade_samples: u32) -> f64 {
        let top = 1.0 / f64::from(fade_samples);
        self.speed = (self.speed + 2.0 * top * top / TURN).min(top);
        self.phase = (self.phase + self.speed).clamp(0.0, 1.0);
        0.5 - 0.5 * (std::f64::consts::PI * self.phase).cos()
    }
}

/// What one voice adds to a stretch of samples.
pub(crate) struct VoiceBlock {
    /// m or m/s², as the actuator plays it.
    pub(crate) haptic: [f64; MAX_BLOCK],
    pub(crate) impulse_n_s: [f64; MAX_BLOCK],
    /// Whether `impulse_n_s` is more than zeros.
    pub(crate) excites: bool,
    pub(crate) collisions: u64,
    pub(crate) resets: u64,
}

impl VoiceBlock {
    fn scale(&mut self, i: usize, gain: f64) {
        self.haptic[i] *= gain;
        self.impulse_n_s[i] *= gain;
    }
}

/// Work space of one stretch; reused by every voice.
pub(crate) struct Scratch {
    points: [PathPoint; MAX_BLOCK],
    position_m: [[f64; 2]; MAX_BLOCK],
    velocity_m_s: [[f64; 2]; MAX_BLOCK],
    footprint_m: [f64; MAX_BLOCK],
    noise_footprint_m: [f64; MAX_BLOCK],
    force_n: [f64; MAX_BLOCK],
    uv: [[f64; 2]; MAX_BLOCK],
    /// The contact's history, then one value a sample.
    force_impulse_n_s: [f64; FORCE_HISTORY + MAX_BLOCK],
    surface: SurfaceBlock,
    rough: SurfaceBlock,
    pad: [PadSample; MAX_BLOCK],
    output_force_n: [[f64; 3]; MAX_BLOCK],
    pub(crate) out: VoiceBlock,
}

impl Voice {
    /// A voice that nobody uses; `slot` is its place in the renderer. Allocates its bus.
    pub(crate) fn free(slot: usize, shared: &Shared) -> Self {
        Self {
            contact: ContactId(0),
            surface: 0,
            actuator: 0,
            phase: Phase::Free,
            begun: 0,
            refreshed: 0,
            ended: false,
            slot,
            asleep: false,
            fade_in_left: 0,
            rising: None,
            gain: 0.0,
            trajectory: Trajectory::begin(&shared.idle_path, &IDLE),
            last_point: PathPoint::default(),
            last_row: PadSample::default(),
            last_felt: 0.0,
            pad: shared.micro_contact.at_rest(0.0, 0.0),
            resets_told: 0,
            merge: OnsetMerge::default(),
            feel: ContactOutputState::begin(&shared.idle_output, 0.0, 0.0),
            force_high_pass: butterworth::State::default(),
            reaction: Reaction::default(),
            grains: Rng::new(slot as u64),
            force_history_n_s: [0.0; FORCE_HISTORY],
            bus: vec![0.0; BUS_SAMPLES],
            bus_busy_until: 0,
        }
    }

    /// Lands on a surface: at rest on it when the closing speed is zero, otherwise with that speed.
    #[expect(clippy::too_many_arguments, reason = "what is borrowed apart cannot be handed over together")]
    pub(crate) fn begin(
        &mut self,
        contact: ContactId,
        sample: &ContactSample,
        seat: &mut Seat,
        output: &ContactOutput,
        shared: &Shared,
        position: u64,
        scratch: &mut Scratch,
    ) {
        let Some(slot) = seat.current() else { return };
        let event = path_event(sample, slot, position);
        self.contact = contact;
        self.phase = Phase::Sounding;
        (self.begun, self.refreshed) = (position, position);
        self.asleep = false;
        self.ended = false;
        self.rising = None;
        self.fade_in_left = if sample.closing_m_s > 0.0 { 0 } else { shared.fade_samples() };
        self.trajectory = Trajectory::begin(&slot.trajectory, &event);
        // The path may begin behind the event, by the filter's delay.
        let mut path = self.trajectory;
        path.advance(&slot.trajectory, &mut scratch.points[..1]);
        self.last_point = scratch.points[0];
        let force_n = event.normal_force_n;
        let lands = sample.closing_m_s > 0.0;
        if lands {
            self.profile(seat, shared, position, 1, scratch);
            let height_m = scratch.surface.height_m[0];
            self.pad = shared.micro_contact.landing(height_m, force_n, sample.closing_m_s);
            self.feel = ContactOutputState::begin(output, height_m, -sample.closing_m_s);
        } else {
            self.lead_in(seat, output, shared, position, scratch);
        }
        self.resets_told = self.pad.resets();
        // The high-pass starts settled, so that beginning gives no step.
        let pressed_n = if lands { 0.0 } else { force_n };
        self.force_high_pass = butterworth::State::settled_at(pressed_n);
        self.merge = OnsetMerge::default();
        self.reaction = Reaction::default();
        self.grains = Rng::new(contact.0 ^ position.rotate_left(32));
        self.force_history_n_s = [0.0; FORCE_HISTORY];
        if self.bus_busy_until > position {
            self.bus.fill(0.0);
        }
        self.bus_busy_until = 0;
    }

    /// A finger that is suddenly there has been sliding already: the pad is led along the straight line
    /// to where it appears, so that it moves with the surface from its first sample.
    fn lead_in(
        &mut self,
        seat: &mut Seat,
        output: &ContactOutput,
        shared: &Shared,
        position: u64,
        scratch: &mut Scratch,
    ) {
        let PathPoint { position_m: end_m, velocity_m_s, normal_force_n } = self.last_point;
        for (i, point) in scratch.points.iter_mut().enumerate() {
            let before_s = (MAX_BLOCK - i) as f64 / shared.sample_rate_hz;
            let position_m = [0, 1].map(|axis| end_m[axis] - velocity_m_s[axis] * before_s);
            *point = PathPoint { position_m, velocity_m_s, normal_force_n };
        }
        self.profile(seat, shared, position, MAX_BLOCK, scratch);
        let (heights_m, forces_n) = (&scratch.surface.height_m, &scratch.force_n);
        self.pad = shared.micro_contact.at_rest(heights_m[0], forces_n[0]);
        shared.micro_contact.run(&mut self.pad, heights_m, forces_n, &mut scratch.pad);
        let last = &scratch.pad[MAX_BLOCK - 1];
        self.feel = ContactOutputState::begin(output, last.pad_m, last.pad_velocity_m_s);
    }

    /// Goes on somewhere else; wakes a resting contact.
    ///
    /// `stamp` is the sample the event holds at, which may lie before `position` when it arrives late:
    /// the path reckons on from the stamp, so jitter of arrival does not become jitter of motion.
    pub(crate) fn moved(&mut self, sample: &ContactSample, slot: &SurfaceSlot, stamp: u64, position: u64) {
        self.refreshed = position;
        self.asleep = false;
        let event = path_event(sample, slot, stamp);
        // A teleport is followed at once by the path itself; an event older than the last is dropped.
        let _: Moved = self.trajectory.moved(&slot.trajectory, &event);
    }

    /// Something changed under a resting contact.
    pub(crate) fn wake(&mut self) {
        self.asleep = false;
    }

    /// Starts to fade, if it has not yet.
    pub(crate) fn fade(&mut self, shared: &Shared) {
        if self.phase == Phase::Sounding {
            self.phase = Phase::Fading { left: shared.fade_samples() };
        }
    }

    /// Whether a landing is so close that it can be the same touch.
    pub(crate) fn is_near(&self, sample: &ContactSample, slot: &SurfaceSlot) -> bool {
        let event = path_event(sample, slot, 0);
        let period_m = slot.surface.wrap_period_m();
        let apart_m = (0..2).map(|axis| {
            let apart_m = event.position_m[axis] - self.last_point.position_m[axis];
            let turns = if period_m[axis].is_finite() { (apart_m / period_m[axis]).round() } else { 0.0 };
            apart_m - if turns == 0.0 { 0.0 } else { turns * period_m[axis] }
        });
        apart_m.map(|apart_m| apart_m * apart_m).sum::<f64>() <= SAME_TOUCH_M * SAME_TOUCH_M
    }

    /// Comes back out of its fade, from the level it has faded to and without a corner.
    pub(crate) fn resume(&mut self, shared: &Shared) {
        let step = 1.0 / f64::from(shared.fade_samples());
        let faded = matches!(self.phase, Phase::Fading { left } if left < shared.fade_samples());
        let phase = (1.0 - 2.0 * self.gain).clamp(-1.0, 1.0).acos() / std::f64::consts::PI;
        // Before the first faded sample nothing has happened yet.
        self.rising = faded.then_some(Rising { phase, speed: -step });
        if faded {
            self.fade_in_left = 0;
        }
        self.phase = Phase::Sounding;
        self.ended = false;
    }

    /// How much would be missed: what presses harder and moves faster is heard and felt more.
    pub(crate) fn priority(&self) -> f64 {
        let [u, v] = self.last_point.velocity_m_s;
        let speed_m_s = (u * u + v * v).sqrt();
        match self.phase {
            Phase::Free | Phase::Fading { .. } => -1.0,
            Phase::Sounding => self.last_point.normal_force_n * (1e-3 + speed_m_s),
        }
    }

    /// Renders the next `n` samples into `scratch.out`. The stretch lies within one cell of the
    /// absolute sample grid of [`MAX_BLOCK`].
    #[expect(clippy::too_many_arguments, reason = "what is borrowed apart cannot be handed over together")]
    pub(crate) fn render<T: Tap>(
        &mut self,
        seat: &mut Seat,
        shared: &Shared,
        output: &ContactOutput,
        position: u64,
        n: usize,
        scratch: &mut Scratch,
        tap: &mut T,
    ) {
        let at_grid = position.is_multiple_of(MAX_BLOCK as u64);
        let wanted = n;
        // Nothing is computed, counted or shown after a fade, wherever the stretch ends.
        let n = match self.phase {
            Phase::Fading { left } => n.min(left as usize),
            Phase::Free | Phase::Sounding => n,
        };
        scratch.out.haptic[n..wanted].fill(0.0);
        scratch.out.impulse_n_s[n..wanted].fill(0.0);
        if self.asleep {
            self.rest(n, scratch);
        } else {
            self.follow_path(seat, n, scratch);
            // First the touch, then the heights: a surface that gives way answers within the same grid
            // cell wherever it is cut into stretches.
            if at_grid {
                self.press(seat, position);
            }
            self.profile(seat, shared, position, n, scratch);
            self.touch(shared, n, scratch);
            self.filter(seat, shared, output, n, scratch);
            self.excite(seat, shared, position, n, scratch);
        }
        self.apply_fades(shared, n, scratch);
        self.show(seat, shared, position, n, scratch, tap);
        if self.phase == Phase::Free {
            return;
        }
        self.last_point = scratch.points[n - 1];
        if (position + n as u64).is_multiple_of(MAX_BLOCK as u64) {
            self.fall_asleep_when_still(output, shared, position, n, scratch);
        }
    }

    fn follow_path(&mut self, seat: &Seat, n: usize, scratch: &mut Scratch) {
        if let Some(slot) = seat.current() {
            self.trajectory.advance(&slot.trajectory, &mut scratch.points[..n]);
        }
    }

    /// Heights along the path: the source, and the paper's micro-noise below the source's own band.
    fn profile(&self, seat: &mut Seat, shared: &Shared, position: u64, n: usize, scratch: &mut Scratch) {
        let step_s = 1.0 / shared.sample_rate_hz;
        let widened = f64::from(1u32 << shared.noise_octaves_gone);
        for (i, point) in scratch.points[..n].iter().enumerate() {
            let [u, v] = point.velocity_m_s;
            scratch.position_m[i] = point.position_m;
            scratch.velocity_m_s[i] = point.velocity_m_s;
            scratch.footprint_m[i] = (u * u + v * v).sqrt() * step_s;
            // A footprint twice as wide hides the finest octave that is left.
            scratch.noise_footprint_m[i] = scratch.footprint_m[i] * widened;
            scratch.force_n[i] = point.normal_force_n;
        }
        let path = PathBlock {
            position_m: &scratch.position_m[..n],
            velocity_m_s: &scratch.velocity_m_s[..n],
            footprint_m: &scratch.footprint_m[..n],
            first_sample: position,
            contact: self.slot,
        };
        let noise = Noise { field: &shared.noise, footprint_m: &scratch.noise_footprint_m[..n] };
        seat.sample(&path, &noise, &mut scratch.surface, &mut scratch.rough);
        // A surface that gives way lies lower by as much as the force presses it in.
        let surface = &mut scratch.surface;
        let give = surface.compliance_m_n[..n].iter().zip(&scratch.force_n);
        for (height_m, (compliance_m_n, force_n)) in surface.height_m.iter_mut().zip(give) {
            *height_m -= compliance_m_n * force_n;
        }
    }

    /// Tells the source how it is touched, and hears what it does back.
    fn press(&mut self, seat: &mut Seat, position: u64) {
        let touch = Touch {
            contact: self.slot,
            sample: position,
            position_m: self.last_point.position_m,
            velocity_m_s: self.last_point.velocity_m_s,
            normal_force_n: self.last_point.normal_force_n,
        };
        self.reaction = seat.react(&touch);
    }

    fn touch(&mut self, shared: &Shared, n: usize, scratch: &mut Scratch) {
        shared.micro_contact.run(
            &mut self.pad,
            &scratch.surface.height_m[..n],
            &scratch.force_n[..n],
            &mut scratch.pad[..n],
        );
        let resets = self.pad.resets();
        scratch.out.resets = u64::from(resets.wrapping_sub(self.resets_told));
        self.resets_told = resets;
    }

    /// The two high-passes of a contact side by side, because each waits for itself most of the time: the
    /// pad's displacement or acceleration about the mean surface, which the actuator is to reproduce, and
    /// the alternating contact force, which sounds.
    fn filter(
        &mut self,
        seat: &Seat,
        shared: &Shared,
        output: &ContactOutput,
        n: usize,
        scratch: &mut Scratch,
    ) {
        let Some(slot) = seat.current() else { return };
        let high_pass = slot.force_high_pass;
        // A force that is not to sound counts as 0 N.
        let sounds = slot.surface.excitation != Excitation::Collisions;
        let step_s = if sounds { 1.0 / shared.sample_rate_hz } else { 0.0 };
        let (mut force, mut feel) = (self.force_high_pass, self.feel);
        let rows = scratch.pad[..n].iter();
        let outputs = scratch.force_impulse_n_s[FORCE_HISTORY..].iter_mut().zip(&mut scratch.out.haptic);
        for (row, (impulse_n_s, out)) in rows.zip(outputs) {
            let alternating_n = force.tick(&high_pass, row.contact_force_n).high;
            *impulse_n_s = if alternating_n.abs() < ROUNDING_N { 0.0 } else { alternating_n * step_s };
            let felt = feel.tick(output, row.pad_m, row.pad_velocity_m_s);
            *out = if felt.abs() < ROUNDING { 0.0 } else { felt };
        }
        (self.force_high_pass, self.feel) = (force, feel);
        self.last_felt = scratch.out.haptic[n - 1];
    }

    /// What the contact sends to the body: a Hertz pulse for each micro-collision and each grain, and
    /// the alternating contact force. Pulses and force meet sample by sample, not in the bus, so that
    /// the order of additions depends on no split into blocks.
    fn excite(&mut self, seat: &Seat, shared: &Shared, position: u64, n: usize, scratch: &mut Scratch) {
        let Some(slot) = seat.current() else { return };
        let excitation = slot.surface.excitation;
        let rate = shared.sample_rate_hz;
        scratch.out.collisions = 0;
        let grains = self.reaction.grain_rate_per_s > 0.0;
        for i in 0..n {
            let sample = position + i as u64;
            if let Some(onset) = scratch.pad[i].onset {
                scratch.out.collisions += 1;
                if excitation != Excitation::Force {
                    // An onset is dated within the step that ends at its row.
                    self.collide(slot, shared, &onset, sample.saturating_sub(1));
                }
            }
            if grains {
                self.shift_grain(slot, sample, rate);
            }
        }
        self.empty_bus(position, &mut scratch.out.impulse_n_s[..n]);
        let forces_n_s = &mut scratch.force_impulse_n_s;
        forces_n_s[..FORCE_HISTORY].copy_from_slice(&self.force_history_n_s);
        hertz::spread_force(&forces_n_s[..FORCE_HISTORY + n], &mut scratch.out.impulse_n_s[..n]);
        self.force_history_n_s.copy_from_slice(&forces_n_s[n..n + FORCE_HISTORY]);
        scratch.out.excites = true;
    }

    /// Takes the pulses of the coming samples off the bus, which is empty beyond the last pulse.
    fn empty_bus(&mut self, position: u64, out: &mut [f64]) {
        if self.bus_busy_until <= position {
            return out.fill(0.0);
        }
        let mask = self.bus.len() - 1;
        for (i, y) in out.iter_mut().enumerate() {
            *y = std::mem::take(&mut self.bus[(position as usize).wrapping_add(i) & mask]);
        }
    }

    fn collide(&mut self, slot: &SurfaceSlot, shared: &Shared, onset: &Onset, sample: u64) {
        let pulse = HertzPulse {
            impulse_n_s: shared.collision_mass_kg * onset.closing_m_s,
            contact_time_s: slot.hertz.contact_time_s(onset.closing_m_s),
        };
        let rate = shared.sample_rate_hz;
        if let Some(pulse) = self.merge.admit(pulse, sample, onset.offset, rate) {
            self.deposit(&pulse, sample, onset.offset, rate);
        }
    }

    /// Grains that give way hit each other at random times (a Poisson process drawn sample by sample).
    fn shift_grain(&mut self, slot: &SurfaceSlot, sample: u64, sample_rate_hz: f64) {
        let draw = self.grains.uniform();
        let expected = self.reaction.grain_rate_per_s / sample_rate_hz;
        if draw < expected {
            // The part of the draw below `expected` is uniform too: it says when within the sample.
            let pulse = HertzPulse {
                impulse_n_s: self.reaction.grain_impulse_n_s * (0.5 + draw / expected),
                contact_time_s: slot.hertz.contact_time_s(0.1),
            };
            self.deposit(&pulse, sample, draw / expected, sample_rate_hz);
        }
    }

    fn deposit(&mut self, pulse: &HertzPulse, sample: u64, offset: f64, sample_rate_hz: f64) {
        pulse.deposit(&mut self.bus, sample, offset, sample_rate_hz);
        self.bus_busy_until = self.bus_busy_until.max(pulse_end(pulse, sample, sample_rate_hz));
    }

    /// A resting contact: nothing moves, so nothing is computed; the rows stay as they were.
    fn rest(&mut self, n: usize, scratch: &mut Scratch) {
        scratch.points[..n].fill(self.last_point);
        scratch.pad[..n].fill(self.last_row);
        scratch.out.haptic[..n].fill(self.last_felt);
        scratch.out.impulse_n_s[..n].fill(0.0);
        scratch.out.excites = false;
        (scratch.out.collisions, scratch.out.resets) = (0, 0);
    }

    /// Raised cosines, without step or corner: in for a contact that was suddenly there (a landing has
    /// its own beginning), out for one that ended, lapsed or was stolen.
    fn apply_fades(&mut self, shared: &Shared, n: usize, scratch: &mut Scratch) {
        if self.fade_in_left == 0 && self.rising.is_none() && self.phase == Phase::Sounding {
            self.gain = 1.0;
            return;
        }
        let (total, rise) = (shared.fade_samples(), &shared.fade);
        for i in 0..n {
            self.gain = 1.0;
            if self.fade_in_left > 0 {
                self.fade_in_left -= 1;
                self.gain *= rise[(total - self.fade_in_left) as usize];
            }
            if let Some(rising) = &mut self.rising {
                self.gain *= rising.tick(total);
                if rising.phase >= 1.0 {
                    self.rising = None;
                }
            }
            if let Phase::Fading { left } = self.phase {
                let left = left.saturating_sub(1);
                self.gain *= rise[left as usize];
                self.phase = Phase::Fading { left };
            }
            if self.gain != 1.0 {
                scratch.out.scale(i, self.gain);
            }
        }
        if self.phase == (Phase::Fading { left: 0 }) {
            self.phase = Phase::Free;
        }
    }

    fn fall_asleep_when_still(
        &mut self,
        output: &ContactOutput,
        shared: &Shared,
        position: u64,
        n: usize,
        scratch: &Scratch,
    ) {
        let row = PadSample { onset: None, ..scratch.pad[n - 1] };
        self.last_row = row;
        if self.asleep {
            return;
        }
        let still = match output.quantity() {
            Quantity::Displacement => STILL_M,
            Quantity::Acceleration => STILL_M_S2,
        };
        // Without a high-pass a resting pad is felt as its constant displacement.
        let felt = self.last_felt;
        let feels_still = felt.abs() < still || (felt - row.pad_m).abs() < still;
        self.asleep = feels_still
            && self.trajectory.is_still()
            && shared.micro_contact.is_settled(&self.pad, row.height_m, row.normal_force_n)
            && self.reaction.grain_rate_per_s == 0.0
            && scratch.out.impulse_n_s[n - 1].abs() < STILL_N_S
            && self.bus_busy_until <= position + n as u64;
        if self.asleep {
            self.last_felt = if felt.abs() < still { 0.0 } else { felt };
            self.force_history_n_s = [0.0; FORCE_HISTORY];
        }
    }

    /// Shows the stretch to the tap. Rows describe the instant `latency` samples back, so the path's
    /// points are delayed by as much.
    fn show<T: Tap>(
        &mut self,
        seat: &Seat,
        shared: &Shared,
        position: u64,
        n: usize,
        scratch: &mut Scratch,
        tap: &mut T,
    ) {
        let Some(slot) = seat.current().filter(|_| tap.is_watching()) else { return };
        let size_m = [slot.surface.width_m, slot.surface.height_m];
        let latency = shared.micro_contact.latency_samples();
        for i in 0..n {
            let point = if i >= latency { scratch.points[i - latency] } else { self.last_point };
            scratch.position_m[i] = point.position_m;
            scratch.velocity_m_s[i] = point.velocity_m_s;
            scratch.uv[i] = [point.position_m[0] / size_m[0], point.position_m[1] / size_m[1]];
            scratch.output_force_n[i] = output_force(
                &point,
                &scratch.pad[i],
                scratch.surface.gradient[i],
                scratch.surface.friction[i],
                &self.reaction,
            );
        }
        // The first rows of a contact would describe instants before it began.
        let skip = latency.saturating_sub((position - self.begun) as usize).min(n);
        tap.contact(&ContactBlock {
            first_sample: position + skip as u64 - latency as u64,
            contact: self.contact,
            position_m: &scratch.position_m[skip..n],
            uv: &scratch.uv[skip..n],
            velocity_m_s: &scratch.velocity_m_s[skip..n],
            contact_samples: &scratch.pad[skip..n],
            impulse_n_s: &scratch.out.impulse_n_s[skip..n],
            force_n: &scratch.output_force_n[skip..n],
        });
    }
}

/// One past the last sample that a pulse reaches.
pub(crate) fn pulse_end(pulse: &HertzPulse, sample: u64, sample_rate_hz: f64) -> u64 {
    // A saturating cast: an endless pulse is cut to the bus by the deposit itself.
    sample + (pulse.contact_time_s * sample_rate_hz) as u64 + hertz::KERNEL_SAMPLES as u64 + 2
}

/// 3-D force on the finger: contact + friction + texture (along the surface's slope) + what the
/// surface does by itself.
fn output_force(
    point: &PathPoint,
    row: &PadSample,
    gradient: [f64; 2],
    friction: f64,
    reaction: &Reaction,
) -> [f64; 3] {
    let [u, v] = point.velocity_m_s;
    let pressed_n = row.contact_force_n;
    // Below 1 mm/s friction grows linearly, so that a resting finger does not chatter.
    let slide = friction * pressed_n / (u * u + v * v).sqrt().max(STICK_M_S);
    let [fx, fy, fz] = reaction.force_n;
    [fx - slide * u - pressed_n * gradient[0], fy - slide * v - pressed_n * gradient[1], fz + pressed_n]
}

fn path_event(sample: &ContactSample, slot: &SurfaceSlot, position: u64) -> PathEvent {
    PathEvent {
        sample: position,
        position_m: [sample.uv[0] * slot.surface.width_m, sample.uv[1] * slot.surface.height_m],
        velocity_m_s: sample.velocity_m_s,
        normal_force_n: sample.normal_force_n,
    }
}

impl Scratch {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self {
            points: [PathPoint::default(); MAX_BLOCK],
            position_m: [[0.0; 2]; MAX_BLOCK],
            velocity_m_s: [[0.0; 2]; MAX_BLOCK],
            footprint_m: [0.0; MAX_BLOCK],
            noise_footprint_m: [0.0; MAX_BLOCK],
            force_n: [0.0; MAX_BLOCK],
            uv: [[0.0; 2]; MAX_BLOCK],
            force_impulse_n_s: [0.0; FORCE_HISTORY + MAX_BLOCK],
            surface: SurfaceBlock::default(),
            rough: SurfaceBlock::default(),
            pad: [PadSample::default(); MAX_BLOCK],
            output_force_n: [[0.0; 3]; MAX_BLOCK],
            out: VoiceBlock {
                haptic: [0.0; MAX_BLOCK],
                impulse_n_s: [0.0; MAX_BLOCK],
                excites: false,
                collisions: 0,
                resets: 0,
            },
        })
    }
}
