//! Random scenes at the ends of what is accepted: probe, rate, surface, force, speed, reports.
//!
//! A scene passes if everything it gives is finite and no contact force is higher than physics
//! explains. With the pressed force F, the masses m and the ground's own acceleration a (second
//! difference of the heights that the contact was given, at the contact's own rate), that is 10 F
//! where m a < F, and 3 (F + m a) elsewhere.
//!
//! That leaves out what comes down again: a mass that left the ground lands at some speed v on the
//! spring k of the contact, F = v √(k m), however long ago the ground threw it. A pad of 1 kg that
//! 1 mN presses on 1e9 N/m does so with rights, so that each scene has a second figure: the same
//! with that landing added.
#![allow(dead_code)]

use asperity::limits;
use asperity::{
    ActuatorSettings, ChannelId, Config, ContactBlock, ContactEvent, ContactId, ContactSample, Elastic,
    Excitation, Extent, HeardTip, Integrator, PathMode, Probe, Surface, Tap, Wrap,
};
use asperity_dsp::rng::Rng;
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;

/// What became of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Rendered.
    Rendered(Force),
    /// Refused, with the message.
    Refused(String),
    /// Not finite.
    NotFinite,
}

/// The hardest contact force of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// Over what pressed force and ground explain.
    pub above: f64,
    /// The same with the hardest landing added to them.
    pub above_landing: f64,
    /// Blows that were counted: more than thirty times what pressed.
    pub blows: u64,
    /// Whether the fingertip preset touched.
    pub fingertip: bool,
    /// What touched.
    pub probe: Probe,
    /// What pressed, N.
    pub pressed_n: f64,
    /// Ground's own acceleration, m/s².
    pub acceleration_m_s2: f64,
}

/// An end of a range most of the time, something between at others.
fn end(rng: &mut Rng, low: f64, high: f64) -> f64 {
    match rng.next_u32() % 5 {
        0 | 1 => low,
        2 | 3 => high,
        _ => low * (high / low).powf(rng.uniform()),
    }
}

/// An end of an accepted range; 0 is replaced by next to nothing.
fn end_of(rng: &mut Rng, range: limits::Range) -> f64 {
    end(rng, if range.low > 0.0 { range.low } else { 1e-3 }, range.high)
}

fn one_of<T: Copy>(rng: &mut Rng, of: &[T]) -> T {
    of[rng.next_u32() as usize % of.len()]
}

struct Hardest {
    masses_kg: f64,
    /// The contact's own rate.
    rate_hz: f64,
    heights_m: [f64; 2],
    rows: u32,
    pressed_n: f64,
    acceleration_m_s2: f64,
    contact_n: f64,
    closing_m_s: f64,
    /// How deep the pad was in the ground in the last two rows, m; negative above it.
    depths_m: [f64; 2],
    finite: bool,
}

impl Hardest {
    /// Ground is judged over the whole scene: a contact is led in over ground
    /// that lies before its first row, and a blow comes after its cause.
    fn force(&self, probe: &Probe, blows: u64) -> Force {
        let inertia_n = self.masses_kg * self.acceleration_m_s2;
        let allowed_n = if inertia_n < self.pressed_n {
            10.0 * self.pressed_n
        } else {
            3.0 * (self.pressed_n + inertia_n)
        };
        let landing_n = self.closing_m_s * (probe.contact_stiffness_n_m * self.masses_kg).sqrt();
        Force {
            above: self.contact_n / allowed_n.max(1e-9),
            above_landing: self.contact_n / (allowed_n + landing_n).max(1e-9),
            blows,
            fingertip: *probe == Probe::default(),
            probe: *probe,
            pressed_n: self.pressed_n,
            acceleration_m_s2: self.acceleration_m_s2,
        }
    }
}

impl Tap for Hardest {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        for row in block.contact_samples {
            let [before, last] = self.heights_m;
            let bend = (row.height_m - 2.0 * last + before) * self.rate_hz * self.rate_hz;
            self.heights_m = [last, row.height_m];
            self.rows += 1;
            if self.rows > 2 {
                self.acceleration_m_s2 = self.acceleration_m_s2.max(bend.abs());
            }
            self.pressed_n = self.pressed_n.max(row.normal_force_n);
            self.contact_n = self.contact_n.max(row.contact_force_n);
            // A surface whose sound is of the force alone tells no onsets: then by how fast the
            // last two rows came closer.
            let [two_ago_m, last_m] = self.depths_m;
            let falling_m_s = if last_m < 0.0 { (last_m - two_ago_m) * self.rate_hz } else { 0.0 };
            let closing_m_s = row.onset.map_or(falling_m_s, |onset| onset.closing_m_s);
            self.closing_m_s = self.closing_m_s.max(closing_m_s);
            self.depths_m = [last_m, row.height_m - row.pad_m];
            self.finite &=
                row.contact_force_n.is_finite() && row.pad_m.is_finite() && row.finger_m.is_finite();
        }
    }
}

