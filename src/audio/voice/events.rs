//! Contact events at a voice: it lands, appears, goes on, leaves.

use super::profile::{Along, Profile};
use super::skin::ContactSkin;
use super::{PadSample, PathPoint, Scratch, Voice, VoiceState};
use crate::audio::seat::Seat;
use crate::audio::shared::{Segment, Shared};
use crate::model::event::{ContactId, ContactSample};
use crate::model::stamp::Stamp;
use crate::resource::surface::SurfaceSlot;
use crate::resource::tip_force::TipForce;
use asperity_dsp::actuator::{ContactOutputState, Quantity};
use asperity_dsp::butterworth;
use asperity_dsp::trajectory::Trajectory;
use asperity_surface::height_field::{MAX_BLOCK, NO_TOUCH_N, Reaction, Touch, TouchKind};

/// A force that is no touch, N.
pub(crate) const EMPTY_FORCE_N: f64 = NO_TOUCH_N;

/// Span that a contact that appears is taken to have slid, s: the memory of a 10 Hz high-pass.
const TREND_S: f64 = 0.025;

/// Time before it appears at which the pad leaves its straight line for the ground, s.
const LEAD_IN_S: f64 = 65.0 / 44_100.0;

/// Heights about the place where it does.
const ABOUT: usize = 3;

impl Voice {
    /// Lands on a surface: at rest on it when the closing speed is zero, otherwise with that speed.
    /// `at` begins at the stamp.
    pub(crate) fn begin(
        &mut self,
        contact: ContactId,
        sample: &ContactSample,
        stamp: Stamp,
        at: Segment<'_>,
        seat: &mut Seat,
        scratch: &mut Scratch,
    ) {
        let Some(slot) = seat.current() else { return };
        let (shared, position) = (at.shared, at.position);
        let lands = sample.closing_m_s > 0.0;
        (self.contact, self.phase) = (contact, VoiceState::Sounding);
        (self.begun, self.refreshed) = (position, position);
        (self.asleep, self.ended, self.left_behind) = (false, false, false);
        (self.empty_reports, self.unshown_n_s) = (0, 0.0);
        self.fades.begin(self.role.gain, lands, shared);
        self.between = Default::default();
        let force_n = self.path.begin(sample, slot, stamp);
        self.tip_force = TipForce::begin(sample);
        self.rolling.report(sample);
        scratch.profile.at_m = [sample.at_m.unwrap_or_default(); MAX_BLOCK];
        let ground = slot.stroking.ground;
        seat.touch(&Touch { kind: TouchKind::Begins, ..self.touch_at(position) });
        let probe = shared.probe(self.role.probe);
        self.pad.begin(probe, ground, force_n);
        if let Some(tip) = &probe.tip {
            self.tip.begin(tip, ground, force_n);
        }
        self.drag.begins = true;
        self.drag.press(force_n);
        if lands {
            let points = std::slice::from_ref(&self.path.last);
            let tip = probe.tip.as_ref().map(|tip| (tip.tip_radius_m(), None));
            let along = Along { tip, ..self.along(shared, position, seat, false) };
            scratch.profile.run(seat, along, points, &mut self.cells);
            let height_m = scratch.profile.surface.height_m[0];
            self.between.roughness = scratch.profile.surface.roughness[0];
            self.sample_between(shared, seat);
            let Profile { surface, rough, .. } = &mut scratch.profile;
            self.roll(shared, seat, rough, |rolling, over| rolling.begin(over, surface));
            // It touches at the stamp; without delay it would one sample before the voice's first.
            let later = 1.0 + stamp.fraction();
            self.pad.land(height_m, force_n, sample.closing_m_s, later);
            if probe.tip.is_some() {
                self.tip.land(scratch.profile.tip.height_m[0], force_n, sample.closing_m_s, later);
            }
            let begins = if at.output.quantity() == Quantity::Force { 0.0 } else { height_m };
            self.ac.feel = ContactOutputState::begin(at.output, begins, -sample.closing_m_s);
        } else {
            self.preroll(at, seat, scratch);
        }
        // The high-pass starts settled, so that beginning gives no step.
        self.ac.force = butterworth::State::settled_at(if lands { 0.0 } else { force_n });
        self.reaction = Reaction::default();
        self.skin = ContactSkin::default();
        self.skin.soften(probe, at.output, &self.path.last, shared.sample_rate_hz);
        let loudness = self.loudness(shared, position, seat, &mut scratch.profile.rough);
        // All asperities of a patch land at once, and only as it slides does each sound by itself.
        let loudness = if lands { loudness / probe.heard_share() } else { loudness };
        self.exciters.begin(contact.0 ^ position.rotate_left(32), position, loudness);
    }

