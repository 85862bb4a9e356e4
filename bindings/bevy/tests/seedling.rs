//! The node in a Firewheel graph whose stream is driven by hand, a stretch after each frame: what
//! comes out of the graph is what the recording renders, to the bit.

mod common;

use asperity::live::ports::{Feed, Pcm};
use audioadapter_buffers::direct::InterleavedSlice;
use bevy::prelude::*;
use bevy_asperity::*;
use bevy_asset::AssetPlugin;
use bevy_seedling::SeedlingCorePlugin;
use bevy_seedling::context::SampleRate;
use bevy_seedling::platform::initialize_stream;
use bevy_seedling::prelude::*;
use common::*;
use firewheel::ActivateInfo;
use firewheel::backend::BackendProcessInfo;
use firewheel::node::StreamStatus;
use firewheel::processor::FirewheelProcessor;
use std::num::NonZeroU32;
use std::sync::{Arc, Mutex};
use std::time::Duration;

const CHANNELS: usize = 2;

/// An app whose touch comes out of a Firewheel graph.
fn app_with(template: AudioGraphTemplate) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin, SeedlingCorePlugin))
        .insert_resource(template)
        .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(STEP))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .add_plugins(AsperityPlugin::to(Output::Seedling));
    app.finish();
    app.cleanup();
    app
}

/// A stream that nobody plays.
struct Stream {
    processor: FirewheelProcessor,
    played: Vec<f32>,
    frames: usize,
}

fn activate(context: &mut AudioContext, rate_hz: u32, most_frames: u32) -> FirewheelProcessor {
    let info = ActivateInfo {
        sample_rate: NonZeroU32::new(rate_hz).unwrap(),
        max_block_frames: NonZeroU32::new(most_frames).unwrap(),
        num_stream_in_channels: 0,
        num_stream_out_channels: CHANNELS as u32,
        input_to_output_latency_seconds: 0.0,
    };
    context.with(|context| context.activate(info).unwrap())
}

impl Stream {
    /// Started when a platform's plugin would, in the first frame of the app.
    fn start(app: &mut App, rate_hz: u32, most_frames: u32) -> Self {
        let made = Arc::new(Mutex::new(None));
        let to = made.clone();
        let start = move |mut context: ResMut<AudioContext>, commands: Commands| {
            *to.lock().unwrap() = Some(activate(&mut context, rate_hz, most_frames));
            initialize_stream(SampleRate::new(NonZeroU32::new(rate_hz).unwrap()), commands);
        };
        app.add_systems(PostStartup, start.in_set(SeedlingStartupSystems::StreamInitialization));
        app.update();
        // The graph asks for the renderer, the game hands it over.
        app.update();
        Self::of(made.lock().unwrap().take().unwrap(), rate_hz)
    }

    /// Started anew, on another device for instance.
    fn again(app: &mut App, rate_hz: u32, most_frames: u32) -> Self {
        let mut context = app.world_mut().resource_mut::<AudioContext>();
        let stream = Self::of(activate(&mut context, rate_hz, most_frames), rate_hz);
        app.update();
        stream
    }

    fn of(processor: FirewheelProcessor, rate_hz: u32) -> Self {
        let frames = (f64::from(rate_hz) * STEP.as_secs_f64()).round() as usize;
        Self { processor, played: Vec::new(), frames }
    }

    /// What a device would take during a frame, in blocks of a size that divides nothing.
    fn play(&mut self) {
        let mut left = self.frames;
        while left > 0 {
            let frames = left.min(97);
            let mut out = vec![f32::NAN; frames * CHANNELS];
            let silence = InterleavedSlice::new(&[], 0, 0).unwrap();
            let mut room = InterleavedSlice::new_mut(&mut out, CHANNELS, frames).unwrap();
            let info = BackendProcessInfo {
                frames,
                process_timestamp: None,
                duration_since_stream_start: Duration::ZERO,
                input_stream_status: StreamStatus::empty(),
                output_stream_status: StreamStatus::empty(),
                dropped_frames: 0,
                process_to_playback_delay: None,
            };
            self.processor.process(&silence, &mut room, info);
            self.played.extend_from_slice(&out);
            left -= frames;
        }
    }

