//! Events: one row of numbers, for all kinds. What is not told is NaN.

use crate::exchange::done;
use crate::session::{self, Session};
use asperity::{ChannelId, ContactEvent, ContactId, ContactSample, Emphasis, Impact, Material, Touching};
use std::cell::RefCell;

/// Numbers of a row.
pub const EVENT_NUMBERS: usize = 32;
/// Game time, s.
pub const TIME_S: usize = 0;
/// Kind of event: 1 begin, 2 move, 3 end, 4 impact.
pub const KIND: usize = 1;
/// The contact's name, a whole number.
pub const CONTACT: usize = 2;
/// Number of the surface that is touched, of the body that is hit.
pub const THING: usize = 3;
/// Haptic channel.
pub const ACTUATOR: usize = 4;
/// Number of the probe.
pub const PROBE: usize = 5;
/// Number of the body that holds it.
pub const HOLDER: usize = 6;
/// Texture coordinates, two.
pub const UV: usize = 7;
/// Tangential velocity, m/s, two.
pub const VELOCITY_M_S: usize = 9;
/// Force onto the surface, N.
pub const NORMAL_FORCE_N: usize = 11;
/// Approach speed at landing, m/s.
pub const CLOSING_M_S: usize = 12;
/// Depth of the tip below the untouched surface, m.
pub const DEPTH_M: usize = 13;
/// Place in the body, m, three.
pub const AT_M: usize = 14;
/// Along what a body is hit, three.
pub const DIRECTION: usize = 17;
/// Gain of what is felt and heard.
pub const GAIN: usize = 20;
/// Factor of its priority.
pub const IMPORTANCE: usize = 21;
/// Approach speed of an impact, m/s.
pub const SPEED_M_S: usize = 22;
/// The striker's mass, kg.
pub const MASS_KG: usize = 23;
/// Its radius, m.
pub const RADIUS_M: usize = 24;
/// Rebound over approach speed.
pub const RESTITUTION: usize = 25;
/// Number of its material.
pub const STRIKER: usize = 26;
/// Strike position.
pub const POSITION: usize = 27;
/// Number of the striker's own body.
pub const OTHER: usize = 28;
/// Speed at which what touches slides on the ground, m/s; 0: it rolls.
pub const SLIP_M_S: usize = 29;
/// Radius of what rolls, m.
pub const ROLL_RADIUS_M: usize = 30;

thread_local! {
    static EVENT: RefCell<[f64; EVENT_NUMBERS]> = const { RefCell::new([f64::NAN; EVENT_NUMBERS]) };
}

/// Address of the row, to be filled before a report.
#[unsafe(no_mangle)]
pub extern "C" fn asp_event() -> *mut f64 {
    EVENT.with_borrow_mut(|event| event.as_mut_ptr())
}

/// Reports the row.
#[unsafe(no_mangle)]
pub extern "C" fn asp_report() -> u32 {
    let row = Row(EVENT.with_borrow(|event| *event));
    done(session::with(|session| {
        let event = row.event(session)?;
        session.scene.report(row.0[TIME_S], event).map_err(|refused| refused.reason.to_string())
    }))
}

struct Row([f64; EVENT_NUMBERS]);

impl Row {
    fn written(&self, at: usize) -> Option<f64> {
        Some(self.0[at]).filter(|number| !number.is_nan())
    }

    /// Numbers that are told together.
    fn several<const N: usize>(&self, at: usize) -> Option<[f64; N]> {
        let numbers = std::array::from_fn(|index| self.0[at + index]);
        Some(numbers).filter(|numbers| numbers.iter().any(|number| !number.is_nan()))
    }

    /// The thing of a list that a number names.
    fn thing<Id: Copy>(&self, at: usize, kind: &str, things: &[Id]) -> Result<Option<Id>, String> {
        let Some(number) = self.written(at) else { return Ok(None) };
        // A number beyond the list, or none, is no index of it.
        let thing = things.get(number as usize).filter(|_| number >= 0.0 && number.fract() == 0.0);
        thing
            .copied()
            .map(Some)
            .ok_or_else(|| format!("{kind}: {number} is unknown; must be one of {}", things.len()))
    }

