//! One contact: the signal path of the paper on one screen (Hasti, Fig. 2).
//!
//! path → profile → micro-contact → { pad displacement → actuator, impulses → body }

mod events;
mod excitation;
mod fades;
mod high_passes;
mod landing;
mod pressed;
mod role;
mod scratch;
mod skin;
mod watching;

pub(crate) use events::EMPTY_FORCE_N;
use excitation::LONGEST_COLLISION_S;
pub(crate) use role::Role;

use crate::audio::seat::{Noise, Seat};
use crate::audio::smoothed::Smoothed;
use crate::link::tap::Tap;
use crate::model::event::ContactId;
use crate::model::inner_rate::InnerRate;
use crate::prepared::impulse_ring::ImpulseRing;
use crate::prepared::probe::PreparedProbe;
use asperity_dsp::actuator::{ContactOutput, ContactOutputState, Quantity, Skin, SkinState};
use asperity_dsp::butterworth;
use asperity_dsp::fractal_noise::FractalNoise;
use asperity_dsp::hertz::{FORCE_HISTORY, OnsetMerge};
use asperity_dsp::micro_contact::{ContactSample as PadSample, ContactState, MicroContact};
use asperity_dsp::rng::Rng;
use asperity_dsp::trajectory::{PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use asperity_texture::height_field::{MAX_BLOCK, PathBlock, Reaction, SurfaceBlock, Touch};
use fades::Rising;
use pressed::Pressed;

/// High-passed pad displacement that counts as still, m: −160 dB of 0.1 mm.
const STILL_M: f64 = 1e-12;
/// Pad acceleration that counts as still, m/s²: −120 dB of what a fingertip just feels.
const STILL_M_S2: f64 = 1e-6;
/// The overlay fades as if it were sampled at this rate, Hz, so that it is the same relief at every rate: its finest octave is
/// whole where its cells pass at 11 kHz and gone where they pass at 22 kHz. Above 18 kHz next to nothing is left.
const OVERLAY_RATE_HZ: f64 = 44_100.0;
/// Impulse per sample below which a contact counts as silent, N·s: −120 dB of an ordinary stroke's.
const STILL_N_S: f64 = 1e-12;

/// Where a voice is before it is anybody's.
const IDLE: PathEvent =
    PathEvent { sample: 0, fraction: 0.0, position_m: [0.0; 2], velocity_m_s: None, normal_force_n: 0.0 };

/// What every voice needs and none owns.
pub(crate) struct Shared {
    pub(crate) idle_path: TrajectoryDesign,
    pub(crate) idle_output: ContactOutput,
    /// Inside; which of these samples leave says `inner`.
    pub(crate) sample_rate_hz: f64,
    pub(crate) inner: InnerRate,
    /// The engine's own probe, and those that were added.
    pub(crate) own_probe: PreparedProbe,
    pub(crate) probes: Vec<Option<Box<PreparedProbe>>>,
    /// By how many samples the rows of every probe lag behind its inputs.
    pub(crate) row_latency: usize,
    pub(crate) noise: FractalNoise,
    /// Octaves of noise left out because blocks run late.
    pub(crate) noise_octaves_gone: u32,
    /// The rise of a fade, 0 to 1.
    pub(crate) fade: Box<[f64]>,
}

impl Shared {
    /// The probe of a place; the engine's own for none.
    pub(crate) fn probe(&self, place: Option<usize>) -> &PreparedProbe {
        let added = place.and_then(|place| self.probes.get(place)?.as_deref());
        added.unwrap_or(&self.own_probe)
    }

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
    pub(crate) role: Role,
    pub(crate) phase: Phase,
    pub(crate) begun: u64,
    pub(crate) refreshed: u64,
    /// Whether it fades because the game said so, and not because it lapsed or was stolen.
    pub(crate) ended: bool,
    /// Whether it fades because its contact has jumped and goes on in another voice.
    left_behind: bool,
    /// Reports without force in a row.
    empty_reports: u32,
    slot: usize,
    asleep: bool,
    fade_in_left: u32,
    /// How fast it comes down while it is still in the air, m/s; 0 once it has touched.
    landing_m_s: f64,
    /// Coming back out of a fade.
    rising: Option<Rising>,
    /// Gain of the last sample.
    gain: f64,
    /// On its way to the role's gain.
    role_gain: Smoothed,
    trajectory: Trajectory,
    last_point: PathPoint,
    last_row: PadSample,
    last_felt: f64,
    /// The contact model, as stiff as what presses makes it.
    contact_model: Box<MicroContact>,
    pressed: Pressed,
    pad: ContactState,
    /// The row that waits, where rows have to.
    late_row: PadSample,
    resets_told: u32,
    merge: OnsetMerge,
    feel: ContactOutputState,
    /// What the skin lets through of an acceleration, at present, and its memory.
    skin: Option<(Skin, SkinState)>,
    force_high_pass: butterworth::State,
    reaction: Reaction,
    grains: Rng,
    /// The impulses of the last forces, which are still on their way to the body.
    force_history_n_s: [f64; FORCE_HISTORY],
    bus: ImpulseRing,
    /// Sent to the body since the last row that was shown.
    unshown_n_s: f64,
}

/// What one voice adds to a stretch of samples.
pub(crate) struct VoiceBlock {
    /// m or m/s², as the actuator plays it.
    pub(crate) haptic: [f64; MAX_BLOCK],
    pub(crate) impulse_n_s: [f64; MAX_BLOCK],
    /// Whether `impulse_n_s` is more than zeros.
    pub(crate) excites: bool,
    pub(crate) collisions: u64,
    /// Collisions that would have lasted longer.
    pub(crate) shortened: u64,
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
    shown: [PadSample; MAX_BLOCK],
    shown_n_s: [f64; MAX_BLOCK],
    output_force_n: [[f64; 3]; MAX_BLOCK],
    pub(crate) out: VoiceBlock,
}

impl Voice {
    /// A voice that nobody uses; `slot` is its place in the renderer. Allocates its bus.
    pub(crate) fn free(slot: usize, shared: &Shared) -> Self {
        Self {
            contact: ContactId(0),
            surface: 0,
            role: Role::default(),
            phase: Phase::Free,
            begun: 0,
            refreshed: 0,
            ended: false,
            left_behind: false,
            empty_reports: 0,
            slot,
            asleep: false,
            fade_in_left: 0,
            landing_m_s: 0.0,
            rising: None,
            gain: 0.0,
            role_gain: Smoothed::new(shared.sample_rate_hz),
            trajectory: Trajectory::begin(&shared.idle_path, &IDLE),
            last_point: PathPoint::default(),
            last_row: PadSample::default(),
            last_felt: 0.0,
            contact_model: Box::new(shared.own_probe.micro_contact),
            pressed: Pressed::default(),
            pad: shared.own_probe.micro_contact.at_rest(0.0, 0.0),
            late_row: PadSample::default(),
            resets_told: 0,
            merge: OnsetMerge::default(),
            feel: ContactOutputState::begin(&shared.idle_output, 0.0, 0.0),
            skin: None,
            force_high_pass: butterworth::State::default(),
            reaction: Reaction::default(),
            grains: Rng::new(slot as u64),
            force_history_n_s: [0.0; FORCE_HISTORY],
            bus: ImpulseRing::new(LONGEST_COLLISION_S, shared.sample_rate_hz),
            unshown_n_s: 0.0,
        }
    }

    /// Something changed under a resting contact.
    pub(crate) fn wake(&mut self) {
        self.asleep = false;
    }

    /// How much would be missed: what presses harder and moves faster is heard and felt more.
    pub(crate) fn priority(&self) -> f64 {
        let [u, v] = self.last_point.velocity_m_s;
        let speed_m_s = (u * u + v * v).sqrt();
        match self.phase {
            Phase::Free | Phase::Fading { .. } => -1.0,
            Phase::Sounding => self.role.importance * self.last_point.normal_force_n * (1e-3 + speed_m_s),
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
        // First the touch, then the heights: a surface that gives way answers within the same grid
        // cell wherever it is cut into stretches. Who sleeps still touches, and wakes when the ground stirs.
        if at_grid {
            self.press(seat, position);
            self.asleep &= !self.reaction.stirs;
        }
        if self.asleep {
            self.rest(n, scratch);
        } else {
            if at_grid {
                self.stiffen(seat, shared, position, self.last_point.normal_force_n);
                self.soften(shared, output);
            }
            self.follow_path(seat, n, scratch);
            self.profile(seat, shared, position, n, tap.is_watching(), scratch);
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
            self.fall_asleep_when_still(output, position, n, scratch);
        }
    }

    fn follow_path(&mut self, seat: &Seat, n: usize, scratch: &mut Scratch) {
        if let Some(slot) = seat.current() {
            self.trajectory.advance(&slot.trajectory, &mut scratch.points[..n]);
        }
    }

    /// Heights along the path: the source, and the paper's micro-noise below the source's own band. Slopes only if a tap is
    /// `watched`: neither sound nor feel needs them.
    fn profile(
        &self,
        seat: &mut Seat,
        shared: &Shared,
        position: u64,
        n: usize,
        watched: bool,
        scratch: &mut Scratch,
    ) {
        let step_s = 1.0 / shared.sample_rate_hz;
        let samples_of_overlay = (shared.sample_rate_hz / OVERLAY_RATE_HZ).max(1.0);
        let widened = samples_of_overlay * f64::from(1u32 << shared.noise_octaves_gone);
        for (i, point) in scratch.points[..n].iter().enumerate() {
            let [u, v] = point.velocity_m_s;
            scratch.position_m[i] = point.position_m;
            scratch.velocity_m_s[i] = point.velocity_m_s;
            scratch.footprint_m[i] = u * u + v * v;
            scratch.force_n[i] = point.normal_force_n;
        }
        // On their own, because roots go side by side.
        for (footprint_m, noise_m) in scratch.footprint_m[..n].iter_mut().zip(&mut scratch.noise_footprint_m)
        {
            *footprint_m = footprint_m.sqrt() * step_s;
            // A footprint twice as wide hides the finest octave that is left.
            *noise_m = *footprint_m * widened;
        }
        let path = PathBlock {
            position_m: &scratch.position_m[..n],
            velocity_m_s: &scratch.velocity_m_s[..n],
            footprint_m: &scratch.footprint_m[..n],
            normal_force_n: &scratch.force_n[..n],
            first_sample: position,
            contact: self.slot,
            slopes: watched,
        };
        let tip_radius_m = shared.probe(self.role.probe).tip_radius_m();
        let noise =
            Noise { field: &shared.noise, footprint_m: &scratch.noise_footprint_m[..n], tip_radius_m };
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
        self.reaction = seat.react(&self.touch_at(position));
    }

    /// How the contact pressed at its last sample.
    fn touch_at(&self, position: u64) -> Touch {
        Touch {
            contact: self.slot,
            sample: position,
            position_m: self.last_point.position_m,
            velocity_m_s: self.last_point.velocity_m_s,
            normal_force_n: self.last_point.normal_force_n,
        }
    }

    fn touch(&mut self, shared: &Shared, n: usize, scratch: &mut Scratch) {
        let probe = shared.probe(self.role.probe);
        self.contact_model.run(
            &mut self.pad,
            &scratch.surface.height_m[..n],
            &scratch.force_n[..n],
            &mut scratch.pad[..n],
        );
        if probe.waits {
            self.wait_a_row(&mut scratch.pad[..n]);
        }
        if self.landing_m_s > 0.0 {
            self.feel_no_air(&mut scratch.pad[..n]);
        }
        let resets = self.pad.resets();
        scratch.out.resets = u64::from(resets.wrapping_sub(self.resets_told));
        self.resets_told = resets;
    }

    /// Rows come a sample later, so that those of every probe describe the same instant.
    fn wait_a_row(&mut self, rows: &mut [PadSample]) {
        for row in rows {
            std::mem::swap(row, &mut self.late_row);
        }
    }

    /// A resting contact: nothing moves, so nothing is computed; the rows stay as they were.
    fn rest(&mut self, n: usize, scratch: &mut Scratch) {
        scratch.points[..n].fill(self.last_point);
        scratch.pad[..n].fill(self.last_row);
        scratch.out.haptic[..n].fill(self.last_felt);
        scratch.out.impulse_n_s[..n].fill(0.0);
        scratch.out.excites = false;
        (scratch.out.collisions, scratch.out.shortened, scratch.out.resets) = (0, 0, 0);
    }

    fn fall_asleep_when_still(&mut self, output: &ContactOutput, position: u64, n: usize, scratch: &Scratch) {
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
            && self.contact_model.is_settled(&self.pad, row.height_m, row.normal_force_n)
            && self.reaction.grain_rate_per_s == 0.0
            && !self.reaction.stirs
            && scratch.out.impulse_n_s[n - 1].abs() < STILL_N_S
            && self.bus.is_empty(position + n as u64);
        if self.asleep {
            self.last_felt = if felt.abs() < still { 0.0 } else { felt };
            self.force_history_n_s = [0.0; FORCE_HISTORY];
        }
    }
}
