//! Prepared resources, designed by the game half and owned by the audio half: everything that a
//! body or a surface needs to sound, in memory made beforehand.

pub(crate) mod area;
pub(crate) mod bank;
pub(crate) mod body;
pub(crate) mod body_field;
pub(crate) mod body_rub;
pub(crate) mod bursts;
pub(crate) mod clip;
pub(crate) mod diffuse;
pub(crate) mod holding;
pub(crate) mod impulse_ring;
pub(crate) mod long_waves;
pub(crate) mod overlay;
pub(crate) mod pickup;
pub(crate) mod probe;
pub(crate) mod rolled_over;
pub(crate) mod sinc;
pub(crate) mod slider;
pub(crate) mod stiffness;
pub(crate) mod strike_point;
pub(crate) mod stroking;
pub(crate) mod surface;
pub(crate) mod tip_force;