    fn side(&self, side: usize) -> Vec<f32> {
        self.played.iter().skip(side).step_by(CHANNELS).copied().collect()
    }
}

/// A finger strokes for two seconds and lifts; each frame is followed by what a device would take
/// meanwhile.
fn stroke(app: &mut App, stream: &mut Stream, plate: Entity) {
    let finger = app.world_mut().spawn(TouchProbe::felt_by(0)).id();
    for frame in 0..140 {
        let sample = sliding(f64::from(frame) * STEP.as_secs_f64());
        let event = match frame {
            0 => TouchEvent::Begin { toucher: finger, surface: plate, sample },
            125.. => TouchEvent::End { toucher: finger },
            _ => TouchEvent::Move { toucher: finger, sample },
        };
        if frame <= 125 {
            app.world_mut().write_message(event);
        }
        app.update();
        stream.play();
    }
    assert_eq!(errors(app), [""; 0]);
}

#[test]
fn what_leaves_the_graph_is_what_the_recording_renders_to_the_bit() {
    let mut app = app_with(AudioGraphTemplate::Empty);
    app.add_systems(
        PostStartup,
        |mut commands: Commands, nodes: Query<Entity, With<seedling::TouchNode>>| {
            for node in &nodes {
                commands.entity(node).connect(AudioGraphOutput);
            }
        },
    );
    let mut stream = Stream::start(&mut app, 48_000, 128);
    let plate = plate(&mut app);
    touch(&mut app).start_recording();
    stroke(&mut app, &mut stream, plate);
    let (log, names, stats) = {
        let mut touch = touch(&mut app);
        let stats = touch.stats();
        (touch.stop_recording(), touch.names().clone(), stats)
    };
    assert_eq!((stats.refused, stats.dropped, stats.late), (0, 0, 0));
    let render = offline(&log, &names, 1);
    let (left, right) = (stream.side(0), stream.side(1));
    assert_eq!(
        left.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        right.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    );
    assert!(peak(&left) > 1e-4, "silence");
    // The limiter's look-ahead, and nothing else.
    let late = AsperityPlugin::default().config.build().unwrap().renderer.latency_samples();
    let played = &left[late..];
    let frames = played.len().min(render.audio[0].len());
    assert!(frames > 80_000, "{frames} samples");
    let first = (0..frames).find(|i| played[*i].to_bits() != render.audio[0][*i].to_bits());
    assert_eq!(first, None, "the first sample that differs, of {frames}");
}

#[test]
fn a_games_usual_graph_plays_it_through_its_main_bus() {
    let mut app = app_with(AudioGraphTemplate::Game);
    let mut stream = Stream::start(&mut app, 48_000, 256);
    let plate = plate(&mut app);
    stroke(&mut app, &mut stream, plate);
    assert!(peak(&stream.played) > 1e-4, "silence");
    assert!(stream.played.iter().all(|x| x.is_finite()));
}

#[test]
fn a_stream_restarted_at_another_rate_continues() {
    let mut app = app_with(AudioGraphTemplate::Game);
    let mut stream = Stream::start(&mut app, 48_000, 64);
    let plate = plate(&mut app);
    stroke(&mut app, &mut stream, plate);
    let first = peak(&stream.played);
    drop(stream);
    app.update();
    let mut stream = Stream::again(&mut app, 44_100, 512);
    stroke(&mut app, &mut stream, plate);
    let again = peak(&stream.played);
    assert!(again > 0.5 * first && again < 2.0 * first, "{again} after {first}");
    let port = touch(&mut app).scene().open_port(Pcm { from: Feed::Bus(0), holds_s: 0.1 }).unwrap();
    assert_eq!(port.sample_rate_hz(), 44_100.0);
}

#[test]
fn without_seedlings_plugins_the_app_goes_on_in_silence() {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins).add_plugins(AsperityPlugin::to(Output::Seedling));
    let plate = plate(&mut app);
    for _ in 0..10 {
        app.update();
    }
    assert!(touch(&mut app).body(plate).is_some());
}
