//! Events: numbers of a script as events of the engine.

use asperity::{BodyId, ChannelId, ContactSample, Impact, Material, ProbeId, SurfaceId, Touching};
use godot::prelude::*;

/// Number of a contact, from a script's to the engine's.
pub(crate) fn contact(number: i64) -> Result<asperity::ContactId, String> {
    u64::try_from(number)
        .map(asperity::ContactId)
        .map_err(|_| format!("contact: {number} is refused; must be 0 or more"))
}

/// A haptic channel; below 0: none.
pub(crate) fn channel(number: i64) -> Result<Option<ChannelId>, String> {
    match number {
        ..0 => Ok(None),
        0..=65_535 => Ok(Some(ChannelId(number as u16))),
        _ => Err(format!("channel: {number} is refused; must be a haptic channel from 0, or -1")),
    }
}

/// Number that a script leaves out.
pub(crate) const NOT_TOLD: f64 = f64::NAN;

/// A place or a velocity that a script leaves out.
pub(crate) const NO_PLACE: Vector3 = Vector3::new(f32::NAN, f32::NAN, f32::NAN);
/// Velocity that a script leaves out.
pub(crate) const NO_VELOCITY: Vector2 = Vector2::new(f32::NAN, f32::NAN);

/// A velocity, where it is told.
pub(crate) fn velocity(told: Vector2) -> Option<Vector2> {
    Some(told).filter(|v| !(v.x.is_nan() && v.y.is_nan()))
}

/// Slip of a contact, m/s, and the radius of what rolls, m; not told: it is a
/// stroke, with the probe's tip.
#[derive(Clone, Copy)]
pub(crate) struct Rolling {
    pub slip_m_s: f64,
    pub radius_m: f64,
}

impl Rolling {
    /// A stroke.
    pub(crate) const NONE: Self = Self { slip_m_s: NOT_TOLD, radius_m: NOT_TOLD };
}

/// A contact at a place, pressed by so many newtons; how fast it moves, the engine finds out unless
/// it is told.
pub(crate) fn sample(
    uv: Vector2,
    force_n: f64,
    velocity_m_s: Option<Vector2>,
    rolling: Rolling,
) -> ContactSample {
    let told = |number: f64| Some(number).filter(|number| !number.is_nan());
    ContactSample {
        uv: [f64::from(uv.x), f64::from(uv.y)],
        velocity_m_s: velocity_m_s.map(|v| [f64::from(v.x), f64::from(v.y)]),
        normal_force_n: force_n,
        slip_m_s: told(rolling.slip_m_s),
        roll_radius_m: told(rolling.radius_m),
        ..ContactSample::default()
    }
}

/// Touch of a surface by a channel.
pub(crate) fn touching(surface: i64, number: i64, probe: i64) -> Result<Touching, String> {
    let mut touching = Touching::on(SurfaceId::from_bits(surface as u64));
    touching.actuator = channel(number)?;
    touching.probe = (probe != 0).then(|| ProbeId::from_bits(probe as u64));
    Ok(touching)
}

/// A blow.
pub(crate) fn impact(
    body: i64,
    speed_m_s: f64,
    mass_kg: f64,
    radius_m: f64,
    striker: &str,
    number: i64,
    at_m: Vector3,
) -> Result<Impact, String> {
    let mut impact = Impact::on(BodyId::from_bits(body as u64));
    (impact.speed_m_s, impact.mass_kg, impact.radius_m) = (speed_m_s, mass_kg, radius_m);
    if !striker.is_empty() {
        let preset = Material::PRESETS.iter().find(|preset| preset.name == striker);
        impact.striker = preset.map(|preset| preset.material).ok_or_else(|| {
            let names: Vec<_> = Material::PRESETS.iter().map(|preset| preset.name).collect();
            format!("striker: \"{striker}\" is unknown; must be one of {}", names.join(", "))
        })?;
    }
    impact.actuator = channel(number)?;
    let at_m = [at_m.x, at_m.y, at_m.z];
    impact.at_m = Some(at_m.map(f64::from)).filter(|_| !at_m.iter().all(|x| x.is_nan()));
    Ok(impact)
}
