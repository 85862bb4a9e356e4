//! Pad: the micro-contact (`dsp::micro_contact`), as stiff as what presses makes it. Heights and
//! forces in, one [row](PadSample) a sample out.

use super::PadSample;
use crate::link::stats::Counts;
use crate::resource::probe::PreparedProbe;
use crate::resource::stiffness::Ground;
use asperity_dsp::micro_contact::{ContactState, MicroContact, Probe, SubSampleProfile};

/// A contact force so many times what presses is a blow: a heavy or stiff probe comes down from a
/// crest with v √(k m), whatever presses it. Fingertips reach 13 on ordinary ribs.
const BLOW: f64 = 30.0;
/// Less than this is no touch but a contact that fades, N.
const LIGHTEST_N: f64 = 0.01;
/// Contact force over what presses at which no contact appears: it would begin in a blow.
const PREROLL_BLOW: f64 = 10.0;

/// The pad of one contact.
pub(super) struct Pad {
    /// As stiff as what presses makes it.
    model: Box<MicroContact>,
    state: ContactState,
    /// Force and ground that the stiffness was worked out for.
    stiff_for: Option<(f64, Ground)>,
    /// The row that waits, where rows have to.
    late_row: PadSample,
    /// Closing speed while it is still in the air, m/s; 0 once it has touched.
    landing_m_s: f64,
    resets_told: u32,
    /// True where a blow was under way at the last row.
    in_blow: bool,
    /// True where the last row hung from its leash.
    hangs: bool,
}

impl Pad {
    /// Allocates the model.
    pub(super) fn idle(probe: &PreparedProbe) -> Self {
        Self {
            model: Box::new(probe.micro_contact),
            state: probe.micro_contact.at_rest(0.0, 0.0),
            stiff_for: None,
            late_row: PadSample::default(),
            landing_m_s: 0.0,
            resets_told: 0,
            in_blow: false,
            hangs: false,
        }
    }

    /// Sets the stiffness that probe, ground and force make: at the steps of the absolute grid.
    pub(super) fn stiffen(&mut self, probe: &PreparedProbe, ground: Ground, force_n: f64) {
        let now = (force_n, ground);
        if self.stiff_for != Some(now) {
            self.stiff_for = Some(now);
            probe.stiffness_table.set(&mut self.model, probe.stiffness_n_m(&ground, force_n));
        }
    }

    /// Another contact begins.
    pub(super) fn begin(&mut self, probe: &PreparedProbe, ground: Ground, force_n: f64) {
        (self.stiff_for, self.landing_m_s) = (None, 0.0);
        (self.in_blow, self.hangs) = (false, false);
        self.stiffen(probe, ground, force_n);
    }

    /// Comes down and touches `later` samples after the stretch that follows begins.
    pub(super) fn land(&mut self, height_m: f64, force_n: f64, closing_m_s: f64, later: f64) {
        self.landing_m_s = closing_m_s;
        self.state = self.model.landing_later(height_m, force_n, closing_m_s, later);
        let pad_velocity_m_s = -closing_m_s;
        self.late_row = PadSample { height_m, pad_m: height_m, pad_velocity_m_s, ..PadSample::default() };
        self.resets_told = self.state.resets();
    }

    /// Is there, at rest on its ground.
    pub(super) fn appear(&mut self, height_m: f64, force_n: f64) {
        self.state = self.model.at_rest(height_m, force_n);
        self.late_row =
            PadSample { height_m, pad_m: height_m, contact_force_n: force_n, ..PadSample::default() };
        self.resets_told = self.state.resets();
    }

    /// Has been sliding along a line that rises by `rise_m_s`, finger and pad with it: set off from
    /// rest they would still swing when they are felt. The heights are those a sample before it
    /// leaves the line, there, and a sample later; returns how many after the middle it has got.
    pub(super) fn start_sliding(&mut self, heights_m: [f64; 3], force_n: f64, rise_m_s: f64) -> usize {
        self.state = self.model.sliding_along_a_line(heights_m, force_n, rise_m_s);
        self.model.latency_samples()
    }

    /// Appears after such a row, on ground of this height that rises by `rise_m_s` on the whole.
    pub(super) fn start_after(&mut self, row: &PadSample, height_m: f64, force_n: f64, rise_m_s: f64) {
        self.late_row = PadSample { onset: None, ..*row };
        if self.state.resets() > 0 || row.contact_force_n > PREROLL_BLOW * force_n {
            // Ground that was never there cannot have thrown it.
            self.state = self.model.riding(height_m, force_n, rise_m_s);
        }
        self.resets_told = self.state.resets();
    }

    /// A row for each height, as the model gives it.
    pub(super) fn run(
        &mut self,
        heights_m: &[f64],
        forces_n: &[f64],
        ground: SubSampleProfile<'_>,
        rows: &mut [PadSample],
    ) {
        self.model.run_over(&mut self.state, heights_m, forces_n, ground, rows);
    }

    /// The probe as stiff as it is.
    pub(super) fn probe(&self) -> &Probe {
        self.model.probe()
    }

    /// Rows of the model as they are felt, and what is counted. Rows that wait come a sample later,
    /// so that those of every probe describe the same instant.
    pub(super) fn settle(&mut self, waits: bool, rows: &mut [PadSample], counts: &mut Counts) {
        if waits {
            rows.iter_mut().for_each(|row| std::mem::swap(row, &mut self.late_row));
        }
        if self.landing_m_s > 0.0 {
            self.mask_free_flight(rows);
        }
        let resets = self.state.resets();
        counts.resets = u64::from(resets.wrapping_sub(std::mem::replace(&mut self.resets_told, resets)));
        counts.blows = 0;
        let leash_m = self.model.probe().leash_m;
        for row in rows {
            let in_blow = row.contact_force_n > BLOW * row.normal_force_n.max(LIGHTEST_N);
            // Thrown so far off a crest that the leash pulls it down: it presses more than it is
            // pressed.
            let hangs = row.pad_m - row.height_m > leash_m && row.normal_force_n > LIGHTEST_N;
            counts.blows += u64::from(in_blow && !self.in_blow || hangs && !self.hangs);
            (self.in_blow, self.hangs) = (in_blow, hangs);
        }
    }

    /// Nothing is felt of the way through the air: until it touches, a pad is at the surface.
    fn mask_free_flight(&mut self, rows: &mut [PadSample]) {
        for row in rows {
            if row.onset.is_some() || row.pad_m < row.height_m {
                self.landing_m_s = 0.0;
                return;
            }
            row.finger_m -= row.pad_m - row.height_m;
            (row.pad_m, row.pad_velocity_m_s) = (row.height_m, -self.landing_m_s);
        }
    }

    /// Tests whether finger and pad rest where the last row says.
    pub(super) fn is_settled(&self, row: &PadSample) -> bool {
        self.model.is_settled(&self.state, row.height_m, row.normal_force_n)
    }
}
