//! Ports: what leaves the engine, for any one other thread. Reading neither allocates nor waits.

use crate::body::refused;
use crate::entry::{enter, out};
use crate::handles::{AnyPort, PORTS, SCENES, asp_port, asp_scene};
use crate::render::guarded;
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use asperity::live::ports::{Feed, Force, Levels, Of, Pcm, PointSettings, Points, Tone};
use asperity::{ChannelId, ContactId};

/// Samples, exactly as they leave: read with `asp_port_pcm`.
pub const ASP_PORT_PCM: u32 = 1;
/// An amplitude and a frequency some hundred times a second: read with `asp_port_points`.
pub const ASP_PORT_POINTS: u32 = 2;
/// Levels of a heavy and a light motor: read with `asp_port_levels`.
pub const ASP_PORT_LEVELS: u32 = 3;
/// The 3-D force of contacts and hands: read with `asp_port_forces`.
pub const ASP_PORT_FORCES: u32 = 4;

/// A haptic channel.
pub const ASP_FEED_HAPTIC: u32 = 0;
/// An audio bus.
pub const ASP_FEED_BUS: u32 = 1;

/// Settings of a port; `asp_port_config_init` fills it for 0.1 s of haptic channel 0.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_port_config {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// ASP_PORT_…
    pub kind: u32,
    /// Which signal: ASP_FEED_…; forces are of all contacts.
    pub feed: u32,
    /// Which channel or bus, from 0.
    pub index: u32,
    /// Points, levels or forces a second, Hz.
    pub rate_hz: f64,
    /// Time that a late reader still finds, s, 0.001 to 60.
    pub holds_s: f64,
    /// Lowest frequency of points that the device plays, Hz.
    pub low_hz: f64,
    /// The highest.
    pub high_hz: f64,
    /// Frequency of points: 0 = it is drawn, so that every band has its share; 1 = the strongest.
    pub strongest: u32,
    /// 0.
    pub reserved: u32,
}

sized!(asp_port_config, |zeroed| Self {
    kind: ASP_PORT_PCM,
    rate_hz: 100.0,
    holds_s: 0.1,
    low_hz: 55.0,
    high_hz: 200.0,
    ..zeroed
});

/// A vibration between two ticks.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_point {
    /// It begins tick / rate_hz seconds after the port was opened.
    pub tick: u64,
    /// Peak of the sine, in the unit of the samples.
    pub amplitude: f64,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Peak of what is below 100 Hz.
    pub low: f64,
    /// Peak of what is above.
    pub high: f64,
}

/// A force at one tick.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_force {
    /// It is tick / rate_hz seconds after sample 0.
    pub tick: u64,
    /// The contact's name, or the haptic channel.
    pub of: u64,
    /// 1 = of a hand: the sum of all contacts that its haptic channel feels; 0 = of one contact.
    pub is_hand: u64,
    /// Along u, v and out of the surface, N.
    pub force_n: [f64; 3],
}

fn refuse(what: String, right: &str) -> Failure {
    Failure::new(ASP_BAD_ARGUMENT, format!("{what}; {right}"))
}

impl asp_port_config {
    fn feed(&self) -> Result<Feed, Failure> {
        let channel = || {
            u16::try_from(self.index).map(ChannelId).map_err(|_| {
                refuse(format!("index: {} is refused", self.index), "must be a haptic channel from 0")
            })
        };
        match self.feed {
            ASP_FEED_HAPTIC => Ok(Feed::Haptic(channel()?)),
            ASP_FEED_BUS => Ok(Feed::Bus(self.index as usize)),
            other => {
                Err(refuse(format!("feed: {other} is refused"), "must be ASP_FEED_HAPTIC or ASP_FEED_BUS"))
            }
        }
    }
}

/// Fills a port's config with its size and the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_port_config_init(config: *mut asp_port_config) {
    sized::init(config);
}

