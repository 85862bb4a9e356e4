//! Parameters: every number that a scene file or a contact log may hold, with its unit, range,
//! default and source.
//!
//! One list for everybody: the reader of scene files takes its ranges from here,
//! `docs/formats/scene.md` its tables, an inspector its sliders. The ranges themselves are those of
//! [`limits`], which the kernels check.

use crate::model::surface::DEFAULT_STICK_SLIP;
use asperity_dsp::limits::{self, Range};
use asperity_dsp::micro_contact as contact;
use asperity_surface::grating;
use asperity_surface::sand::SandLaw;

/// Moment at which a new value is heard and felt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Changes {
    /// While it sounds, without a step.
    Sounding,
    /// While it sounds; what it belongs to begins anew.
    Anew,
    /// At the opening of the scene.
    Opened,
    /// With every event.
    Event,
}

/// A number that a file may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// The table it stands in, `""` for the top of a scene file, `event` for a line of a contact
    /// log.
    pub table: &'static str,
    /// Its key.
    pub key: &'static str,
    /// Its unit, empty for a plain number.
    pub unit: &'static str,
    /// Accepted range.
    pub range: Range,
    /// True for a whole number.
    pub whole: bool,
    /// Number of values that it holds, each in the range: 2 or 3 for a vector.
    pub components: usize,
    /// Value where it is not written; none where it must be, or where something else decides.
    pub default: Option<f64>,
    /// Moment at which a new value is heard and felt.
    pub changes: Changes,
    /// Description.
    pub meaning: &'static str,
    /// Source of its default; empty where there is none, or it says nothing.
    pub source: &'static str,
}

impl Parameter {
    const fn new(
        table: &'static str,
        key: &'static str,
        unit: &'static str,
        range: Range,
        meaning: &'static str,
    ) -> Self {
        let (whole, components, default, changes, source) = (false, 1, None, Changes::Sounding, "");
        Self { table, key, unit, range, whole, components, default, changes, meaning, source }
    }

    const fn whole(self) -> Self {
        Self { whole: true, ..self }
    }

    const fn vector(self, components: usize) -> Self {
        Self { components, ..self }
    }

    const fn or(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }

    const fn from(self, source: &'static str) -> Self {
        Self { source, ..self }
    }

    const fn changes(self, changes: Changes) -> Self {
        Self { changes, ..self }
    }
}

/// The parameter of that key in that table.
#[must_use]
pub fn find(table: &str, key: &str) -> Option<&'static Parameter> {
    ALL.iter().copied().find(|parameter| parameter.table == table && parameter.key == key)
}

/// Declares the parameters of one table each, and the list of all.
macro_rules! parameters {
    ($($(#[doc = $doc:literal])+ mod $module:ident = $table:literal {
        $($name:ident: $key:literal, $unit:literal, $range:expr, $meaning:literal $(, $method:ident($($value:expr)?))*;)+
    })+) => {
        $($(#[doc = $doc])+ pub mod $module {
            #[allow(unused_imports, reason = "not every table needs all")]
            use crate::parameters::{Changes::{Anew, Event, Opened}, *};
            $(#[doc = $meaning]
            pub const $name: Parameter =
                Parameter::new($table, $key, $unit, $range, $meaning)$(.$method($($value)?))*;)+
        })+

        /// All of them, table by table.
        pub const ALL: &[&Parameter] = &[$($(&$module::$name,)+)+];
    };
}

const LAW: SandLaw = SandLaw::DEFAULT;
const SEEDS: Range = Range::new(0.0, u64::MAX as f64, "0 to 2⁶⁴ − 1");

