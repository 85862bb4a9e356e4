//! The plugin: builds the engine, starts the output, and orders what happens in a frame.

use crate::component::TouchProbe;
use crate::event::{TouchError, TouchEvent};
use crate::haptics;
use crate::in_step;
use crate::null::{self, NullOutput};
use crate::output::Output;
use crate::tip::{self, TouchTip};
use crate::touch::Touch;
use asperity::files::contact_log::Names;
use asperity::{Config, Engine, Renderer};
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_input::gamepad::GamepadRumbleRequest;
use bevy_time::{Fixed, Time, Virtual};

/// Set in which touches are reported; in `FixedPostUpdate`.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TouchSystems {
    /// Messages and adapters' contacts go to the engine.
    Report,
}

/// Touch as sound and vibration.
///
/// When the settings or the device are refused, the app goes on in silence: without the resource
/// [`Touch`] nothing is touched, and the reason is logged as an error and comes as a
/// [`TouchError`].
#[derive(Debug, Clone)]
pub struct AsperityPlugin {
    /// Configuration of the engine; a device's rate wins over its own. By default live, 48 kHz, one
    /// bus and one haptic channel with limiters, and levels that are found as bodies and surfaces
    /// come ([`Config::live`]).
    pub config: Config,
    /// Destination of sound.
    pub output: Output,
}

impl Default for AsperityPlugin {
    fn default() -> Self {
        Self { config: Config::live(48_000.0), output: Output::default() }
    }
}

impl AsperityPlugin {
    /// With the default settings.
    #[must_use]
    pub fn to(output: Output) -> Self {
        Self { output, ..Self::default() }
    }
}

impl Plugin for AsperityPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<TouchEvent>().add_message::<TouchError>().add_message::<GamepadRumbleRequest>();
        match self.engine() {
            Ok(Engine { scene, renderer, .. }) => {
                app.insert_resource(Touch::new(scene, Names::default()));
                self.start(app, renderer);
            }
            Err(why) => silent(app, why),
        }
        app.add_observer(in_step::body_came)
            .add_observer(in_step::body_went)
            .add_observer(in_step::surface_came)
            .add_observer(in_step::surface_went)
            .add_observer(in_step::probe_came)
            .add_observer(in_step::toucher_went::<TouchProbe>)
            .add_observer(in_step::toucher_went::<TouchTip>)
            .add_observer(haptics::rumble_came)
            .add_observer(haptics::rumble_went)
            .add_observer(haptics::headset_came);
        app.add_systems(FixedPostUpdate, (tip::follow, report).chain().in_set(TouchSystems::Report))
            .add_systems(PostUpdate, (haptics::rumble, haptics::frames))
            .add_systems(Last, (pause, tell, null::play.run_if(resource_exists::<NullOutput>)).chain());
    }
}

impl AsperityPlugin {
    fn engine(&self) -> Result<Engine, String> {
        let config = self.config.clone();
        #[cfg(feature = "device")]
        let config = match &self.output {
            Output::Device(options) => {
                let rate = asperity::live::device::sample_rate_hz(options).map_err(|error| error.to_string());
                Config { sample_rate_hz: rate?, ..config }
            }
            _ => config,
        };
        config.build().map_err(|error| error.to_string())
    }

    fn start(&self, app: &mut App, renderer: Renderer) {
        match &self.output {
            Output::Null { keep } => {
                app.insert_resource(NullOutput::new(renderer, *keep));
            }
            #[cfg(feature = "device")]
            Output::Device(options) => match asperity::live::device::play_on(renderer, options) {
                Ok(player) => {
                    if let Some(why) = player.silent_because() {
                        silent(app, why);
                    }
                    app.insert_resource(Playing(std::sync::Mutex::new(player)));
                }
                Err(why) => silent(app, why),
            },
            #[cfg(feature = "seedling")]
            Output::Seedling => crate::seedling::start(app, renderer),
        }
    }
}

/// Says that nobody will hear anything: as a line of the log, and to systems that read refusals in
/// the app's first frame.
fn silent(app: &mut App, why: impl std::fmt::Display) {
    let text = format!("asperity plays nothing: {why}");
    log::error!("{text}");
    app.world_mut().write_message(TouchError { entity: None, text });
}

/// The running device; dropped with the app.
#[cfg(feature = "device")]
#[derive(Resource)]
struct Playing(
    #[expect(dead_code, reason = "it plays for as long as it lives")]
    std::sync::Mutex<asperity::live::device::Player>,
);

/// At the end of each fixed step, with its time.
fn report(
    mut events: MessageReader<TouchEvent>,
    probes: Query<&TouchProbe>,
    time: Res<Time<Fixed>>,
    touch: Option<ResMut<Touch>>,
) {
    let Some(mut touch) = touch else { return events.clear() };
    for event in events.read() {
        let (TouchEvent::Begin { toucher, .. }
        | TouchEvent::Move { toucher, .. }
        | TouchEvent::End { toucher }) = *event
        else {
            touch.told(time.elapsed_secs_f64(), event, None);
            continue;
        };
        touch.told(time.elapsed_secs_f64(), event, probes.get(toucher).ok());
    }
}

/// A game that is paused fades, and comes back where it was.
fn pause(time: Res<Time<Virtual>>, touch: Option<ResMut<Touch>>, mut was_paused: Local<bool>) {
    let Some(mut touch) = touch.filter(|_| time.is_paused() != *was_paused) else { return };
    let changed = if time.is_paused() { touch.scene().pause() } else { touch.scene().resume() };
    match changed {
        Ok(()) => *was_paused = time.is_paused(),
        Err(error) => touch.refused(None, error),
    }
}

/// Refusals become messages and lines of the log.
fn tell(touch: Option<ResMut<Touch>>, mut out: MessageWriter<TouchError>) {
    let Some(mut touch) = touch else { return };
    for error in touch.take_errors() {
        log::warn!("asperity: {}", error.text);
        out.write(error);
    }
}
