//! What the engine accepts, in one list: events, scene files and the contact's guard quote it.
//!
//! What is outside is refused where it enters, by name; what lies inside is rendered as it is.

/// Largest force pressing a contact onto a surface, N: a wedged box in a physics engine reaches some thousands for
/// a step.
pub const MAX_NORMAL_FORCE_N: f64 = 1e4;
/// Farthest that the relief of a surface may lie from zero, m.
pub const MAX_RELIEF_M: f64 = 10.0;
/// Farthest that a height may lie from zero, m: the relief, what its interpolation overshoots by, and the overlay.
/// Beyond, the guard of the contact holds the last good height.
pub const MAX_HEIGHT_M: f64 = 2.0 * MAX_RELIEF_M;
/// Fastest tangential, closing or striking speed, m/s.
pub const MAX_SPEED_M_S: f64 = 100.0;
/// Widest texture coordinate, in tiles from the origin: a `f64` position is still exact to 1e-9 m.
pub const MAX_UV: f64 = 1e6;
/// Largest rms of the micro-relief in the octave about 1 mm, m.
pub const MAX_MICRO_RELIEF_M: f64 = 0.01;
/// Smallest and largest side of a surface, m.
pub const SIDE_M: (f64, f64) = (1e-6, 1e3);
