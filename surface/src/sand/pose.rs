//! Pose: where a contact is in a frame of the simulation.

/// Frames a second.
pub const FRAMES_PER_S: f64 = 60.0;

/// Place of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Its number.
    pub contact: usize,
    /// Position, metres.
    pub position_m: [f64; 2],
    /// Velocity, m/s.
    pub velocity_m_s: [f64; 2],
    /// Force pressing it down, N.
    pub normal_force_n: f64,
    /// It was lifted since the last pose: its tool is put down here, not dragged here.
    pub landed: bool,
}
