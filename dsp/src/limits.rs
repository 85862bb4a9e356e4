//! Accepted ranges, in one list: kernels, the engine's own checks and the reader of scene files
//! quote it, and `docs/formats/scene.md` prints it.
//!
//! A value outside is refused where it enters, by name; one inside is rendered as it is.

mod range;

pub use range::Range;

/// Largest force pressing a contact onto a surface, N: a wedged box in a physics engine reaches
/// some thousands for a step.
pub const MAX_NORMAL_FORCE_N: f64 = 1e4;
/// Force of a report: one below zero presses with none.
pub const NORMAL_FORCE_N: Range =
    Range::new(-MAX_NORMAL_FORCE_N, MAX_NORMAL_FORCE_N, "finite and at most 1e4 N");
/// Farthest that the relief of a surface may lie from zero, m.
pub const MAX_RELIEF_M: f64 = 10.0;
/// Height of white over black of an image.
pub const RELIEF_M: Range = Range::new(0.0, MAX_RELIEF_M, "0 to 10 m");
/// Largest distance of a whole surface's relief from zero.
pub const REACH_M: Range = Range::new(0.0, MAX_RELIEF_M, "a surface within ±10 m of zero");
/// Farthest that a height may lie from zero, m: the relief, what its interpolation overshoots by,
/// and the overlay. Beyond, the guard of the contact holds the last good height.
pub const MAX_HEIGHT_M: f64 = 2.0 * MAX_RELIEF_M;
/// Fastest tangential, closing or striking speed, m/s.
pub const MAX_SPEED_M_S: f64 = 100.0;
/// Tangential velocity of a report, each component.
pub const VELOCITY_M_S: Range = Range::new(-MAX_SPEED_M_S, MAX_SPEED_M_S, "finite and within ±100 m/s");
/// Speed of a landing or an impact.
pub const SPEED_M_S: Range = Range::new(0.0, MAX_SPEED_M_S, "0 to 100 m/s");
/// Widest texture coordinate, in tiles from the origin: a `f64` position is still exact to 1e-9 m.
pub const MAX_UV: f64 = 1e6;
/// Texture coordinate of a report.
pub const UV: Range = Range::new(-MAX_UV, MAX_UV, "finite and within ±1e6");
/// Largest rms of the micro-relief in the octave about 1 mm, m.
pub const MAX_MICRO_RELIEF_M: f64 = 0.01;
/// Micro-relief of a surface; 0 is none.
pub const MICRO_RELIEF_M: Range = Range::new(0.0, MAX_MICRO_RELIEF_M, "0 to 0.01 m, 0 = none");
/// Wavelength beyond which the micro-relief is flat.
pub const OUTER_SCALE_M: Range = Range::new(1e-5, 1.0, "1e-5 to 1 m");
/// Gain of an octave of the micro-relief over its law.
pub const OCTAVE_DB: Range = Range::new(-60.0, 40.0, "-60 to 40 dB");
/// Side of a surface.
pub const SIDE_M: Range = Range::new(1e-6, 1e3, "1e-6 to 1e3 m");
/// Each coordinate of a place in a body.
pub const PLACE_M: Range = Range::new(-1e3, 1e3, "-1000 to 1000 m");
/// Depth of a tip below a surface; below 0 above it.
pub const TIP_DEPTH_M: Range = Range::new(-1e3, 1.0, "-1000 to 1 m");
/// Share of a pickup in the motion of every mode of a body without shapes.
pub const PICKUP_FACTOR: Range = Range::new(-1.0, 1.0, "-1 to 1");
/// Each component of the acceleration of a body as a whole.
pub const RIGID_ACCELERATION_M_S2: Range = Range::new(-1e6, 1e6, "finite and within ±1e6 m/s²");
/// Each component of the angular velocity of a body.
pub const RIGID_TURN_RAD_S: Range = Range::new(-1e4, 1e4, "finite and within ±1e4 rad/s");
/// Length of a direction, of which only the direction counts.
pub const AXIS: Range = Range::new(1e-6, 1e6, "1e-6 to 1e6 long");
/// Roughness of a surface.
pub const ROUGHNESS: Range = Range::new(0.0, 1.0, "0 to 1");
/// Compliance of a surface under a newton; 0 = hard.
pub const COMPLIANCE_M_N: Range = Range::new(0.0, 0.1, "0 to 0.1 m/N");
/// Friction coefficient.
pub const FRICTION: Range = Range::new(0.0, 10.0, "0 to 10");
/// Speed of slipping that halves the difference of both friction coefficients.
pub const SLIP_SPEED_M_S: Range = Range::new(1e-9, 10.0, "1e-9 to 10 m/s");
/// Game time of a report with an exact clock, s.
pub const TIME_S: Range = Range::new(0.0, 1e9, "finite, 0 to 1e9 s");
/// Game seconds a second of audio.
pub const TIME_SCALE: Range = Range::new(0.01, 100.0, "0.01 to 100");
/// Game seconds a second of audio where pitch bends with it.
pub const BENT_TIME_SCALE: Range = Range::new(0.1, 2.0, "0.1 to 2 with bend_pitch");
/// Game time of a report with a live clock, s.
pub const LIVE_TIME_S: Range = Range::new(-1e9, 1e9, "finite, within ±1e9 s");

