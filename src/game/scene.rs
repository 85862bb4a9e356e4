//! The game half: takes resources and events, checks them, sends them, frees what comes back.
//!
//! Every call returns at once. Nothing here waits for the audio thread.

mod bodies;
mod clips;
mod levelled;
mod named;
mod pickups;
mod ports;
mod quiet;
mod recorded;
mod reports;
mod spin;
mod surfaces;
mod touched;

use self::named::Named;
use self::spin::Spin;
use crate::files::contact_log::LogEdit;
use crate::game::clipping::Strongest;
use crate::game::clock::Clock;
use crate::game::contradiction::{Motions, Sheet};
use crate::game::levels::{BodyLevel, Levels, Trials};
use crate::game::places::Places;
use crate::game::recording::Recording;
use crate::game::silence::Reported;
use crate::game::variation::Variation;
use crate::link::message::{Made, Message, Retired};
use crate::link::ring::{Receiver, Sender};
use crate::link::stats::{Counters, Stats};
use crate::model::body::Body;
use crate::model::config::Config;
use crate::model::contact_sample::Placement;
use crate::model::error::AddError;
use crate::model::event::{ContactEvent, ContactId};
use crate::model::id::{BodyId, ProbeId, SurfaceId};
use crate::model::material::Material;
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikeField;
use crate::resource::probe::PreparedProbe;
use crate::resource::surface::SurfaceLevels;
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::simd::Level;
use asperity_surface::moving_picture::MovingPicture;
use asperity_surface::tip_law::TipLaw;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

/// The game half of an engine.
///
/// ```
/// use asperity::{Config, ContactEvent, ContactId, ContactSample, Engine, Surface, Touching};
///
/// let Engine { mut scene, .. } = Config::live(48_000.0).build()?;
/// let desk = scene.add_surface(Surface::flat(1.2, 0.6)?)?;
/// let sample = ContactSample::new([0.5, 0.5], 0.4).sliding([0.1, 0.0]);
/// scene.report(0.0, ContactEvent::begin_with(ContactId(1), Touching::on(desk), sample))?;
/// // What is wrong is said by name, and the event is handed back.
/// let heavy = ContactSample { normal_force_n: f64::NAN, ..sample };
/// let refused = scene.report(0.02, ContactEvent::moved(ContactId(1), heavy)).unwrap_err();
/// assert!(refused.to_string().starts_with("normal_force_n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Scene {
    pub(crate) config: Config,
    /// The instructions that bodies and probes are prepared for.
    pub(crate) kernel: Level,
    pub(crate) clock: Clock,
    last_time_s: f64,
    pub(crate) surfaces: Places<KnownSurface>,
    pub(crate) bodies: Places<KnownBody>,
    pub(crate) probes: Places<Probe>,
    pub(crate) open_ports: usize,
    /// Probes whose ways of riding surfaces get ready for.
    pub(crate) rides: Vec<Probe>,
    /// The newest move of each contact that did not fit into the queue.
    held: Vec<(Stamp, ContactId, ContactEvent)>,
    pub(crate) to_audio: Sender<Message>,
    pub(crate) from_audio: Receiver<Retired>,
    pub(crate) counters: Arc<Counters>,
    recording: Option<Recording>,
    /// Bodies as they were given, for another rate.
    pub(crate) given: HashMap<BodyId, Body>,
    /// Gain of impacts on a body that has none of its own: what the level policy has found for
    /// those of the scene file.
    pub(crate) strike_gain: f64,
    /// Levels that are found when bodies and surfaces are added.
    levels: Levels,
    /// For [`Scene::why_clipped`].
    strongest: Strongest,
    /// For [`Scene::why_silent`].
    reported: Reported,
    /// Motions that the reports give twice.
    motions: Motions,
    /// Surface of each contact, and the place in its body of its newest report.
    touched: HashMap<ContactId, Touched>,
    /// Time of each body's newest motion, s, and how fast it turned, rad/s.
    moved: HashMap<BodyId, (f64, [f64; 3])>,
    /// The newest impact that sounded on each body that has a least time: when, in samples, and its
    /// impulse.
    sounded: HashMap<BodyId, (f64, f64)>,
    /// Speed and pitch of all that leaves.
    pitch: f64,
    /// Strikes with a name.
    named: Named,
    /// Bodies that have rung out, the newest last: the next of the same kind goes out at once.
    pub(crate) rested: Vec<Made>,
}

/// Surface and place of a contact.
#[derive(Clone, Copy)]
struct Touched {
    surface: SurfaceId,
    at_m: Option<[f64; 3]>,
    spin: Spin,
    /// Place of its probe; none = the engine's own.
    probe: Option<usize>,
    /// The gain that the game has set, and whether it is felt.
    gain: f64,
    unfelt: bool,
}

/// Surface as the game half stores it.
#[derive(Clone)]
pub(crate) struct KnownSurface {
    /// True where contacts on it ring something.
    rings: bool,
    /// Picture, if it changes.
    picture: Option<Arc<MovingPicture>>,
    place: Placement,
    sheet: Sheet,
    tip_law: Option<TipLaw>,
    body: Option<BodyId>,
    /// True where contacts on it stick and slip.
    rubs: bool,
    levels: SurfaceLevels,
}

