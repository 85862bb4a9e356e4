//! `AsperityHaptics`: a haptic channel on the controller of a headset and on the motors of a
//! joypad.

use crate::world::AsperityWorld;
use asperity::live::ports::{Point, PointsPort};
use godot::classes::{INode, Input, XrServer};
use godot::prelude::*;

/// Amplitude below which nothing is felt.
const FLOOR: f64 = 1.0 / 256.0;
/// Time between two calls, s.
const CALL_S: f64 = 0.03;
/// Length of each, s: until the next ones have come.
const LASTS_S: f64 = 0.08;

/// Lets a haptic channel of the tree's world be felt: as pulses of an action of the primary XR
/// interface (`OpenXRInterface`), and on the two motors of a joypad.
#[derive(GodotClass)]
#[class(init, base = Node)]
pub struct AsperityHaptics {
    /// Haptic channel.
    #[export]
    channel: i64,
    /// Sample value that counts as the strongest vibration.
    #[export]
    #[init(val = 1.0)]
    full_scale: f64,
    /// Tracker that vibrates, "right_hand" for example; empty: none.
    #[export]
    tracker: StringName,
    /// Haptic action of the action map.
    #[export]
    #[init(val = "haptic".into())]
    action: GString,
    /// Joypad whose motors turn; -1: none.
    #[export]
    #[init(val = -1)]
    joypad: i32,
    port: Option<PointsPort>,
    /// Which of the world's engines the port belongs to.
    build: u64,
    waited_s: f64,
    /// Strongest of the points since the last call.
    strongest: Option<Point>,
    turns: bool,
    base: Base<Node>,
}

#[godot_api]
impl INode for AsperityHaptics {
    fn process(&mut self, delta: f64) {
        let Some(mut world) = AsperityWorld::of(&self.base().get_tree()) else { return };
        let builds = world.bind().builds();
        if self.build != builds {
            (self.build, self.port) = (builds, world.bind_mut().points(self.channel));
        }
        let Some(port) = &mut self.port else { return };
        for point in std::iter::from_fn(|| port.read()) {
            let strongest = self.strongest.get_or_insert(point);
            let (low, high) = (strongest.low.max(point.low), strongest.high.max(point.high));
            let tone = if point.amplitude > strongest.amplitude { point } else { *strongest };
            *strongest = Point { low, high, ..tone };
        }
        self.waited_s += delta;
        if self.waited_s >= CALL_S
            && let Some(point) = self.strongest.take()
        {
            self.waited_s = 0.0;
            self.call(&point);
        }
    }

    fn exit_tree(&mut self) {
        (self.port, self.build) = (None, 0);
        self.stop();
    }
}

impl AsperityHaptics {
    fn call(&mut self, point: &Point) {
        let [amplitude, low, high] =
            [point.amplitude, point.low, point.high].map(|x| (x / self.full_scale).clamp(0.0, 1.0));
        if amplitude.max(low).max(high) < FLOOR {
            return self.stop();
        }
        self.turns = true;
        if !self.tracker.is_empty()
            && let Some(mut headset) = XrServer::singleton().get_primary_interface()
        {
            let (action, tracker) = (&self.action, &self.tracker);
            headset.trigger_haptic_pulse(action, tracker, point.frequency_hz, amplitude, LASTS_S, 0.0);
        }
        if self.joypad >= 0 {
            let mut input = Input::singleton();
            let [weak, strong] = [high, low].map(|level| level as f32);
            input.start_joy_vibration_ex(self.joypad, weak, strong).duration(LASTS_S as f32).done();
        }
    }

    /// A pulse of a headset ends by itself.
    fn stop(&mut self) {
        if std::mem::take(&mut self.turns) && self.joypad >= 0 {
            Input::singleton().stop_joy_vibration(self.joypad);
        }
    }
}
