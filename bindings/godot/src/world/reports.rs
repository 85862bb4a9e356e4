//! Reports of scripts and nodes: contacts and strikes, stamped with the physics tick.

use super::AsperityWorld;
use crate::events::{self, Rolling};
use asperity::ContactEvent;
use godot::prelude::*;

#[godot_api(secondary)]
impl AsperityWorld {
    /// A contact begins: a number of your own, the surface, where (uv), how hard (N), which haptic
    /// channel feels it (-1: none). Report once a physics tick; the time is the tick's. What rolls
    /// tells with every report how fast it slips where it touches, m/s (0: it only rolls), and its
    /// radius, m; left out, it is a stroke. How fast it moves along u and v, m/s, tells whoever
    /// knows it: contact points of a physics engine hop, and without it each hop is a motion. What
    /// touches is the engine's own probe (0) or that of `add_probe`.
    /// False, and an error, where it is refused.
    #[func]
    #[allow(
        clippy::too_many_arguments,
        reason = "a script calls it, and scripts have no structs to name things in"
    )]
    pub(crate) fn report_begin(
        &mut self,
        contact: i64,
        surface: i64,
        uv: Vector2,
        force_n: f64,
        channel: i64,
        #[opt(default = events::NOT_TOLD)] slip_m_s: f64,
        #[opt(default = events::NOT_TOLD)] roll_radius_m: f64,
        #[opt(default = events::NO_VELOCITY)] velocity_m_s: Vector2,
        #[opt(default = 0)] probe: i64,
    ) -> bool {
        self.report("report_begin", || {
            let touching = events::touching(surface, channel, probe)?;
            let rolling = Rolling { slip_m_s, radius_m: roll_radius_m };
            let sample = events::sample(uv, force_n, events::velocity(velocity_m_s), rolling);
            Ok(ContactEvent::begin_with(events::contact(contact)?, touching, sample))
        })
    }

    /// A contact has moved; what rolls, and how fast, is told as in `report_begin`.
    #[func]
    pub(crate) fn report_move(
        &mut self,
        contact: i64,
        uv: Vector2,
        force_n: f64,
        #[opt(default = events::NOT_TOLD)] slip_m_s: f64,
        #[opt(default = events::NOT_TOLD)] roll_radius_m: f64,
        #[opt(default = events::NO_VELOCITY)] velocity_m_s: Vector2,
    ) -> bool {
        self.report("report_move", || {
            let rolling = Rolling { slip_m_s, radius_m: roll_radius_m };
            let sample = events::sample(uv, force_n, events::velocity(velocity_m_s), rolling);
            Ok(ContactEvent::moved(events::contact(contact)?, sample))
        })
    }

    /// A contact has moved at a velocity that is known, m/s along u and v; what rolls tells it as
    /// in `report_begin`.
    #[func]
    fn report_move_at(
        &mut self,
        contact: i64,
        uv: Vector2,
        force_n: f64,
        velocity_m_s: Vector2,
        #[opt(default = events::NOT_TOLD)] slip_m_s: f64,
        #[opt(default = events::NOT_TOLD)] roll_radius_m: f64,
    ) -> bool {
        self.report("report_move_at", || {
            let rolling = Rolling { slip_m_s, radius_m: roll_radius_m };
            let sample = events::sample(uv, force_n, Some(velocity_m_s), rolling);
            Ok(ContactEvent::moved(events::contact(contact)?, sample))
        })
    }

    /// A contact ends.
    #[func]
    pub(crate) fn report_end(&mut self, contact: i64) -> bool {
        self.report("report_end", || Ok(ContactEvent::end(events::contact(contact)?)))
    }

    /// A body is struck: m/s, kg and m of the striker, its material ("": the engine's default), the
    /// haptic channel that feels it (-1: none), and where in its own space, m, for a body whose
    /// modes have shapes.
    #[func]
    #[allow(
        clippy::too_many_arguments,
        reason = "a script calls it, and scripts have no structs to name things in"
    )]
    fn report_impact(
        &mut self,
        body: i64,
        speed_m_s: f64,
        mass_kg: f64,
        radius_m: f64,
        striker: GString,
        channel: i64,
        #[opt(default = events::NO_PLACE)] at_m: Vector3,
    ) -> bool {
        self.report("report_impact", || {
            events::impact(body, speed_m_s, mass_kg, radius_m, &striker.to_string(), channel, at_m)
                .map(ContactEvent::Impact)
        })
    }
}

impl AsperityWorld {
    pub(crate) fn report(
        &mut self,
        what: &str,
        event: impl FnOnce() -> Result<ContactEvent, String>,
    ) -> bool {
        let time_s = self.time_s;
        self.tried(what, |running| {
            running.scene.report(time_s, event()?).map_err(|refused| refused.reason.to_string())
        })
        .is_some()
    }
}
