//! Ten fingers through the null sink in blocks of 64 frames at 44.1 kHz, beside a bare loop with
//! the same deadlines: what is late, and what the machine itself loses.
//!
//! ```sh
//! cargo run --release --example null_sink [SECONDS]     # default 60
//! ```

use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::live::null_sink::{NullSink, Pace};
use asperity::surface::height_map::HeightMap;
use asperity::{
    ChannelId, ClockMode, Config, ContactEvent, ContactId, ContactSample, Extent, ModalModel, Mode, Surface,
};
use std::error::Error;
use std::time::{Duration, Instant};

const FINGERS: u64 = 10;
const BLOCK_FRAMES: usize = 64;
const RATE_HZ: f64 = 44_100.0;
const SIDE_M: f64 = 0.14;

fn main() -> Result<(), Box<dyn Error>> {
    let seconds: f64 = std::env::args().nth(1).map_or(Ok(60.0), |text| text.parse())?;
    let actuators = vec![asperity::ActuatorSettings::default(); FINGERS as usize];
    let config = Config { clock: ClockMode::LIVE, sample_rate_hz: RATE_HZ, actuators, ..Config::default() };
    let asperity::Engine { mut scene, renderer, .. } = config.build()?;
    let mode = |i: u32| Mode {
        frequency_hz: 200.0 * 1.05f64.powi(i as i32),
        decay_per_s: 10.0,
        amplitude: 0.02,
        phase_rad: 0.0,
    };
    let body = scene.add_body(ModalModel::new((0..64).map(mode).collect(), 0.01)?)?;
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let plate = Surface::new(HeightMap::flat(extent, 0.9)?, SIDE_M, SIDE_M)?;
    let plate = scene.add_surface(plate.body(body))?;

    let period = Duration::from_secs_f64(BLOCK_FRAMES as f64 / RATE_HZ);
    let bare = std::thread::spawn(move || Pace::measure(period, Duration::from_secs_f64(seconds), |_| ()));
    let map = ChannelMap::stereo_then_haptics(FINGERS as usize);
    let sink = NullSink::start(Interleaver::new(renderer, map), BLOCK_FRAMES)?;
    let began = Instant::now();
    let mut started = false;
    while began.elapsed().as_secs_f64() < seconds {
        let time_s = began.elapsed().as_secs_f64();
        for finger in 0..FINGERS {
            let speed_m_s = 0.05 + 0.02 * finger as f64;
            let sample = ContactSample {
                uv: [speed_m_s * time_s / SIDE_M, 0.05 + 0.09 * finger as f64],
                velocity_m_s: Some([speed_m_s, 0.0]),
                normal_force_n: 0.6,
                closing_m_s: 0.0,
                ..ContactSample::default()
            };
            let event = if started {
                ContactEvent::moved(ContactId(finger), sample)
            } else {
                ContactEvent::begin(ContactId(finger), plate, ChannelId(finger as u16), sample)
            };
            scene.report(time_s, event)?;
        }
        started = true;
        std::thread::sleep(Duration::from_micros(16_667));
    }
    let stats = scene.stats();
    let (_, pace) = sink.stop().ok_or("the null sink died")?;
    let bare = bare.join().map_err(|_| "the bare loop died")?;
    let message = |name: &str, pace: &Pace| {
        println!(
            "{name}: {} blocks, {} late, mean load {:.1} %, longest {:.0} us of {:.0}",
            pace.blocks,
            pace.late,
            100.0 * pace.load,
            1e6 * pace.longest_s,
            1e6 * period.as_secs_f64()
        );
    };
    message("bare loop", &bare);
    message("ten fingers", &pace);
    println!(
        "{} contacts, {} events, {} lapsed, {} dropped",
        stats.contacts, stats.events, stats.lapsed, stats.dropped
    );
    Ok(())
}
