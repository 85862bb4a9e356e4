//! Events: what a physics step reports, one flat struct for all kinds.
//!
//! Numbers that a game does not know are NAN ("not told"), ids 0, the actuator −1.

use crate::material::{self, ASP_MATERIAL_CUSTOM};
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use asperity::{
    BodyId, ChannelId, ContactEvent, ContactId, ContactSample, Emphasis, Impact, Material, ProbeId,
    SurfaceId, Touching,
};
use std::mem::offset_of;

/// A contact lands on a surface.
pub const ASP_BEGIN: u32 = 1;
/// A contact goes on.
pub const ASP_MOVE: u32 = 2;
/// A contact lifts off.
pub const ASP_END: u32 = 3;
/// A rigid striker hits a body.
pub const ASP_IMPACT: u32 = 4;

/// One report; `asp_event_init` fills it with "not told", `asp_begin`, `asp_move`, `asp_end` and
/// `asp_impact` with the usual.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_event {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// ASP_BEGIN, ASP_MOVE, ASP_END or ASP_IMPACT.
    pub kind: u32,
    /// begin, move, end: the contact's name, chosen by the program, unique among those that touch.
    pub contact: u64,
    /// begin: what is touched.
    pub surface: u64,
    /// impact: what rings.
    pub body: u64,
    /// impact: the striker's own body, which rings too; 0 = none.
    pub other: u64,
    /// begin, impact: the body in the hand, which rings too; 0 = none.
    pub holder: u64,
    /// begin, impact: what touches; 0 = the engine's own probe.
    pub probe: u64,
    /// begin, impact: the haptic channel that feels it; −1 = nobody.
    pub actuator: i32,
    /// impact: what the striker is made of, ASP_MATERIAL_…; ASP_MATERIAL_CUSTOM = as the three
    /// striker_ numbers say.
    pub striker: u32,
    /// impact: which of the body's strike positions, from 0.
    pub position: u32,
    /// 0.
    pub reserved: u32,
    /// begin, move: texture coordinates; 1 spans the surface's width and height.
    pub uv: [f64; 2],
    /// begin, move: along u and v, m/s; NAN = estimated from uv.
    pub velocity_m_s: [f64; 2],
    /// begin, move: force onto the surface, N.
    pub normal_force_n: f64,
    /// begin: approach speed at landing, m/s.
    pub closing_m_s: f64,
    /// begin, move: how deep the tip stands below the untouched surface, m, where that gives way;
    /// NAN = the force counts.
    pub depth_m: f64,
    /// Place in the body's frame, m; NAN = not told.
    pub at_m: [f64; 3],
    /// impact: along what it is hit, in the body's frame; NAN = the inward normal.
    pub direction: [f64; 3],
    /// Gain of what is felt and heard, 0 to 1000; NAN = 1, of a move: as it was.
    pub gain: f64,
    /// begin, move: factor of the priority; NAN = 1, of a move: as it was.
    pub importance: f64,
    /// impact: approach speed, m/s.
    pub speed_m_s: f64,
    /// impact: the striker's effective mass, kg.
    pub mass_kg: f64,
    /// impact: its radius where it strikes, m.
    pub radius_m: f64,
    /// impact: rebound over approach speed, 0 to 1.
    pub restitution: f64,
    /// Young's modulus of a striker of ASP_MATERIAL_CUSTOM, Pa.
    pub striker_young_pa: f64,
    /// Its Poisson ratio.
    pub striker_poisson: f64,
    /// Its density, kg/m³.
    pub striker_density_kg_m3: f64,
    /// begin, move: speed at which what touches slides on the ground there, m/s; 0 = it rolls, NAN
    /// = as fast as it moves: a stroke. Each report tells it anew. (Since 0.1.1.)
    pub slip_m_s: f64,
    /// begin, move: radius of what rolls, m; NAN = the probe's tip, at least 8 mm. (Since 0.1.1.)
    pub roll_radius_m: f64,
}

const NOT_TOLD: f64 = f64::NAN;

