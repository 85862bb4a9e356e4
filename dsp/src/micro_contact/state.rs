//! One contact's memory, and the rows it produces.

/// The first touch of skin and surface within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    /// Moment, from 0 (the previous row's time) to 1 (this row's time).
    pub offset: f64,
    /// Speed at which skin and surface met, m/s, above 0.
    pub closing_m_s: f64,
}

/// One row of output: everything holds at the row's time, forces and onsets cover the step that
/// ends there.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactSample {
    /// x_m: the profile height used, m.
    pub height_m: f64,
    /// F_n used, N (never negative).
    pub normal_force_n: f64,
    /// x_s: the skin, m, positive out of the surface.
    pub pad_m: f64,
    /// v_s, m/s.
    pub pad_velocity_m_s: f64,
    /// x_f: the finger, less the pad's unloaded thickness, m.
    pub finger_m: f64,
    /// Mean force of the surface on the skin, N: times the step it is the impulse.
    pub contact_force_n: f64,
    /// The hardest touch within the step, if there was one.
    pub onset: Option<Onset>,
}

/// Memory of one contact. It belongs to the design that made it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// (d, p, v_s, v_f). Semi-implicit Euler carries d and p one drift ahead: d there is the next
    /// skin position above the last height.
    pub(super) y: [f64; 4],
    /// d at the last row.
    pub(super) gap_m: f64,
    /// The last three heights, oldest first; all but the newest serve only the cubic profile.
    pub(super) heights_m: [f64; 3],
    /// The last two forces, oldest first.
    pub(super) forces_n: [f64; 2],
    /// Mean velocity of the ground, m/s, and its height at the last grid step, m: a leash holds the
    /// finger to ground that rises.
    pub(super) rise_m_s: f64,
    pub(super) grid_height_m: f64,
    /// Rows since the start; only its place on the grid of 64 counts.
    pub(super) clock: u32,
    pub(super) resets: u32,
}

impl ContactState {
    pub(super) fn new(y: [f64; 4], height_m: f64, force_n: f64) -> Self {
        Self {
            y,
            gap_m: y[0],
            heights_m: [height_m; 3],
            forces_n: [force_n; 2],
            clock: 0,
            resets: 0,
            rise_m_s: 0.0,
            grid_height_m: height_m,
        }
    }

    /// Number of inputs replaced or states put back on the surface since the start.
    #[must_use]
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// Tests whether the skin touched the surface at the last row.
    #[must_use]
    pub fn is_touching(&self) -> bool {
        self.gap_m < 0.0
    }
}