    /// A finger that is suddenly there has been sliding already: the pad is led along the straight
    /// line to where it appears, so that it moves with the surface from its first sample.
    fn preroll(&mut self, at: Segment<'_>, seat: &mut Seat, scratch: &mut Scratch) {
        let Segment { shared, output, .. } = at;
        let [slope_m_s, bend_m_s2] = self.trend(at, seat, scratch);
        self.between.roughness = scratch.profile.surface.roughness[MAX_BLOCK - 1];
        self.sample_between(shared, seat);
        let step_s = 1.0 / shared.sample_rate_hz;
        let steps = (LEAD_IN_S * shared.sample_rate_hz).round() as usize;
        // It leaves the line where the ground is known a step before, there, and a step later.
        self.extend_back((steps + 1, step_s, ABOUT), at, seat, scratch);
        let Profile { surface, rough, .. } = &mut scratch.profile;
        self.roll(shared, seat, rough, |rolling, over| rolling.begin(over, surface));
        let Scratch { quartic_correction, profile, .. } = &mut *scratch;
        self.rolling.preroll(&mut profile.surface, ABOUT);
        self.between.ground(shared, &profile.short, ABOUT, quartic_correction);
        let [before_m, here_m, later_m, ..] = profile.surface.height_m;
        let given = self.pad.start_sliding([before_m, here_m, later_m], profile.force_n[0], slope_m_s);
        // The line ends a step before the first height of the ground.
        let steps = steps - 1 - given;
        let (mut left, mut row) = (steps, PadSample::default());
        while left > 0 {
            let count = left.min(MAX_BLOCK);
            self.extend_back((left, step_s, count), at, seat, scratch);
            let Scratch { rows, quartic_correction, profile, .. } = &mut *scratch;
            self.rolling.preroll(&mut profile.surface, count);
            let (heights_m, forces_n) = (&profile.surface.height_m[..count], &profile.force_n[..count]);
            let ground = self.between.ground(shared, &profile.short, count, quartic_correction);
            self.pad.run(heights_m, forces_n, ground, &mut rows[..count]);
            row = rows[..count].last().copied().unwrap_or_default();
            left -= count;
            if left == 0 {
                self.pad.start_after(&row, heights_m[count - 1], forces_n[count - 1], slope_m_s);
            }
        }
        let PadSample { pad_m, pad_velocity_m_s, .. } = row;
        if output.quantity() == Quantity::Force {
            self.ac.feel = ContactOutputState::begin(output, row.contact_force_n, 0.0);
            return;
        }
        self.ac.feel =
            ContactOutputState::begin_sliding(output, pad_m, pad_velocity_m_s, slope_m_s, bend_m_s2);
    }

    /// The profile under `count` points behind the contact, of which the first is `steps` behind.
    fn extend_back(
        &mut self,
        (steps, step_s, count): (usize, f64, usize),
        at: Segment<'_>,
        seat: &mut Seat,
        scratch: &mut Scratch,
    ) {
        let Scratch { points, profile, .. } = scratch;
        let points = &mut points[..count];
        self.path.extend_back(steps, step_s, points);
        let PathPoint { position_m, velocity_m_s, .. } = points[0];
        let from_m = [0, 1].map(|axis| position_m[axis] - velocity_m_s[axis] * step_s);
        let between = self.between.on_the_way(from_m);
        let along = Along { between, ..self.along(at.shared, at.position, seat, false) };
        profile.run(seat, along, points, &mut self.cells);
    }