/// Probe.
pub mod probe {
    use super::Range;

    /// m_s.
    pub const PAD_MASS_KG: Range = Range::new(1e-6, 1.0, "1e-6 to 1 kg");
    /// k_s.
    pub const PAD_STIFFNESS_N_M: Range = Range::new(1e-3, 1e7, "1e-3 to 1e7 N/m");
    /// b_s.
    pub const PAD_DAMPING_N_S_M: Range = Range::new(0.0, 1e4, "0 to 1e4 N·s/m");
    /// m_f.
    pub const FINGER_MASS_KG: Range = Range::new(1e-5, 100.0, "1e-5 to 100 kg");
    /// k_m.
    pub const CONTACT_STIFFNESS_N_M: Range = Range::new(1.0, 1e9, "1 to 1e9 N/m");
    /// Longest gap that the finger's own motion may open.
    pub const LEASH_M: Range = Range::new(1e-6, 0.05, "1e-6 to 0.05 m");
    /// Radius of the sphere that rides on the surface; 0 is a point.
    pub const TIP_RADIUS_M: Range = Range::new(0.0, 0.1, "0 to 0.1 m, 0 = a point");
    /// Width over which skin averages; 0 is no skin.
    pub const RIDGE_M: Range = Range::new(0.0, 0.01, "0 to 0.01 m, 0 = no skin");
    /// Mass of a tip of its own; 0 is none.
    pub const TIP_MASS_KG: Range = Range::new(0.0, 1.0, "0 to 1 kg, 0 = no tip of its own");
    /// Radius of contact of a tip of its own.
    pub const TIP_CONTACT_RADIUS_M: Range = Range::new(1e-6, 0.1, "1e-6 to 0.1 m");
    /// Length of a face along the stroke; 0 is none.
    pub const FACE_M: Range = Range::new(0.0, 10.0, "0 to 10 m, 0 = no face");
    /// Asperities that share the load.
    pub const ASPERITIES: Range = Range::new(1.0, 1e6, "1 to 1e6");
    /// n of k_m ∝ Fⁿ.
    pub const FORCE_EXPONENT: Range = Range::new(0.0, 1.0, "0 to 1");
}

/// Sensor of a pickup.
pub mod sensor {
    use super::Range;

    /// f₀ of what the sensor is mounted with.
    pub const RESONANCE_HZ: Range = Range::new(1.0, 1e6, "1 to 1e6 Hz");
    /// Q of that resonance.
    pub const QUALITY: Range = Range::new(0.1, 1e4, "0.1 to 1e4");
    /// Lower end of the band; 0 is none.
    pub const BAND_HZ: Range = Range::new(0.0, 1e6, "0 to 1e6 Hz, the lower end first");
    /// Noise density.
    pub const NOISE_M_S2_RTHZ: Range = Range::new(0.0, 100.0, "0 to 100 m/s²/√Hz");
    /// Reading at which it clips.
    pub const CLIP_M_S2: Range = Range::new(1e-6, 1e9, "1e-6 to 1e9 m/s²");
    /// Gain.
    pub const GAIN_V_PER_M_S2: Range = Range::new(1e-9, 1e9, "1e-9 to 1e9 V/(m/s²)");
    /// Bits of the converter; 0 is none.
    pub const ADC_BITS: Range = Range::new(0.0, 32.0, "0 to 32 bits, 0 = none");
}

/// Striker.
pub mod impact {
    use super::Range;