parameters! {
    /// The top of a scene file.
    mod scene = "" {
        SAMPLE_RATE_HZ: "sample_rate_hz", "Hz", limits::output::SAMPLE_RATE_HZ,
            "Rate of the outputs; a sound card's own wins", or(44_100.0), changes(Opened);
        SEED: "seed", "", SEEDS, "Seed of every random number that has none of its own", whole(), changes(Opened);
        TAIL_S: "tail_s", "s", Range::new(0.0, 600.0, "0 to 600 s"), "Ring-out after the last event", or(1.0);
    }
    /// A body.
    mod body = "body" {
        RESIDUAL: "residual", "", limits::material::RESIDUAL,
            "Gain of the residual that the modes file may carry; 0 = not played", or(1.0);
        SIZE_M: "size_m", "m", limits::material::SIZE_M, "Longest side or diameter of a stock body";
        STRIKE_GAIN: "strike_gain", "", limits::impact::GAIN,
            "Linear gain of impacts beside strokes, 1 = as mechanics says; missing: by the level policy where the bus's gain is, else 1";
        LEAST_TIME_S: "least_time_s", "s", limits::impact::LEAST_TIME_S,
            "Time within which an impact no stronger than the one before is dropped, and counted", or(0.0);
        VARIATION: "variation", "", limits::impact::VARIATION,
            "Spread of equal impacts: 0 = none, 1 = as real ones differ", or(0.0);
        MASS_KG: "mass_kg", "kg", limits::material::MASS_KG,
            "Mass, for friction that rings a body without shapes; a stock body's is known";
    }
    /// Material of a body.
    mod material = "material" {
        YOUNG_PA: "young_pa", "Pa", limits::material::YOUNG_PA, "Young's modulus";
        POISSON: "poisson", "", limits::material::POISSON, "Poisson ratio";
        DENSITY_KG_M3: "density_kg_m3", "kg/m³", limits::material::DENSITY_KG_M3, "Density";
        ALPHA_PER_S: "alpha_per_s", "1/s", limits::material::ALPHA_PER_S, "α of the damping d = (α + ηω + βω²)/2";
        ETA: "eta", "", limits::material::ETA, "η of the same";
        BETA_S: "beta_s", "s", limits::material::BETA_S, "β of the same";
        MU_STATIC: "mu_static", "", limits::FRICTION, "Coefficient of static friction";
        MU_KINETIC: "mu_kinetic", "", limits::FRICTION, "Coefficient of kinetic friction";
        ROUGHNESS: "roughness", "", limits::ROUGHNESS, "Perceptual roughness R of its surfaces";
        MICRO_RELIEF_M: "micro_relief_m", "m", limits::MICRO_RELIEF_M, "Micro-relief of its surfaces";
    }
    /// A surface.
    mod surface = "surface" {
        WIDTH_M: "width_m", "m", limits::SIDE_M, "What uv 1 spans along u", changes(Anew);
        HEIGHT_M: "height_m", "m", limits::SIDE_M, "What uv 1 spans along v", changes(Anew);
        RELIEF_M: "relief_m", "m", limits::RELIEF_M, "Height of white over black of an image";
        MICRO_RELIEF_M: "micro_relief_m", "m", limits::MICRO_RELIEF_M,
            "Rms of the 1/f^α overlay in the octave around 1 mm; missing: its material's";
        OUTER_SCALE_M: "outer_scale_m", "m", limits::OUTER_SCALE_M,
            "Wavelength beyond which the micro-relief is flat; missing: the engine's default";
        MICRO_RELIEF_OCTAVES_DB: "micro_relief_octaves_db", "dB", limits::OCTAVE_DB,
            "Gains of the micro-relief's octaves over its law: up to 12 numbers, coarsest first (31.5 mm, halved each)", vector(12);
        ROUGHNESS: "roughness", "", limits::ROUGHNESS, "Perceptual roughness R; missing: its map's or own source's, else its material's";
        FRICTION: "friction", "", limits::FRICTION, "Coulomb coefficient of the 3-D force; missing: the source's";
        MU_STATIC: "mu_static", "", limits::FRICTION, "With `friction` among `excitation`: coefficient of what sticks",
            or(DEFAULT_STICK_SLIP.mu_static), from("assumed: rosin");
        MU_KINETIC: "mu_kinetic", "", limits::FRICTION,
            "The same of what slides fast, at most `mu_static`", or(DEFAULT_STICK_SLIP.mu_kinetic), from("assumed: rosin");
        SLIP_SPEED_M_S: "slip_speed_m_s", "m/s", limits::SLIP_SPEED_M_S,
            "Speed of slipping that halves the difference of both", or(DEFAULT_STICK_SLIP.slip_speed_m_s), from("assumed: rosin");
        COMPLIANCE_M_N: "compliance_m_n", "m/N", limits::COMPLIANCE_M_N,
            "How far it gives way under each newton, so that a round tip feels the mean of a map under it; 0 = as its source does", or(0.0);
        SCALE: "scale", "", limits::combined::FACTOR, "Factor of the heights", or(1.0);
        STRIKE_POSITION: "strike_position", "", Range::new(0.0, 15.0, "0 to 15"),
            "Which of the body's strike positions contacts here excite", whole(), or(0.0);
    }
    /// Place of a surface in its body.
    mod frame = "surface.frame" {
        ORIGIN_M: "origin_m", "m", limits::PLACE_M, "Where uv (0, 0) lies in the body, each coordinate; missing: its origin",
            vector(3), changes(Anew);
        U_AXIS: "u_axis", "", limits::AXIS, "Where u grows to; only its direction counts; missing: the body's x",
            vector(3), changes(Anew);
        V_AXIS: "v_axis", "", limits::AXIS, "Where v grows to, at a right angle to u; missing: the body's y",
            vector(3), changes(Anew);
    }
    /// A pickup.
    mod pickup = "pickup" {
        AT_M: "at_m", "m", limits::PLACE_M, "Place on a body with shapes, each coordinate in the body's frame", vector(3), changes(Anew);
        DIRECTION: "direction", "", limits::AXIS, "What it reads along; only its direction counts; missing: the outward normal", vector(3), changes(Anew);
        FACTOR: "factor", "", limits::PICKUP_FACTOR,
            "On a body without shapes: how much it moves with every mode, 1 as where that swings most", changes(Anew);
    }
    /// Probe.
    mod probe = "probe" {
        PAD_MASS_KG: "pad_mass_kg", "kg", limits::probe::PAD_MASS_KG, "Mass of the skin that moves with the surface",
            or(contact::PAD_MASS_KG), from("0.1 to 0.25 g in fingertip models"), changes(Opened);
        PAD_STIFFNESS_N_M: "pad_stiffness_n_m", "N/m", limits::probe::PAD_STIFFNESS_N_M,
            "Spring between skin and bone", or(contact::PAD_STIFFNESS_N_M),
            from("1000 in a fingertip model of 2017; 600 to 1430 recalled"), changes(Opened);
        PAD_DAMPING_N_S_M: "pad_damping_n_s_m", "N·s/m", limits::probe::PAD_DAMPING_N_S_M,
            "Damper between skin and bone", or(contact::PAD_DAMPING_N_S_M),
            from("1.0 in the same model; 1.45 to 2.77 recalled"), changes(Opened);
        FINGER_MASS_KG: "finger_mass_kg", "kg", limits::probe::FINGER_MASS_KG, "Mass behind the pad",
            or(contact::FINGER_MASS_KG), from("assumed"), changes(Opened);
        CONTACT_STIFFNESS_N_M: "contact_stiffness_n_m", "N/m", limits::probe::CONTACT_STIFFNESS_N_M,
            "Stiffness of skin on surface", or(contact::CONTACT_STIFFNESS_N_M),
            from("measured here: collisions sound and the contact is contractive; at 1 N"), changes(Opened);
        LEASH_M: "leash_m", "m", limits::probe::LEASH_M, "How far the finger may leave the surface",
            or(contact::LEASH_M), from("chosen"), changes(Opened);
        TIP_RADIUS_M: "tip_radius_m", "m", limits::probe::TIP_RADIUS_M, "Sphere that rides on the surface; 0 = a point",
            or(0.0), changes(Opened);
        FORCE_EXPONENT: "force_exponent", "", limits::probe::FORCE_EXPONENT, "n of the contact's stiffness, k ∝ Fⁿ",
            or(contact::FORCE_EXPONENT), changes(Opened);
        RIDGE_M: "ridge_m", "m", limits::probe::RIDGE_M,
            "Width over which skin averages what an acceleration channel without `lowpass_hz` has; 0 = no skin",
            or(contact::RIDGE_M), from("chosen: a fifth of the 0.5 mm from ridge to ridge of a fingerprint"), changes(Opened);
        TIP_MASS_KG: "tip_mass_kg", "kg", limits::probe::TIP_MASS_KG,
            "Mass of a tip of its own, by which alone it is heard; 0 = none; missing: the preset's", changes(Opened);
        TIP_DAMPING_N_S_M: "tip_damping_n_s_m", "N·s/m", limits::probe::PAD_DAMPING_N_S_M,
            "Resistance of the shaft behind that tip; missing: the preset's, else 15", changes(Opened);
        TIP_CONTACT_RADIUS_M: "tip_contact_radius_m", "m", limits::probe::TIP_CONTACT_RADIUS_M,
            "Radius with which that tip touches; missing: the preset's, else `tip_radius_m`", changes(Opened);
        ASPERITY_RADIUS_M: "asperity_radius_m", "m", limits::probe::TIP_RADIUS_M,
            "Radius of that tip's asperities, which ride the micro-relief; missing: the preset's, else 5e-5", changes(Opened);
        FACE_M: "face_m", "m", limits::probe::FACE_M,
            "Length of a face along the stroke: it rides a map as the ball that bridges it", or(0.0), changes(Opened);
        ASPERITIES: "asperities", "", limits::probe::ASPERITIES,
            "N that share the load: strokes sound as 1/√N; missing: 64 of a face, else the preset's",
            or(contact::FINGER_ASPERITIES), from("of a fingertip, assumed"), changes(Opened);
    }
    /// A haptic channel.
    mod actuator = "actuator" {
        FULL_SCALE: "full_scale", "m (or m/s²)", limits::output::FULL_SCALE,
            "What sample value 1.0 stands for; missing: by the level policy", changes(Opened);
        FELT_FORCE_EXPONENT: "felt_force_exponent", "", limits::output::FELT_FORCE_EXPONENT,
            "n of a finger's displacement ∝ Fⁿ; missing: 1/3 where full_scale is missing, otherwise 0, the pad's own motion", changes(Opened);
        LOWPASS_HZ: "lowpass_hz", "Hz", limits::output::LOWPASS_HZ,
            "Low-pass to what skin feels; missing: 1000 Hz for acceleration, off for displacement", changes(Opened);
        HIGHPASS_HZ: "highpass_hz", "Hz", limits::output::HIGHPASS_HZ,
            "High-pass about the mean surface", or(10.0), changes(Opened);
    }
    /// An audio bus.
    mod audio = "audio" {
        GAIN: "gain", "", limits::output::AUDIO_GAIN, "Linear gain; missing: by the level policy";
        PASCALS_AT_FULL_SCALE: "pascals_at_full_scale", "Pa", limits::output::PASCALS,
            "Sound pressure at 1 m that sample value 1 stands for, of bodies whose modes are in pascals; missing: their numbers count as any other's",
            changes(Opened);
    }
    /// Sand that gives way.
    mod sand = "sand" {
        CELLS: "cells", "", Range::new(16.0, 2048.0, "16 to 2048"), "Cells along u", whole(), or(512.0), changes(Anew);
        DEPTH_M: "depth_m", "m", limits::sand::DEPTH_M, "Depth of the bed", or(0.05), changes(Anew);
        TALUS_DEG: "talus_deg", "degrees", limits::sand::TALUS_DEG, "Steepest slope that stays, dry", or(30.0), changes(Anew);
        STIFFNESS_N: "stiffness_n", "N", limits::sand::STIFFNESS_N, "k_s of the repulse force",
            or(LAW.stiffness_n), from("[Sand] §4.1"), changes(Anew);
        EXPONENT_PER_M: "exponent_per_m", "1/m", limits::sand::EXPONENT_PER_M, "k_c of the repulse force",
            or(LAW.exponent_per_m), from("[Sand] §4.1, its unit of length taken as 0.5 m"), changes(Anew);
        DRAG_S_PER_M: "drag_s_per_m", "s/m", limits::sand::DRAG_S_PER_M, "k_f of the drag",
            or(LAW.drag_s_per_m), from("[Sand] §4.1, its unit of length taken as 0.5 m"), changes(Anew);
        WETNESS: "wetness", "", limits::sand::WETNESS, "0 = dry, 1 = wet", or(LAW.wetness), changes(Anew);
        GRAIN_M: "grain_m", "m", limits::sand::GRAIN_M, "Diameter of a grain", or(LAW.grain_m),
            from("assumed: medium sand"), changes(Anew);
        CAP_N: "cap_n", "N", limits::sand::CAP_N, "Largest force on the tool: what the device gives", or(LAW.cap_n),
            from("[Sand] §4.2, the stronger of its devices"), changes(Anew);
        TOOL_RADIUS_M: "tool_radius_m", "m", limits::sand::TOOL_RADIUS_M, "Radius of what is dragged through it",
            or(0.005), from("a fingertip"), changes(Anew);
    }
    /// A layer of sand below the top.
    mod layer = "sand.layers" {
        FROM_M: "from_m", "m", limits::sand::LAYER_FROM_M, "Depth at which it begins", changes(Anew);
        HARDNESS: "hardness", "", limits::sand::HARDNESS, "Hardness over the top's", changes(Anew);
    }
    /// A stone or a shell in the sand.
    mod buried = "sand.buried" {
        U_M: "u_m", "m", limits::sand::BURIED_AT_M, "Where its top lies along u", changes(Anew);
        V_M: "v_m", "m", limits::sand::BURIED_AT_M, "Where its top lies along v", changes(Anew);
        TOP_M: "top_m", "m", limits::sand::BURIED_TOP_M, "Depth of its top below the untouched sand", changes(Anew);
        HALF_U_M: "half_u_m", "m", limits::sand::BURIED_HALF_M, "Half its width along u", changes(Anew);
        HALF_V_M: "half_v_m", "m", limits::sand::BURIED_HALF_M, "Half its width along v", changes(Anew);
        HEIGHT_M: "height_m", "m", limits::sand::BURIED_HEIGHT_M, "How much lower it is at half its width", changes(Anew);
        HARDNESS: "hardness", "", limits::sand::HARDNESS, "Hardness over the top sand's", changes(Anew);
    }
    /// A tool, by a picture of its underside.
    mod tool = "sand.tool" {
        WIDTH_M: "width_m", "m", Range::new(2e-4, 0.4, "2e-4 to 0.4 m"), "Width of the picture", changes(Anew);
        RELIEF_M: "relief_m", "m", Range::above(0.0, 0.4, "above 0, to 0.4 m"), "Height of white over black in it", changes(Anew);
    }
    /// Solid noise; its defaults are its preset's.
    mod solid = "solid" {
        MAGNITUDE: "magnitude", "", limits::solid::MAGNITUDE, "M of the first module";
        OCTAVES: "octaves", "", limits::solid::OCTAVES, "N of the first module", whole();
        FREQUENCY: "frequency", "cells per unit of length", limits::solid::FREQUENCY, "f of the first module";
        LACUNARITY: "lacunarity", "", limits::solid::LACUNARITY, "Ratio of frequencies from octave to octave";
        PERSISTENCE: "persistence", "", limits::solid::PERSISTENCE, "Ratio of amplitudes from octave to octave";
        TEXTURE_FACTOR_PER_M: "texture_factor_per_m", "1/m", limits::solid::TEXTURE_FACTOR_PER_M, "T";
        AMPLITUDE_M: "amplitude_m", "m", limits::solid::AMPLITUDE_M, "A, height per unit of magnitude; of a grating, of its tops";
        LIMIT_N: "limit_n", "N", limits::solid::LIMIT_N, "L, force per unit of magnitude";
        CAP_N: "cap_n", "N", limits::solid::CAP_N, "Largest texture force";
        VISCOSITY_N_S_M: "viscosity_n_s_m", "N·s/m", limits::solid::VISCOSITY_N_S_M, "b, drag of the medium";
        FLOW_M_S: "flow_m_s", "m/s", limits::solid::FLOW_M_S,
            "Flow of the block along u, v and out of the surface, each; one number is out of it", or(0.0);
        PITCH_M: "pitch_m", "m", grating::PITCH_M, "Period of a grating";
        DUTY: "duty", "", grating::DUTY, "Share of the period that a grating's ridge or dot takes";
        SEED: "seed", "", SEEDS, "Its own seed; missing: the scene's", whole(), changes(Anew);
    }
    /// Brownian relief.
    mod brownian = "brownian" {
        HURST: "hurst", "", limits::brownian::HURST, "Hurst exponent";
        RMS_M: "rms_m", "m", limits::brownian::RMS_M, "Rms height";
        SEED: "seed", "", SEEDS, "Its own seed; missing: the scene's", whole(), changes(Anew);
    }
    /// A cell that repeats along two translations.
    mod lattice = "lattice" {
        T1_M: "t1_m", "m", limits::combined::STEP_M, "First translation, along u and v, each", vector(2), changes(Anew);
        T2_M: "t2_m", "m", limits::combined::STEP_M, "Second translation, another way", vector(2), changes(Anew);
    }
    /// From one source to another.
    mod crossfade = "crossfade" {
        AT_S: "at_s", "s", Range::new(0.0, 1e6, "0 to 1e6 s"), "When it begins";
    }
    /// A line of a contact log, or a report.
    mod event = "event" {
        UV: "uv", "", limits::UV, "Texture coordinates, each", changes(Event);
        VELOCITY_M_S: "velocity_m_s", "m/s", limits::VELOCITY_M_S, "Tangential velocity, each component", changes(Event);
        NORMAL_FORCE_N: "normal_force_n", "N", limits::NORMAL_FORCE_N, "Force that presses; one below zero presses with none", changes(Event);
        AT_M: "at_m", "m", limits::PLACE_M, "Place in the body's frame, each coordinate; instead of uv on a surface with a frame", changes(Event);
        DEPTH_M: "depth_m", "m", limits::TIP_DEPTH_M,
            "How deep the tip stands below the untouched surface, instead of a force, on what gives way", changes(Event);
        SLIP_M_S: "slip_m_s", "m/s", limits::SPEED_M_S,
            "Speed at which what touches slides on the ground there; missing: as fast as it moves; 0 = it rolls", changes(Event);
        ROLL_RADIUS_M: "roll_radius_m", "m", limits::impact::RADIUS_M,
            "Radius of what rolls; missing: of the probe's tip, at least 8 mm", changes(Event);
        CLOSING_M_S: "closing_m_s", "m/s", limits::SPEED_M_S, "Approach speed at landing", or(0.0), changes(Event);
        SPEED_M_S: "speed_m_s", "m/s", limits::SPEED_M_S, "Approach speed of an impact", changes(Event);
        MASS_KG: "mass_kg", "kg", limits::impact::MASS_KG, "Effective mass of the striker", changes(Event);
        RADIUS_M: "radius_m", "m", limits::impact::RADIUS_M, "Its radius where it strikes", changes(Event);
        RESTITUTION: "restitution", "", limits::impact::RESTITUTION, "Rebound over approach speed", or(1.0), changes(Event);
        GAIN: "gain", "", limits::impact::GAIN, "Factor of what is felt and heard", or(1.0), changes(Event);
        IMPORTANCE: "importance", "", limits::impact::IMPORTANCE, "Factor of a contact's priority", or(1.0), changes(Event);
        ACCELERATION_M_S2: "acceleration_m_s2", "m/s²", limits::RIGID_ACCELERATION_M_S2,
            "Acceleration of a body's centre, in its own axes", vector(3), changes(Event);
        GRAVITY_M_S2: "gravity_m_s2", "m/s²", limits::RIGID_ACCELERATION_M_S2, "Gravity, in the same axes", vector(3), changes(Event);
        ANGULAR_VELOCITY_RAD_S: "angular_velocity_rad_s", "rad/s", limits::RIGID_TURN_RAD_S,
            "Angular velocity, in the same axes", vector(3), changes(Event);
        CENTRE_M: "centre_m", "m", limits::PLACE_M, "Centre that the acceleration belongs to, in the body's frame", vector(3), changes(Event);
    }
}