    /// Rise, m/s, and bend, m/s², of the profile during the last [`TREND_S`].
    fn trend(&mut self, at: Segment<'_>, seat: &mut Seat, scratch: &mut Scratch) -> [f64; 2] {
        let step_s = TREND_S / MAX_BLOCK as f64;
        self.extend_back((MAX_BLOCK, step_s, MAX_BLOCK), at, seat, scratch);
        let [slope, bend] = parabola(&scratch.profile.surface.height_m);
        // The slope is that of the middle; the contact is half a trend later.
        let bend_m_s2 = bend / (step_s * step_s);
        [slope / step_s + bend_m_s2 * 0.5 * step_s * MAX_BLOCK as f64, bend_m_s2]
    }

    /// Follows a report; wakes a resting contact. A jump that no stroke makes changes nothing here:
    /// it returns the path that begins where the contact now is, for another voice. `stamp` may lie
    /// before `position` when the report is late: jitter of arrival does not become one of motion.
    pub(crate) fn moved(
        &mut self,
        sample: &ContactSample,
        slot: &SurfaceSlot,
        stamp: Stamp,
        position: u64,
    ) -> Option<Trajectory> {
        self.refreshed = position;
        self.asleep = false;
        self.path.moved(sample, slot, stamp)
    }

    /// Tests whether a landing is so close to where this contact fades that it is the same touch.
    pub(crate) fn goes_on_at(&self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> bool {
        self.path.goes_on_at(sample, slot, stamp)
    }

    /// Starts to fade, if it has not yet, pressed as it is now: the smoothed force still falls
    /// after a lift-off, and the pad it sets free would be felt as a thump louder than the stroke.
    pub(crate) fn fade(&mut self, shared: &Shared) {
        if self.phase == VoiceState::Sounding {
            self.path.hold_force();
            self.phase = VoiceState::Fading { left: shared.fade_samples() };
        }
    }

    /// Comes back out of its fade.
    pub(crate) fn resume(&mut self, shared: &Shared) {
        self.fades.resume(self.phase, shared);
        self.phase = VoiceState::Sounding;
        self.ended = false;
        self.left_behind = false;
    }

    /// Fades because its contact goes on in another voice.
    pub(crate) fn leave(&mut self, shared: &Shared) {
        self.fade(shared);
        self.left_behind = true;
    }

    /// Goes on as a path before it, as far as that has learned to know the game.
    pub(crate) fn inherit_rate(&mut self, path: &Trajectory) {
        self.path.inherit_rate(path);
    }

    /// The force to render for a report, or none if the contact has left the surface. One report
    /// without force holds the force before it: solvers make such from a finger that never left.
    pub(crate) fn pressed_n(&mut self, reported_n: f64) -> Option<f64> {
        if reported_n > EMPTY_FORCE_N {
            self.empty_reports = 0;
            return Some(reported_n);
        }
        self.empty_reports = self.empty_reports.saturating_add(1);
        (self.empty_reports == 1).then(|| self.path.reported_force_n())
    }
}

/// Slope a step in the middle, and bend, of the parabola that fits best.
fn parabola(values: &[f64; MAX_BLOCK]) -> [f64; 2] {
    let n = MAX_BLOCK as f64;
    let mean_square = (n * n - 1.0) / 12.0;
    let (mut slope, mut bend, mut squares, mut fourths) = (0.0, 0.0, 0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let x = i as f64 - 0.5 * (n - 1.0);
        let q = x * x - mean_square;
        slope += x * value;
        bend += q * value;
        squares += x * x;
        fourths += q * q;
    }
    [slope / squares, 2.0 * bend / fourths]
}