    /// Its mass.
    pub const MASS_KG: Range = Range::new(1e-9, 1e4, "1e-9 to 1e4 kg");
    /// Its radius where it strikes.
    pub const RADIUS_M: Range = Range::new(1e-6, 10.0, "1e-6 to 10 m");
    /// Share of the speed with which it leaves.
    pub const RESTITUTION: Range = Range::new(0.0, 1.0, "0 to 1");
    /// Factor of what is felt and heard of an impact or a contact.
    pub const GAIN: Range = Range::new(0.0, 1e3, "0 to 1000");
    /// Least time between equally strong impacts on a body.
    pub const LEAST_TIME_S: Range = Range::new(0.0, 60.0, "0 to 60 s");
    /// Spread of equal impacts on a body.
    pub const VARIATION: Range = Range::new(0.0, 1.0, "0 to 1");
    /// Factor of a contact's priority.
    pub const IMPORTANCE: Range = Range::new(0.0, 1e6, "0 to 1e6");
}

/// Material.
pub mod material {
    use super::Range;

    /// Young's modulus.
    pub const YOUNG_PA: Range = Range::new(1e3, 1e13, "1e3 to 1e13 Pa");
    /// Poisson ratio.
    pub const POISSON: Range = Range::new(0.0, 0.5, "0 to 0.5");
    /// Mass of a body.
    pub const MASS_KG: Range = Range::new(1e-6, 1e6, "1e-6 to 1e6 kg");
    /// Density.
    pub const DENSITY_KG_M3: Range = Range::new(1.0, 1e5, "1 to 1e5 kg/m³");
    /// Damping that is the same at every frequency.
    pub const ALPHA_PER_S: Range = Range::new(0.0, 1e6, "0 to 1e6 1/s");
    /// Loss factor.
    pub const ETA: Range = Range::new(0.0, 10.0, "0 to 10");
    /// Viscous damping.
    pub const BETA_S: Range = Range::new(0.0, 1.0, "0 to 1 s");
    /// Longest side of a stock shape.
    pub const SIZE_M: Range = Range::new(1e-3, 100.0, "1e-3 to 100 m");
    /// Gain of a body's residual.
    pub const RESIDUAL: Range = Range::new(0.0, 1e3, "0 to 1e3 (a gain)");
}

/// Rates and outputs of a whole engine.
pub mod output {
    use super::Range;

    /// Sample rate of everything that leaves.
    pub const SAMPLE_RATE_HZ: Range = Range::new(8e3, 384e3, "8000 to 384000 Hz");
    /// Sound pressure at full scale.
    pub const PASCALS: Range = Range::above(0.0, 1e6, "above 0, to 1e6 Pa");
    /// Gain of the audio.
    pub const AUDIO_GAIN: Range = Range::new(0.0, 1e6, "0 to 1e6");
    /// The user's gain of a haptic channel.
    pub const HAPTIC_GAIN: Range = Range::new(0.0, 10.0, "0 to 10");
    /// Metres, or m/s², at sample value 1.
    pub const FULL_SCALE: Range = Range::new(1e-12, 1e12, "1e-12 to 1e12 m (or m/s²)");
    /// n of a finger's displacement ∝ Fⁿ; 0 is the pad's own motion.
    pub const FELT_FORCE_EXPONENT: Range = Range::new(0.0, 1.0, "0 to 1, 0 = the pad's own motion");
    /// Cutoff of an actuator's low-pass; 0 is off.
    pub const LOWPASS_HZ: Range = Range::new(0.0, 2e4, "0 to 20000 Hz, 0 = off");
    /// High-pass about the mean surface; at low sample rates, below 0.49 of the rate as well.
    pub const HIGHPASS_HZ: Range = Range::new(0.0, 1e3, "0 to 1000 Hz, 0 = off");
    /// Span of its signal that a port holds for a late reader.
    pub const PORT_HOLDS_S: Range = Range::new(1e-3, 60.0, "1e-3 to 60 s");
    /// Rows a second of a force port.
    pub const FORCE_RATE_HZ: Range = Range::new(1.0, 2e4, "1 to 20000 Hz");
    /// Time that a contact goes on without a report.
    pub const CONTACT_TIMEOUT_S: Range = Range::new(0.01, 3600.0, "0.01 to 3600 s");
}

/// Sand that gives way.
pub mod sand {
    use super::Range;