/// Opens a port; it shows what leaves from the next block on, until it is freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_open_port(
    scene: *mut asp_scene,
    config: *const asp_port_config,
    port: *mut *mut asp_port,
) -> i32 {
    enter(|| {
        let (config, port) = (sized::read(config, "config")?, out(port, "port")?);
        *port = std::ptr::null_mut();
        let mut half = SCENES.hold(scene as usize)?;
        let asp_port_config { rate_hz, holds_s, low_hz, high_hz, .. } = config;
        let scene = &mut half.scene;
        let opened = match config.kind {
            ASP_PORT_PCM => scene.open_port(Pcm { from: config.feed()?, holds_s }).map(AnyPort::Pcm),
            ASP_PORT_POINTS => {
                let tone = if config.strongest == 0 { Tone::Drawn } else { Tone::Strongest };
                let settings = PointSettings { rate_hz, band_hz: [low_hz, high_hz], tone };
                scene.open_port(Points { from: config.feed()?, settings, holds_s }).map(AnyPort::Points)
            }
            ASP_PORT_LEVELS => {
                scene.open_port(Levels { from: config.feed()?, rate_hz, holds_s }).map(AnyPort::Levels)
            }
            ASP_PORT_FORCES => scene.open_port(Force { rate_hz, holds_s }).map(AnyPort::Forces),
            other => {
                return Err(refuse(format!("kind: {other} is refused"), "must be one of ASP_PORT_…"));
            }
        };
        *port = PORTS.insert(opened.map_err(|error| refused(&error))?)? as *mut asp_port;
        Ok(())
    })
}

/// Reads with a port; what cannot be read is none.
fn reading<T: Default>(port: *mut asp_port, read: impl FnOnce(&mut AnyPort) -> T) -> T {
    let mut result = T::default();
    guarded(|| {
        if let Ok(mut held) = PORTS.try_hold(port as usize) {
            result = read(&mut held);
        }
    });
    result
}

/// Writes what a port gives, one after another, until it gives no more or the room is full.
fn fill<T>(to: *mut T, count: u32, mut next: impl FnMut() -> Option<T>) -> u32 {
    if to.is_null() || !to.is_aligned() {
        return 0;
    }
    for index in 0..count {
        let Some(value) = next() else { return index };
        // SAFETY: not null and aligned, and below the count that the caller has given.
        unsafe { to.add(index as usize).write(value) };
    }
    count
}

/// The oldest samples that are left, at most `count`; how many there were.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_port_pcm(port: *mut asp_port, samples: *mut f32, count: u32) -> u32 {
    reading(port, |port| {
        let AnyPort::Pcm(port) = port else { return 0 };
        let count = u64::from(count).min(port.waiting()) as usize;
        if samples.is_null() || !samples.is_aligned() {
            return 0;
        }
        // SAFETY: not null and aligned, and not more than the caller has given.
        let samples = unsafe { std::slice::from_raw_parts_mut(samples, count) };
        port.read(samples) as u32
    })
}

/// The oldest points that are left, at most `count`; how many there were.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_port_points(port: *mut asp_port, points: *mut asp_point, count: u32) -> u32 {
    reading(port, |port| {
        let AnyPort::Points(port) = port else { return 0 };
        fill(points, count, || {
            let point = port.read()?;
            Some(asp_point {
                tick: point.tick,
                amplitude: point.amplitude,
                frequency_hz: point.frequency_hz,
                low: point.low,
                high: point.high,
            })
        })
    })
}

/// The newest levels of a heavy and a light motor, as peaks of sines in the unit of the samples; 0
/// where there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_port_levels(port: *mut asp_port, heavy: *mut f64, light: *mut f64) {
    let levels: [f64; 2] = reading(port, |port| match port {
        AnyPort::Levels(port) => port.newest(),
        _ => [0.0; 2],
    });
    for (place, level) in [heavy, light].into_iter().zip(levels) {
        fill(place, 1, || Some(level));
    }
}

/// The oldest forces that are left, at most `count`; how many there were.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_port_forces(port: *mut asp_port, forces: *mut asp_force, count: u32) -> u32 {
    reading(port, |port| {
        let AnyPort::Forces(port) = port else { return 0 };
        fill(forces, count, || {
            let row = port.read()?;
            let (of, is_hand) = match row.of {
                Of::Contact(ContactId(name)) => (name, 0),
                Of::Hand(ChannelId(channel)) => (u64::from(channel), 1),
            };
            Some(asp_force { tick: row.tick, of, is_hand, force_n: row.force_n })
        })
    })
}

/// Number that was overwritten before it was read: samples, points, levels or forces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_port_lost(port: *mut asp_port) -> u64 {
    reading(port, |port| match port {
        AnyPort::Pcm(port) => port.lost(),
        AnyPort::Points(port) => port.lost(),
        AnyPort::Levels(port) => port.lost(),
        AnyPort::Forces(port) => port.lost(),
    })
}