fn surface(rng: &mut Rng) -> Result<Surface, String> {
    let (width_m, height_m) = (end(rng, 1e-3, limits::SIDE_M.high), end(rng, 1e-3, limits::SIDE_M.high));
    let relief_m = end(rng, 1e-9, 1.5 * limits::MAX_RELIEF_M);
    let n = one_of(rng, &[1usize, 2, 16, 64]);
    let kind = rng.next_u32() % 3;
    let values = (0..n * n)
        .map(|i| match kind {
            0 => (i % n) as f64 / n as f64,
            1 => 0.5 + 0.5 * (std::f64::consts::TAU * (i % n) as f64 / n as f64).sin(),
            _ => rng.uniform(),
        })
        .collect();
    let wrap = one_of(rng, &[Wrap::Repeat, Wrap::Clamp, Wrap::Mirror]);
    let extent = Extent { width_m, height_m, relief_m };
    let map =
        HeightMap::new(&Raster { width: n, height: n, values }, extent, wrap).map_err(|e| e.to_string())?;
    let rough = one_of(rng, &[0.0, 0.5, 1.0]);
    let map = map.with_roughness(rough).map_err(|e| e.to_string())?;
    let surface = Surface::new(map, width_m, height_m).map_err(|e| e.to_string())?;
    let micro_relief_m = one_of(rng, &[0.0, 2e-6, limits::MAX_MICRO_RELIEF_M]);
    Ok(surface.micro_relief_m(micro_relief_m).excitation(one_of(rng, &[Excitation::BOTH, Excitation::FORCE])))
}

/// Renders scene `seed`, a tenth of a second of it.
pub fn outcome(seed: u64) -> Outcome {
    let mut rng = Rng::new(seed);
    let rng = &mut rng;
    let probe = Probe {
        pad_mass_kg: end_of(rng, limits::probe::PAD_MASS_KG),
        pad_stiffness_n_m: end_of(rng, limits::probe::PAD_STIFFNESS_N_M),
        pad_damping_n_s_m: end_of(rng, limits::probe::PAD_DAMPING_N_S_M),
        finger_mass_kg: end_of(rng, limits::probe::FINGER_MASS_KG),
        contact_stiffness_n_m: end_of(rng, limits::probe::CONTACT_STIFFNESS_N_M),
        leash_m: end_of(rng, limits::probe::LEASH_M),
        // The stiffness is drawn over its whole range; the figure of a landing is that of a fixed
        // one.
        tip_radius_m: 0.0,
        ridge_m: 0.0,
        force_exponent: 0.0,
        tip: one_of(rng, &[true, false]).then(|| HeardTip {
            mass_kg: end_of(rng, limits::probe::PAD_MASS_KG),
            damping_n_s_m: end_of(rng, limits::probe::PAD_DAMPING_N_S_M),
            material: Elastic {
                young_pa: end_of(rng, limits::material::YOUNG_PA),
                poisson: end_of(rng, limits::material::POISSON),
            },
            contact_radius_m: end_of(rng, limits::probe::TIP_CONTACT_RADIUS_M),
            asperity_radius_m: end_of(rng, limits::probe::TIP_RADIUS_M),
        }),
        face_m: end_of(rng, limits::probe::FACE_M),
        asperities: end_of(rng, limits::probe::ASPERITIES),
    };
    let probe = if rng.next_u32().is_multiple_of(2) { Probe::default() } else { probe };
    let integrator =
        one_of(rng, &[Integrator::ExactEvent, Integrator::SemiImplicitEuler, Integrator::EnergyConserving]);
    let rate_hz = one_of(rng, &[8e3, 22_050.0, 44_100.0, 192e3]);
    let config = Config {
        sample_rate_hz: rate_hz,
        probe,
        integrator,
        path: one_of(rng, &[PathMode::Extrapolate, PathMode::Hold, PathMode::Hermite]),
        actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
        max_contacts: 2,
        max_surfaces: 1,
        max_bodies: 1,
        ..Config::default()
    };
    let inner_rate_hz = config.inner_rate_hz();
    let asperity::Engine { mut scene, mut renderer, .. } = match config.build() {
        Ok(halves) => halves,
        Err(error) => return Outcome::Refused(error.to_string()),
    };
    let surface = match surface(rng).and_then(|s| scene.add_surface(s).map_err(|e| e.to_string())) {
        Ok(id) => id,
        Err(message) => return Outcome::Refused(message),
    };
    let speed_m_s = end(rng, 1e-6, limits::MAX_SPEED_M_S);
    let force_n = end(rng, 1e-3, limits::MAX_NORMAL_FORCE_N);
    let mut hardest = Hardest {
        masses_kg: probe.pad_mass_kg + probe.finger_mass_kg,
        rate_hz: inner_rate_hz,
        heights_m: [0.0; 2],
        rows: 0,
        pressed_n: 0.0,
        acceleration_m_s2: 0.0,
        contact_n: 0.0,
        closing_m_s: 0.0,
        depths_m: [0.0; 2],
        finite: true,
    };
    let (mut haptic, mut audio) = (vec![0.0; 256], vec![0.0; 256]);
    let mut finite = true;
    for step in 0..7 {
        let t = f64::from(step) / 60.0;
        let sample = ContactSample {
            uv: [0.3 + speed_m_s * t, 0.3],
            velocity_m_s: Some([speed_m_s, 0.0]),
            normal_force_n: force_n,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if step == 0 {
            ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        if let Err(error) = scene.report(t, event) {
            return Outcome::Refused(error.to_string());
        }
        while (renderer.position() as f64) < (t + 1.0 / 60.0) * rate_hz {
            renderer.render_tapped(&mut [&mut haptic], &mut [&mut audio], &mut hardest);
            finite &= haptic.iter().chain(&audio).all(|x| x.is_finite());
        }
    }
    if finite && hardest.finite {
        Outcome::Rendered(hardest.force(&probe, scene.stats().blows))
    } else {
        Outcome::NotFinite
    }
}