    /// Depth of the bed.
    pub const DEPTH_M: Range = Range::above(0.0, 0.45, "above 0, to 0.45 m");
    /// Side of a bed.
    pub const SIDE_M: Range = Range::new(1e-3, 100.0, "1e-3 to 100 m");
    /// Steepest slope that stays.
    pub const TALUS_DEG: Range = Range::new(1.0, 80.0, "1 to 80 degrees");
    /// k_s.
    pub const STIFFNESS_N: Range = Range::new(0.01, 1e6, "0.01 to 1e6 N");
    /// k_c.
    pub const EXPONENT_PER_M: Range = Range::new(1e-3, 1e4, "1e-3 to 1e4 1/m");
    /// k_v.
    pub const DRAG_S_PER_M: Range = Range::new(0.0, 1e4, "0 to 1e4 s/m");
    /// Wetness.
    pub const WETNESS: Range = Range::new(0.0, 1.0, "0 to 1");
    /// Diameter of a grain.
    pub const GRAIN_M: Range = Range::new(1e-5, 0.01, "1e-5 to 0.01 m");
    /// Largest force.
    pub const CAP_N: Range = Range::above(0.0, 1e3, "above 0, to 1000 N");
    /// Bearing of a tool over a sphere of 5 mm.
    pub const BEARING: Range = Range::above(0.0, 1e6, "above 0, to 1e6");
    /// Hardness of a layer over that of the top.
    pub const HARDNESS: Range = Range::new(0.01, 1e3, "0.01 to 1000");
    /// Beginning of a layer.
    pub const LAYER_FROM_M: Range =
        Range::above(0.0, 1.0, "above 0, to 1 m, and deeper than the layer before it");
    /// Place of a buried object along one side.
    pub const BURIED_AT_M: Range = Range::new(0.0, 100.0, "0 to 100 m");
    /// Depth of its top.
    pub const BURIED_TOP_M: Range = Range::new(0.0, 0.45, "0 to 0.45 m");
    /// Half its width.
    pub const BURIED_HALF_M: Range = Range::new(1e-4, 1.0, "1e-4 to 1 m");
    /// Drop there.
    pub const BURIED_HEIGHT_M: Range = Range::new(1e-5, 0.45, "1e-5 to 0.45 m");
    /// Radius of the tool.
    pub const TOOL_RADIUS_M: Range = Range::new(1e-4, 0.2, "1e-4 to 0.2 m");
    /// Texel of a tool's map.
    pub const TOOL_TEXEL_M: Range = Range::new(1e-6, 0.01, "1e-6 to 0.01 m");
    /// Cells along one side.
    pub const CELLS: Range = Range::new(4.0, 4096.0, "4 to 4096 cells");
    /// Width of a cell.
    pub const CELL_M: Range = Range::new(1e-6, 0.1, "1e-6 to 0.1 m");
}

/// Solid noise.
pub mod solid {
    use super::Range;

    /// M.
    pub const MAGNITUDE: Range = Range::new(0.0, 1e3, "0 to 1e3");
    /// N.
    pub const OCTAVES: Range = Range::new(1.0, 16.0, "1 to 16");
    /// f, cells per unit of length.
    pub const FREQUENCY: Range = Range::above(0.0, 1e6, "above 0, to 1e6");
    /// Ratio of frequencies from octave to octave.
    pub const LACUNARITY: Range = Range::new(1.0, 8.0, "1 to 8");
    /// Ratio of amplitudes from octave to octave.
    pub const PERSISTENCE: Range = Range::new(0.0, 1.0, "0 to 1");
    /// T.
    pub const TEXTURE_FACTOR_PER_M: Range = Range::above(0.0, 1e6, "above 0, to 1e6 1/m");
    /// A.
    pub const AMPLITUDE_M: Range = Range::new(-0.1, 0.1, "within ±0.1 m");
    /// L.
    pub const LIMIT_N: Range = Range::new(0.0, 1.0, "0 to 1 N");
    /// Largest texture force.
    pub const CAP_N: Range = Range::new(0.0, 100.0, "0 to 100 N");
    /// b.
    pub const VISCOSITY_N_S_M: Range = Range::new(0.0, 1e3, "0 to 1000 N·s/m");
    /// Speed of a block that flows.
    pub const FLOW_M_S: Range = Range::new(-10.0, 10.0, "within ±10 m/s");
}

/// Brownian relief.
pub mod brownian {
    use super::Range;

