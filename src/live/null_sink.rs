//! A silent device: a thread with absolute deadlines that renders in real time.
//!
//! It paces tests and machines without a sound card, and shows how many blocks were late. A bare
//! loop with the same deadlines ([`Pace::measure`]) shows what the machine itself loses.

use crate::live::channel_map::Interleaver;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Counters of a paced loop.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pace {
    /// Blocks rendered.
    pub blocks: u64,
    /// Blocks that were finished after their deadline, one block after they were due.
    pub late: u64,
    /// Mean share of the period spent rendering.
    pub load: f64,
    /// Longest time one block took, s.
    pub longest_s: f64,
}

/// A running null sink; dropping it stops the thread.
#[derive(Debug)]
pub struct NullSink {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<(Interleaver, Pace)>>,
}

impl NullSink {
    /// Starts to render blocks of `block_frames` in real time.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn start(mut device: Interleaver, block_frames: usize) -> std::io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let channels = device.map().width();
        let mut out = vec![0.0; block_frames * channels];
        let period = Duration::from_secs_f64(block_frames as f64 / device.renderer().sample_rate_hz());
        let thread = std::thread::Builder::new().name("asperity null sink".into()).spawn(move || {
            let running = || !stopped.load(Ordering::Relaxed);
            let pace = Pace::measure_while(period, running, |load| {
                device.fill(&mut out, channels);
                device.renderer().report_load(load);
            });
            (device, pace)
        })?;
        Ok(Self { stop, thread: Some(thread) })
    }

    /// Stops and gives back the renderer's side and what was met. `None` if the thread died.
    pub fn stop(mut self) -> Option<(Interleaver, Pace)> {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().and_then(|thread| thread.join().ok())
    }
}

impl Drop for NullSink {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Pace {
    /// Runs `work` once a period for a duration and measures it; `work` gets the load of the
    /// block before.
    pub fn measure(period: Duration, duration: Duration, work: impl FnMut(f32)) -> Self {
        let end = Instant::now() + duration;
        Self::measure_while(period, || Instant::now() < end, work)
    }

    fn measure_while(period: Duration, running: impl Fn() -> bool, mut work: impl FnMut(f32)) -> Self {
        let mut pace = Self::default();
        let mut busy = Duration::ZERO;
        let mut load = 0.0;
        let mut due = Instant::now() + period;
        while running() {
            let began = Instant::now();
            work(load);
            let ended = Instant::now();
            let took = ended - began;
            load = took.as_secs_f32() / period.as_secs_f32();
            busy += took;
            pace.blocks += 1;
            pace.longest_s = pace.longest_s.max(took.as_secs_f64());
            if ended > due {
                pace.late += 1;
                // A device goes on in its own time: blocks it missed are not made up for.
                while due < ended {
                    due += period;
                }
            }
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            due += period;
        }
        pace.load = busy.as_secs_f64() / (pace.blocks.max(1) as f64 * period.as_secs_f64());
        pace
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::channel_map::ChannelMap;
    use crate::model::config::Config;

    #[test]
    fn the_null_sink_keeps_the_pace_of_real_time() {
        let crate::engine::Engine { scene: _scene, renderer, .. } = Config::default().build().unwrap();
        let device = Interleaver::new(renderer, ChannelMap::stereo_then_haptics(1));
        let began = Instant::now();
        let sink = NullSink::start(device, 256).unwrap();
        std::thread::sleep(Duration::from_millis(300));
        let (mut device, pace) = sink.stop().unwrap();
        let expected = began.elapsed().as_secs_f64() * 44_100.0;
        let rendered = device.renderer().position() as f64;
        // Never faster than real time; on a busy machine blocks are lost, but not most of them.
        assert!(rendered < 1.02 * expected + 512.0, "{rendered} of {expected} samples");
        assert!(rendered > 0.3 * expected, "{rendered} of {expected} samples");
        assert_eq!(pace.blocks * 256, device.renderer().position());
        assert!(pace.load > 0.0 && pace.load < 0.5);
    }
}