/// Body as the game half stores it.
#[derive(Clone)]
pub(crate) struct KnownBody {
    material: Material,
    lowest_mode_hz: f64,
    /// Its surface, where that is known.
    field: Option<Arc<StrikeField>>,
    /// Its mass is known.
    weighs: bool,
    level: BodyLevel,
    variation: Option<Variation>,
}

impl KnownBody {
    /// Tests whether its motion under a contact is known.
    fn can_be_rubbed(&self) -> bool {
        self.weighs || self.field.is_some()
    }
}

impl Scene {
    pub(crate) fn new(
        config: Config,
        (kernel, trials): (Level, Trials),
        clock: Clock,
        to_audio: Sender<Message>,
        from_audio: Receiver<Retired>,
        counters: Arc<Counters>,
    ) -> Self {
        Self {
            surfaces: Places::new(config.max_surfaces, "surfaces"),
            bodies: Places::new(config.max_bodies, "bodies"),
            probes: Places::new(config.max_probes, "probes"),
            open_ports: 0,
            rides: vec![config.probe],
            given: HashMap::new(),
            strike_gain: 1.0,
            levels: Levels::new(trials),
            strongest: Strongest::default(),
            reported: Reported::default(),
            motions: Motions::default(),
            held: Vec::new(),
            config,
            kernel,
            clock,
            last_time_s: f64::NEG_INFINITY,
            to_audio,
            from_audio,
            counters,
            recording: None,
            touched: HashMap::new(),
            moved: HashMap::new(),
            sounded: HashMap::new(),
            rested: Vec::new(),
            named: Named::default(),
            pitch: 1.0,
        }
    }

    /// Configuration of the engine.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Adds a probe that contacts may touch with: a [preset](crate::PROBE_PRESETS) or one's own. It
    /// stays as long as the scene.
    ///
    /// # Errors
    /// When every place is taken, a number is outside its range, or the queue is full.
    pub fn add_probe(&mut self, probe: Probe) -> Result<ProbeId, AddError> {
        let id = ProbeId(self.probes.free()?);
        let message = self.prepared_probe(id, &probe)?;
        self.send(message)?;
        self.probes.set(id.0, probe);
        let rides_as =
            |known: &Probe| (known.tip_radius_m, known.face_m) == (probe.tip_radius_m, probe.face_m);
        if !self.rides.iter().any(rides_as) {
            self.rides.push(probe);
        }
        self.note(|names| LogEdit::AddProbe { probe: names.probe(id), is: probe });
        Ok(id)
    }

    /// A probe as the audio half takes it.
    pub(crate) fn prepared_probe(&self, id: ProbeId, probe: &Probe) -> Result<Message, AddError> {
        let Config { probe: own, integrator, .. } = &self.config;
        let probe = PreparedProbe::new(probe, own, *integrator, self.config.inner_rate_hz(), self.kernel)?;
        Ok(Message::AddProbe { index: id.index(), probe: Box::new(probe) })
    }

    fn send(&mut self, message: Message) -> Result<(), AddError> {
        // What comes home makes room for what the message sends home.
        self.collect();
        self.to_audio.send(message).map_err(|_| AddError::QueueFull)
    }

    /// Tests whether another move might be held back because the audio half lags behind.
    pub(crate) fn is_filling(&mut self) -> bool {
        self.to_audio.free() <= self.to_audio.capacity() / 4 + 1
    }

    /// Game time begins anew: the next report holds at the sample that is rendered next, whatever
    /// its time, and later ones keep their exact distance to it. For a level that restarts, a game
    /// that was loaded or that was paused under [`ClockMode::Exact`](crate::ClockMode::Exact); a
    /// live clock finds out by itself, within a report. Events that still wait for their time are
    /// dropped and counted as superseded. Contacts that touch go on until their next report, their
    /// end or the time-out.
    ///
    /// # Errors
    /// When the queue is full.
    pub fn reset(&mut self) -> Result<(), AddError> {
        self.send(Message::Reset)?;
        self.counters.resets_asked.fetch_add(1, Relaxed);
        Counters::add(&self.counters.superseded, self.held.len() as u64);
        self.held.clear();
        self.drop_strikes();
        self.forget_what_waits();
        self.clock.reset(self.counters.position.load(Relaxed));
        self.last_time_s = f64::NEG_INFINITY;
        self.moved.clear();
        Ok(())
    }

    /// Statistics of the engine so far.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let stats = self.counters.snapshot();
        Stats { position: stats.position / self.config.inner_samples() as u64, ..stats }
    }

    fn known_surface(&self, id: SurfaceId) -> Result<&KnownSurface, AddError> {
        self.surfaces.get(id.0).ok_or(AddError::Unknown("surface"))
    }

    fn known_body(&self, id: BodyId) -> Result<KnownBody, AddError> {
        self.bodies.get(id.0).cloned().ok_or(AddError::Unknown("body"))
    }
}

crate::opaque::debug_by_name!(Scene);
