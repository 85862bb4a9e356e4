//! Ports: further ways out of a running engine, each a kind of its own.
//!
//! A port has two ends. The [`Outlet`] lives on the audio half, which shows it what leaves; the
//! reading end lives on any one other thread. Between them lies whatever the kind puts there,
//! bounded and without locks. A kind is one type that makes both ([`PortKind`]); those of this
//! crate are in [`live::ports`](crate::live::ports), and another crate may add its own.

use crate::link::tap::ContactBlock;
use crate::model::error::AddError;
use crate::model::id::SurfaceId;
use asperity_surface::moving_picture::MovingPicture;
use std::sync::Arc;

/// The audio half's end of a port. It must not allocate, lock or wait. It is shown every channel
/// and bus, in blocks of the caller's length or parts of it, and picks what it wants.
pub trait Outlet: Send + Sync {
    /// Samples of a haptic channel as they leave, from sample `first` on.
    fn haptic(&mut self, _channel: usize, _first: u64, _samples: &[f32]) {}

    /// Takes samples of an audio bus.
    fn bus(&mut self, _bus: usize, _first: u64, _samples: &[f32]) {}

    /// Takes samples of a channel of pickups.
    fn pickup(&mut self, _channel: usize, _first: u64, _samples: &[f32]) {}

    /// Tests whether contacts are to be shown; while any port watches, slopes are computed that are
    /// not needed otherwise.
    fn watches_contacts(&self) -> bool {
        false
    }

    /// A contact during a stretch of samples.
    fn contact(&mut self, _block: &ContactBlock<'_>) {}

    /// Every contact has been shown up to this sample, which is not among them.
    fn shown(&mut self, _before: u64) {}

    /// Tests whether no reader is left; then it is taken away and freed by the game thread.
    fn is_closed(&self) -> bool;
}

/// Data of the engine for a port that is being opened.
pub struct PortSetup<'a> {
    /// Rate of the samples that leave, Hz.
    pub sample_rate_hz: f64,
    /// Number of haptic channels.
    pub haptic_channels: usize,
    /// Number of audio buses.
    pub audio_buses: usize,
    /// Number of channels of pickups.
    pub pickup_channels: usize,
    /// Contacts that can sound at the same time.
    pub voices: usize,
    /// Picture of a surface that changes.
    pub(crate) picture: &'a dyn Fn(SurfaceId) -> Option<Arc<MovingPicture>>,
}

impl PortSetup<'_> {
    /// The moving picture of a surface; none where its source never changes.
    #[must_use]
    pub fn picture(&self, surface: SurfaceId) -> Option<Arc<MovingPicture>> {
        (self.picture)(surface)
    }
}

/// A kind of port: what is wanted, as plain data.
///
/// ```
/// use asperity::live::ports::{Opened, Outlet, PortKind, PortSetup};
/// use asperity::{AddError, Config, Engine};
/// use std::sync::Arc;
/// use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
///
/// /// How loud the first bus was at most.
/// struct Peak;
/// struct Meter(Arc<AtomicU32>);
///
/// impl Outlet for Meter {
///     fn bus(&mut self, bus: usize, _first: u64, samples: &[f32]) {
///         if bus == 0 {
///             let peak = samples.iter().fold(f32::from_bits(self.0.load(Relaxed)), |peak, x| peak.max(x.abs()));
///             self.0.store(peak.to_bits(), Relaxed);
///         }
///     }
///     // Taken away when the reading end is dropped.
///     fn is_closed(&self) -> bool {
///         Arc::strong_count(&self.0) == 1
///     }
/// }
///
/// impl PortKind for Peak {
///     type Port = Arc<AtomicU32>;
///     fn open(self, _setup: &PortSetup<'_>) -> Result<Opened<Self::Port>, AddError> {
///         let level = Self::Port::default();
///         Ok(Opened { outlet: Some(Box::new(Meter(level.clone()))), port: level })
///     }
/// }
///
/// let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
/// let peak = scene.open_port(Peak)?;
/// renderer.render(&mut [&mut [0.0; 64]], &mut [&mut [0.0; 64]]);
/// assert_eq!(f32::from_bits(peak.load(Relaxed)), 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait PortKind {
    /// The reading end.
    type Port;

    /// Makes both ends.
    ///
    /// # Errors
    /// When what is wanted does not exist ([`AddError::Unknown`] with its name,
    /// [`AddError::UnknownBus`]) or a number is outside its range.
    fn open(self, setup: &PortSetup<'_>) -> Result<Opened<Self::Port>, AddError>;
}

/// Both ends of a port.
pub struct Opened<P> {
    /// For the audio half; none if nothing there writes to the port.
    pub outlet: Option<Box<dyn Outlet>>,
    /// For the reader.
    pub port: P,
}

impl<P> std::fmt::Debug for Opened<P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Opened").field("has_outlet", &self.outlet.is_some()).finish_non_exhaustive()
    }
}

crate::opaque::debug_by_name!(PortSetup<'_>);
