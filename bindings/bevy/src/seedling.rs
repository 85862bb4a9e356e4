//! asperity as a node of `bevy_seedling`'s Firewheel graph, so that the game's volumes, effects and
//! panning apply.
//!
//! One audio bus comes out left and right; of several, bus i comes out of output i. Haptic channels
//! are no sound and do not belong into a mix: they leave by a port
//! ([`Scene::open_port`](asperity::Scene::open_port)), or by [`Output::Device`](crate::Output)
//! instead.
//!
//! The node starts silent. When the graph's rate is known, the next frame of the game designs the
//! engine for it and lays the renderer into a slot; the processor *tries* the slot and never waits
//! for it. A stream that starts anew, on another device for instance, gives the renderer back and
//! has it designed for its own rate.

use crate::touch::Touch;
use asperity::Renderer;
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_seedling::SeedlingCorePlugin;
use bevy_seedling::node::RegisterNode;
use firewheel::StreamInfo;
use firewheel::channel_config::{ChannelConfig, ChannelCount};
use firewheel::node::{
    AudioNode, AudioNodeInfo, AudioNodeProcessor, ConstructProcessorContext, EmptyConfig, NodeError,
    ProcBuffers, ProcExtra, ProcInfo, ProcStreamCtx, ProcessStatus,
};
use std::sync::{Arc, Mutex, PoisonError};

/// Most actuators that are rendered beside the sound.
const MAX_ACTUATORS: usize = 64;

/// The node: one is spawned by [`Output::Seedling`](crate::Output); put an effect or a connection
/// on its entity.
#[derive(Component, Clone)]
pub struct TouchNode {
    slot: Arc<Mutex<Slot>>,
    outputs: u32,
    actuators: usize,
}

/// Queue between the game and the graph.
#[derive(Default)]
struct Slot {
    /// At the game's disposal.
    idle: Option<Renderer>,
    /// Designed for the graph's rate, for the processor.
    ready: Option<Renderer>,
    /// Rate of the graph, Hz, once it is known.
    rate_hz: Option<f64>,
}

/// Needs `SeedlingPlugins`, or their core plugin, in the app before.
pub(crate) fn start(app: &mut App, renderer: Renderer) {
    if !app.is_plugin_added::<SeedlingCorePlugin>() {
        return log::error!(
            "asperity plays nothing: Output::Seedling needs SeedlingPlugins; add them before AsperityPlugin"
        );
    }
    let outputs = renderer.audio_buses().clamp(2, 64) as u32;
    let actuators = renderer.haptic_channels().min(MAX_ACTUATORS);
    let slot = Arc::new(Mutex::new(Slot { idle: Some(renderer), ..Slot::default() }));
    let node = TouchNode { slot, outputs, actuators };
    app.register_simple_node::<TouchNode>();
    app.add_systems(Startup, move |mut commands: Commands| {
        commands.spawn(node.clone());
    });
    app.add_systems(First, hand_over);
}

/// Lays the renderer out for the graph, at the graph's rate.
fn hand_over(nodes: Query<&TouchNode>, touch: Option<ResMut<Touch>>) {
    let Some(mut touch) = touch else { return };
    for node in &nodes {
        let mut slot = node.slot.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(rate_hz) = slot.rate_hz else { continue };
        let Some(renderer) = slot.idle.take() else { continue };
        if renderer.sample_rate_hz() == rate_hz {
            slot.ready = Some(renderer);
            continue;
        }
        match touch.scene().at_rate(renderer, rate_hz) {
            Ok(at) => {
                slot.ready = Some(at.renderer);
                for (_, why) in at.lost {
                    touch.refused(None, why);
                }
            }
            Err(error) => {
                // It is not tried again at the same rate.
                slot.rate_hz = None;
                touch.refused(None, &error);
                slot.idle = Some(*error.renderer);
            }
        }
    }
}

impl AudioNode for TouchNode {
    type Configuration = EmptyConfig;

    fn info(&self, _: &EmptyConfig) -> Result<AudioNodeInfo, NodeError> {
        let outputs = ChannelCount::new(self.outputs).unwrap_or(ChannelCount::STEREO);
        Ok(AudioNodeInfo::new()
            .debug_name("asperity")
            .channel_config(ChannelConfig { num_inputs: ChannelCount::ZERO, num_outputs: outputs }))
    }

    fn construct_processor(
        &self,
        _: &EmptyConfig,
        cx: ConstructProcessorContext,
    ) -> Result<impl AudioNodeProcessor, NodeError> {
        let haptic = vec![Vec::new(); self.actuators];
        let mut processor = Processor { slot: self.slot.clone(), renderer: None, haptic };
        processor.make_ready(cx.stream_info);
        Ok(processor)
    }
}

/// The audio half in the graph.
struct Processor {
    slot: Arc<Mutex<Slot>>,
    renderer: Option<Renderer>,
    /// Haptic samples go nowhere from here; ports take them before.
    haptic: Vec<Vec<f32>>,
}

impl Processor {
    /// Asks for a renderer of the stream's rate, and makes room for its blocks.
    fn make_ready(&mut self, stream: &StreamInfo) {
        let mut slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        let (own, laid_out) = (self.renderer.take(), slot.ready.take());
        slot.idle = slot.idle.take().or(own).or(laid_out);
        slot.rate_hz = Some(f64::from(stream.sample_rate.get()));
        self.haptic.fill(vec![0.0; stream.max_block_frames.get() as usize]);
    }
}

impl AudioNodeProcessor for Processor {
    fn new_stream(&mut self, stream: &StreamInfo, _: &mut ProcStreamCtx<'_>) {
        self.make_ready(stream);
    }

    fn process(&mut self, info: &ProcInfo, buffers: ProcBuffers<'_, '_>, _: &mut ProcExtra) -> ProcessStatus {
        if self.renderer.is_none()
            && let Ok(mut slot) = self.slot.try_lock()
        {
            self.renderer = slot.ready.take();
        }
        let Some(renderer) = &mut self.renderer else { return ProcessStatus::ClearAllOutputs };
        let (buses, actuators) = (renderer.audio_buses(), self.haptic.len());
        let Some(audio) = buffers.outputs.get_mut(..buses) else { return ProcessStatus::ClearAllOutputs };
        let mut channels = self.haptic.iter_mut();
        let mut haptic: [&mut [f32]; MAX_ACTUATORS] = std::array::from_fn(|_| {
            channels.next().and_then(|channel| channel.get_mut(..info.frames)).unwrap_or_default()
        });
        renderer.render(&mut haptic[..actuators], audio);
        if let (1, [left, right, ..]) = (buses, buffers.outputs) {
            right.copy_from_slice(left);
        }
        ProcessStatus::OutputsModified
    }
}

/// The graph drops its processors on the game's side, where the renderer goes on to the next one.
impl Drop for Processor {
    fn drop(&mut self) {
        if let Some(renderer) = self.renderer.take() {
            self.slot.lock().unwrap_or_else(PoisonError::into_inner).idle = Some(renderer);
        }
    }
}
