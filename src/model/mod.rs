//! The parts of a scene: plain data in SI units, each with its range checked in one place.

pub(crate) mod actuator;
pub(crate) mod bad_value;
pub(crate) mod body;
pub(crate) mod bus;
pub(crate) mod clock_mode;
pub(crate) mod closest_point;
pub(crate) mod config;
pub(crate) mod error;
pub(crate) mod event;
pub(crate) mod excitation;
pub(crate) mod frame;
pub(crate) mod id;
pub(crate) mod inner_rate;
pub(crate) mod levels;
pub(crate) mod material;
pub(crate) mod modal_model;
pub(crate) mod mode_shapes;
pub(crate) mod probe;
pub(crate) mod residual;
pub(crate) mod stamp;
pub(crate) mod stock;
pub(crate) mod strike_field;
pub(crate) mod surface;
pub(crate) mod uv_triangle;