sized!(asp_event, [offset_of!(asp_event, slip_m_s)], |zeroed| Self {
    actuator: -1,
    uv: [NOT_TOLD; 2],
    velocity_m_s: [NOT_TOLD; 2],
    normal_force_n: NOT_TOLD,
    depth_m: NOT_TOLD,
    at_m: [NOT_TOLD; 3],
    direction: [NOT_TOLD; 3],
    gain: NOT_TOLD,
    importance: NOT_TOLD,
    speed_m_s: 1.0,
    mass_kg: 0.004,
    radius_m: 0.005,
    restitution: 1.0,
    striker_young_pa: NOT_TOLD,
    striker_poisson: NOT_TOLD,
    striker_density_kg_m3: NOT_TOLD,
    slip_m_s: NOT_TOLD,
    roll_radius_m: NOT_TOLD,
    ..zeroed
});

fn unless_nan(number: f64) -> Option<f64> {
    Some(number).filter(|number| !number.is_nan())
}

/// Numbers that are told together; that only some of them are is for the engine to refuse.
fn all_told<const N: usize>(numbers: [f64; N]) -> Option<[f64; N]> {
    Some(numbers).filter(|numbers| !numbers.iter().all(|number| number.is_nan()))
}

impl asp_event {
    /// As the engine takes it.
    pub(crate) fn engines(&self) -> Result<ContactEvent, Failure> {
        let contact = ContactId(self.contact);
        Ok(match self.kind {
            ASP_BEGIN => ContactEvent::begin_with(contact, self.touching()?, self.sample()),
            ASP_MOVE => {
                let emphasis =
                    Emphasis { gain: unless_nan(self.gain), importance: unless_nan(self.importance) };
                ContactEvent::moved_with(contact, self.sample(), emphasis)
            }
            ASP_END => ContactEvent::end(contact),
            ASP_IMPACT => ContactEvent::Impact(self.impact()?),
            other => {
                let right = "must be ASP_BEGIN, ASP_MOVE, ASP_END or ASP_IMPACT";
                return Err(Failure::new(ASP_BAD_ARGUMENT, format!("kind: {other} is refused; {right}")));
            }
        })
    }

    fn sample(&self) -> ContactSample {
        let depth_m = unless_nan(self.depth_m);
        ContactSample {
            uv: self.uv,
            velocity_m_s: all_told(self.velocity_m_s),
            // Where a depth is told it counts, and the force beside it is nothing.
            normal_force_n: if depth_m.is_some() && self.normal_force_n.is_nan() {
                0.0
            } else {
                self.normal_force_n
            },
            closing_m_s: self.closing_m_s,
            at_m: all_told(self.at_m),
            depth_m,
            slip_m_s: unless_nan(self.slip_m_s),
            roll_radius_m: unless_nan(self.roll_radius_m),
        }
    }

    fn touching(&self) -> Result<Touching, Failure> {
        let mut touching = Touching::on(SurfaceId::from_bits(self.surface));
        (touching.actuator, touching.probe, touching.holder) =
            (self.actuator()?, self.probe(), self.holder());
        Ok(touching
            .gain(unless_nan(self.gain).unwrap_or(1.0))
            .importance(unless_nan(self.importance).unwrap_or(1.0)))
    }

    fn impact(&self) -> Result<Impact, Failure> {
        Ok(Impact {
            other: Some(self.other).filter(|id| *id != 0).map(BodyId::from_bits),
            speed_m_s: self.speed_m_s,
            mass_kg: self.mass_kg,
            radius_m: self.radius_m,
            striker: self.striker()?,
            restitution: self.restitution,
            position: self.position as usize,
            at_m: all_told(self.at_m),
            direction: all_told(self.direction),
            actuator: self.actuator()?,
            holder: self.holder(),
            probe: self.probe(),
            gain: unless_nan(self.gain).unwrap_or(1.0),
            ..Impact::on(BodyId::from_bits(self.body))
        })
    }

    fn striker(&self) -> Result<Material, Failure> {
        if self.striker == ASP_MATERIAL_CUSTOM {
            let density_kg_m3 = self.striker_density_kg_m3;
            return Ok(Material::new(self.striker_young_pa, self.striker_poisson, density_kg_m3));
        }
        Ok(material::material(self.striker)?.unwrap_or(Material::STEEL))
    }