    fn needed<Id: Copy>(&self, at: usize, kind: &str, things: &[Id]) -> Result<Id, String> {
        self.thing(at, kind, things)?.ok_or_else(|| format!("{kind}: is missing; must be given"))
    }

    fn contact(&self) -> Result<ContactId, String> {
        let contact = self.0[CONTACT];
        if (0.0..=9_007_199_254_740_991.0).contains(&contact) && contact.fract() == 0.0 {
            return Ok(ContactId(contact as u64));
        }
        Err(format!("contact: {contact} is refused; must be a whole number from 0"))
    }

    fn actuator(&self) -> Result<Option<ChannelId>, String> {
        self.written(ACTUATOR)
            .map(|channel| match channel {
                0.0..=65_535.0 => Ok(ChannelId(channel as u16)),
                _ => Err(format!("actuator: {channel} is refused; must be a haptic channel from 0")),
            })
            .transpose()
    }

    fn event(&self, session: &Session) -> Result<ContactEvent, String> {
        Ok(match self.0[KIND] {
            1.0 => ContactEvent::begin_with(self.contact()?, self.touching(session)?, self.sample()),
            2.0 => {
                let emphasis = Emphasis { gain: self.written(GAIN), importance: self.written(IMPORTANCE) };
                ContactEvent::moved_with(self.contact()?, self.sample(), emphasis)
            }
            3.0 => ContactEvent::end(self.contact()?),
            4.0 => ContactEvent::Impact(self.impact(session)?),
            other => {
                return Err(format!(
                    "event: {other} is refused; must be begin, move, end or impact (1 to 4)"
                ));
            }
        })
    }

    fn sample(&self) -> ContactSample {
        let (depth_m, force_n) = (self.written(DEPTH_M), self.0[NORMAL_FORCE_N]);
        ContactSample {
            uv: [self.0[UV], self.0[UV + 1]],
            velocity_m_s: self.several(VELOCITY_M_S),
            // Where a depth is told it counts, and the force beside it is nothing.
            normal_force_n: if depth_m.is_some() && force_n.is_nan() { 0.0 } else { force_n },
            closing_m_s: self.written(CLOSING_M_S).unwrap_or(0.0),
            at_m: self.several(AT_M),
            depth_m,
            slip_m_s: self.written(SLIP_M_S),
            roll_radius_m: self.written(ROLL_RADIUS_M),
        }
    }

    fn touching(&self, session: &Session) -> Result<Touching, String> {
        let mut touching = Touching::on(self.needed(THING, "surface", &session.surfaces)?);
        touching.actuator = self.actuator()?;
        touching.probe = self.thing(PROBE, "probe", &session.probes)?;
        touching.holder = self.thing(HOLDER, "holder", &session.bodies)?;
        Ok(touching
            .gain(self.written(GAIN).unwrap_or(1.0))
            .importance(self.written(IMPORTANCE).unwrap_or(1.0)))
    }

    fn impact(&self, session: &Session) -> Result<Impact, String> {
        let mut impact = Impact::on(self.needed(THING, "body", &session.bodies)?);
        impact.speed_m_s = self.written(SPEED_M_S).unwrap_or(impact.speed_m_s);
        impact.mass_kg = self.written(MASS_KG).unwrap_or(impact.mass_kg);
        impact.radius_m = self.written(RADIUS_M).unwrap_or(impact.radius_m);
        impact.restitution = self.written(RESTITUTION).unwrap_or(impact.restitution);
        let materials: Vec<Material> = Material::PRESETS.iter().map(|preset| preset.material).collect();
        impact.striker = self.thing(STRIKER, "striker", &materials)?.unwrap_or(impact.striker);
        impact.position = self.written(POSITION).unwrap_or(0.0) as usize;
        impact.other = self.thing(OTHER, "other", &session.bodies)?;
        (impact.at_m, impact.direction) = (self.several(AT_M), self.several(DIRECTION));
        impact.actuator = self.actuator()?;
        impact.probe = self.thing(PROBE, "probe", &session.probes)?;
        impact.holder = self.thing(HOLDER, "holder", &session.bodies)?;
        impact.gain = self.written(GAIN).unwrap_or(1.0);
        Ok(impact)
    }
}
