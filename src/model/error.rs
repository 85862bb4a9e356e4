//! One error type for each thing that can fail on the game side. Nothing on the audio half fails.

use crate::model::bad_value::BadValue;
use crate::model::event::ContactEvent;
use asperity_dsp::DesignError;
use asperity_dsp::simd::{Isa, Level};

/// Why an engine cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// A setting is outside its range.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// An instruction set that this processor lacks.
    #[error("kernel: \"{isa}\" is not in this processor; must be one of: {}", known_kernels())]
    Kernel {
        /// The instruction set asked for.
        isa: &'static str,
    },
    /// The system gives no further threads.
    #[error(
        "threads: the system gives no {threads} threads ({error}); must be fewer, 1 renders on the calling thread alone"
    )]
    Threads {
        /// Number that was asked for.
        threads: usize,
        /// Message of the system.
        error: std::io::ErrorKind,
    },
}

/// The instruction sets of this processor, separated by commas.
fn known_kernels() -> String {
    let here = Isa::ALL.into_iter().filter(|isa| Level::find(*isa).is_some());
    here.map(Isa::name).collect::<Vec<_>>().join(", ")
}

/// Why an event was not taken. The event is handed back.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct ReportError {
    /// The event that was not taken.
    pub event: ContactEvent,
    /// Why.
    pub reason: Refusal,
}

/// The reasons to refuse an event.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The audio half is not keeping up or not running; try again, or let the event go.
    #[error("the event queue is full; report less often, or render more often")]
    QueueFull,
    /// A number no contact can have.
    #[error(transparent)]
    BadValue(#[from] BadValue),
    /// Game time ran backwards.
    #[error("time_s: {time_s} comes after {before_s}; game time must not run backwards")]
    TimeBackwards {
        /// The stamp, s.
        time_s: f64,
        /// The stamp before it, s.
        before_s: f64,
    },
    /// The surface is not, or no longer, in this scene.
    #[error("surface: is not in this scene; add it before it is touched")]
    UnknownSurface,
    /// A depth was reported on a surface that does not give way.
    #[error(
        "depth_m: the surface is hard, so that a depth says nothing about the force; report normal_force_n, or make it soft (sand, or compliance_m_n)"
    )]
    Hard,
    /// The body is not, or no longer, in this scene.
    #[error("body: is not in this scene; add it before it is struck")]
    UnknownBody,
    /// The probe is not in this scene.
    #[error("probe: is not in this scene; add it before it touches")]
    UnknownProbe,
    /// There is no such haptic channel.
    #[error("actuator: {index} is refused; must be below {channels}, the number of actuators")]
    UnknownActuator {
        /// The index given.
        index: u16,
        /// Number of channels.
        channels: usize,
    },
}

/// Fault of a pickup.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PickupProblem {
    /// A number no pickup can have.
    #[error(transparent)]
    BadValue(#[from] BadValue),
    /// There is no such channel.
    #[error("channel: {0} is refused; must be below {1}, the number of pickups in the config")]
    Channel(usize, usize),
    /// The place is off the surface.
    #[error(
        "at_m: is {0} m off the surface; must be within 1 % of the body's size, {1} m here: the nearest place of it is {2:?}"
    )]
    OffSurface(f64, f64, [f64; 3]),
    /// The body has shapes, and no place is given.
    #[error("at_m: is missing; write a place of the surface, [x, y, z] in metres")]
    NoPlace,
    /// The body has shapes, which say how much a place moves.
    #[error("factor: stands on a body with shapes; write at_m instead")]
    FactorBesideShapes,
    /// The body has no shapes, so that a place says nothing.
    #[error("at_m: the body has no shapes; write factor (how much it moves with each mode, -1 to 1)")]
    NoShapes,
    /// The body has no shapes and no mass, so that nothing says how far it moves.
    #[error("factor: nothing says how far the body moves; write its mass_kg, or give modes with shapes")]
    NoMass,
}

/// Why a surface or body was not added.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AddError {
    /// Every place is taken.
    #[error("{kind}: all {capacity} places are taken; remove one or raise max_{kind} in the config")]
    Full {
        /// "surfaces", "bodies", "probes" or "ports".
        kind: &'static str,
        /// Number of places.
        capacity: usize,
    },
    /// The way to the audio half is full.
    #[error("the queue to the audio half is full; render before adding more, or raise queue_capacity")]
    QueueFull,
    /// A number no surface or body can have.
    #[error(transparent)]
    BadValue(#[from] BadValue),
    /// A parameter the path stage, the impact model or the modal bank cannot be designed with.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// A pickup that reads nothing: which, what is wrong with it, what would be right.
    #[error("pickup {number}: {problem}")]
    Pickup {
        /// Its channel, from 1.
        number: usize,
        /// Fault of it, and what would be right.
        problem: PickupProblem,
    },
    /// There is no such audio bus.
    #[error("bus: {bus} is refused; must be below {buses}, the number of buses under audio")]
    UnknownBus {
        /// The index given.
        bus: usize,
        /// Number of buses.
        buses: usize,
    },
    /// The surface never changes, so that there is nothing to be shown.
    #[error("surface: its source never changes, so that there is no moving picture of it; only sand has one")]
    NeverChanges,
    /// Friction is to ring a body whose motion is unknown.
    #[error(
        "excitation: friction sticks and slips with a body, so its motion must be known; put the surface on a body whose modes have shapes and give it a frame, or set the body's mass_kg"
    )]
    CannotRub,
    /// A tracked tip needs to know where a surface lies.
    #[error(
        "frame: is missing; a tracked tip must know where the surface lies: give it Surface::frame, or [surface.frame] in a scene file"
    )]
    NoFrame,
    /// Thing that it refers to and that is not in this scene.
    #[error("{0}: is not in this scene; add it first")]
    Unknown(&'static str),
}