    fn actuator(&self) -> Result<Option<ChannelId>, Failure> {
        match self.actuator {
            -1 => Ok(None),
            channel => u16::try_from(channel).map(|channel| Some(ChannelId(channel))).map_err(|_| {
                let right = "must be a haptic channel from 0, or -1 for none";
                Failure::new(ASP_BAD_ARGUMENT, format!("actuator: {channel} is refused; {right}"))
            }),
        }
    }

    fn holder(&self) -> Option<BodyId> {
        Some(self.holder).filter(|id| *id != 0).map(BodyId::from_bits)
    }

    fn probe(&self) -> Option<ProbeId> {
        Some(self.probe).filter(|id| *id != 0).map(ProbeId::from_bits)
    }

    /// The struct that says what an event of the engine says.
    pub(crate) fn of(event: &ContactEvent) -> Self {
        let mut own: Self = sized::Sized32::initial();
        match event {
            ContactEvent::Begin { contact, touching, sample } => {
                (own.kind, own.contact, own.surface) = (ASP_BEGIN, contact.0, touching.surface.to_bits());
                own.hand(touching.actuator, touching.holder, touching.probe);
                (own.gain, own.importance) = (touching.gain, touching.importance);
                own.take_sample(sample);
            }
            ContactEvent::Moved { contact, sample, emphasis } => {
                (own.kind, own.contact) = (ASP_MOVE, contact.0);
                own.gain = emphasis.gain.unwrap_or(NOT_TOLD);
                own.importance = emphasis.importance.unwrap_or(NOT_TOLD);
                own.take_sample(sample);
            }
            ContactEvent::End { contact } => (own.kind, own.contact) = (ASP_END, contact.0),
            ContactEvent::Impact(impact) => own.strike(impact),
            // Refused by those who call this.
            ContactEvent::Motion { body, .. } => own.body = body.to_bits(),
        }
        own
    }

    fn hand(&mut self, actuator: Option<ChannelId>, holder: Option<BodyId>, probe: Option<ProbeId>) {
        self.actuator = actuator.map_or(-1, |actuator| i32::from(actuator.0));
        self.holder = holder.map_or(0, BodyId::to_bits);
        self.probe = probe.map_or(0, ProbeId::to_bits);
    }

    fn take_sample(&mut self, sample: &ContactSample) {
        self.uv = sample.uv;
        self.velocity_m_s = sample.velocity_m_s.unwrap_or([NOT_TOLD; 2]);
        self.normal_force_n = sample.normal_force_n;
        self.closing_m_s = sample.closing_m_s;
        self.at_m = sample.at_m.unwrap_or([NOT_TOLD; 3]);
        self.depth_m = sample.depth_m.unwrap_or(NOT_TOLD);
        self.slip_m_s = sample.slip_m_s.unwrap_or(NOT_TOLD);
        self.roll_radius_m = sample.roll_radius_m.unwrap_or(NOT_TOLD);
    }

    fn strike(&mut self, impact: &Impact) {
        (self.kind, self.body) = (ASP_IMPACT, impact.body.to_bits());
        self.hand(impact.actuator, impact.holder, impact.probe);
        self.other = impact.other.map_or(0, BodyId::to_bits);
        (self.speed_m_s, self.mass_kg) = (impact.speed_m_s, impact.mass_kg);
        (self.radius_m, self.restitution) = (impact.radius_m, impact.restitution);
        self.position = impact.position as u32;
        self.at_m = impact.at_m.unwrap_or([NOT_TOLD; 3]);
        self.direction = impact.direction.unwrap_or([NOT_TOLD; 3]);
        self.gain = impact.gain;
        let Material { young_pa, poisson, density_kg_m3, .. } = impact.striker;
        self.striker = ASP_MATERIAL_CUSTOM;
        (self.striker_young_pa, self.striker_poisson) = (young_pa, poisson);
        self.striker_density_kg_m3 = density_kg_m3;
    }
}

/// Fills an event of `size` bytes, sizeof(asp_event), with that size and "not told": a loss-free
/// blow of 4 g of steel at 1 m/s where it is an impact. A size that never was fills nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_init_event(event: *mut asp_event, size: u32) {
    sized::init_as(event, size);
}

/// Fills the shorter event of programs that were compiled with 0.1.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_event_init(event: *mut asp_event) {
    sized::init_as(event, <asp_event as sized::Sized32>::SHIPPED[0]);
}