    /// Hurst exponent.
    pub const HURST: Range = Range::new(0.01, 0.99, "0.01 to 0.99");
    /// Rms height.
    pub const RMS_M: Range = Range::new(0.0, 0.1, "0 to 0.1 m");
}

/// Sources made of others.
pub mod combined {
    use super::Range;

    /// Factor of a scaled source.
    pub const FACTOR: Range = Range::new(-1e3, 1e3, "within ±1000");
    /// Each component of a lattice's translation, and its length.
    pub const STEP_M: Range = Range::new(-1e3, 1e3, "-1000 to 1000 m");
    /// Length of a lattice's translation.
    pub const STEP_LENGTH_M: Range = Range::new(1e-6, 1e3, "1e-6 to 1e3 m long");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_holds_its_ends_and_nothing_else() {
        assert!(probe::PAD_MASS_KG.holds(1e-6) && probe::PAD_MASS_KG.holds(1.0));
        assert!(!sand::DEPTH_M.holds(0.0) && sand::DEPTH_M.holds(0.45));
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1.1, 0.9e-6] {
            assert!(!probe::PAD_MASS_KG.holds(bad), "{bad}");
        }
        let error = probe::PAD_MASS_KG.check("pad_mass_kg", 2.0).unwrap_err();
        assert_eq!((error.field, error.expected), ("pad_mass_kg", "1e-6 to 1 kg"));
    }

    /// The words of a range are what a user reads: the numbers in them are the range's own.
    #[test]
    fn the_words_of_every_range_say_its_numbers() {
        let all = [
            RELIEF_M,
            SPEED_M_S,
            MICRO_RELIEF_M,
            OUTER_SCALE_M,
            OCTAVE_DB,
            SIDE_M,
            TIME_SCALE,
            BENT_TIME_SCALE,
            PLACE_M,
            AXIS,
            ROUGHNESS,
            FRICTION,
            COMPLIANCE_M_N,
            TIP_DEPTH_M,
            probe::PAD_MASS_KG,
            probe::PAD_STIFFNESS_N_M,
            probe::PAD_DAMPING_N_S_M,
            probe::FINGER_MASS_KG,
            probe::CONTACT_STIFFNESS_N_M,
            probe::LEASH_M,
            probe::TIP_RADIUS_M,
            probe::TIP_MASS_KG,
            probe::TIP_CONTACT_RADIUS_M,
            probe::FACE_M,
            probe::ASPERITIES,
            probe::FORCE_EXPONENT,
            impact::MASS_KG,
            impact::RADIUS_M,
            impact::RESTITUTION,
            impact::GAIN,
            impact::IMPORTANCE,
            material::YOUNG_PA,
            material::POISSON,
            material::DENSITY_KG_M3,
            material::RESIDUAL,
            output::SAMPLE_RATE_HZ,
            output::PASCALS,
            output::AUDIO_GAIN,
            output::HAPTIC_GAIN,
            output::FULL_SCALE,
            output::HIGHPASS_HZ,
            output::LOWPASS_HZ,
            output::CONTACT_TIMEOUT_S,
            output::PORT_HOLDS_S,
            output::FORCE_RATE_HZ,
            sand::DEPTH_M,
            sand::SIDE_M,
            sand::TALUS_DEG,
            sand::STIFFNESS_N,
            sand::EXPONENT_PER_M,
            sand::DRAG_S_PER_M,
            sand::WETNESS,
            sand::GRAIN_M,
            sand::HARDNESS,
            sand::TOOL_RADIUS_M,
            sand::TOOL_TEXEL_M,
            sand::CELLS,
            sand::CELL_M,
            solid::MAGNITUDE,
            solid::OCTAVES,
            solid::FREQUENCY,
            solid::LACUNARITY,
            solid::PERSISTENCE,
            solid::TEXTURE_FACTOR_PER_M,
            solid::LIMIT_N,
            solid::CAP_N,
            solid::VISCOSITY_N_S_M,
            brownian::HURST,
            brownian::RMS_M,
            combined::STEP_M,
            combined::STEP_LENGTH_M,
        ];
        for range in all {
            let mut numbers = range.words.split([' ', ',']).filter_map(|word| word.parse::<f64>().ok());
            assert_eq!(numbers.next(), Some(range.low), "{range:?}");
            assert_eq!(numbers.next(), Some(range.high), "{range:?}");
            assert_eq!(range.above, range.words.starts_with("above"), "{range:?}");
        }
    }
}
