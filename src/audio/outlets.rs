//! Outlets: the audio half's ends of the ports that are open.

use crate::link::message::Retired;
use crate::link::outlet::Outlet;
use crate::link::ring::Sender;
use crate::link::tap::{ContactBlock, Tap};
use crate::model::inner_rate::InnerRate;
use asperity_surface::height_field::MAX_BLOCK;

/// The outlets of all open ports.
pub(crate) struct Outlets {
    open: Vec<Box<dyn Outlet>>,
    /// True where any of them watches contacts.
    watching: bool,
    /// Samples of a stretch that leave.
    leaving: [f32; MAX_BLOCK],
    /// Mean of inner samples so far, of each haptic channel.
    means: Box<[f32]>,
}

impl Outlets {
    /// Room for `capacity` ports on an engine of so many haptic channels.
    pub(crate) fn new(capacity: usize, haptic_channels: usize) -> Self {
        Self {
            open: Vec::with_capacity(capacity),
            watching: false,
            leaving: [0.0; MAX_BLOCK],
            means: vec![0.0; haptic_channels].into(),
        }
    }

    /// The game half sees to it that there is room.
    pub(crate) fn add(&mut self, outlet: Box<dyn Outlet>) {
        self.watching |= outlet.watches_contacts();
        self.open.push(outlet);
    }

    /// Sends those home that nobody reads any more.
    pub(crate) fn tidy(&mut self, to_game: &mut Sender<Retired>) {
        let mut at = 0;
        while at < self.open.len() {
            if self.open[at].is_closed() && to_game.free() > 0 {
                // There is room: see above.
                let _ = to_game.send(Retired::Outlet(self.open.swap_remove(at)));
                self.watching = self.open.iter().any(|outlet| outlet.watches_contacts());
            } else {
                at += 1;
            }
        }
    }

    /// Shows what leaves on a haptic channel of a stretch of inner samples from `position` on.
    pub(crate) fn haptic(&mut self, channel: usize, inner: InnerRate, position: u64, block: &[f32]) {
        if self.are_open() {
            self.show(inner, position, block, |outlet, first, leaving| {
                outlet.haptic(channel, first, leaving)
            });
        }
    }

    /// Shows what leaves of a block to every outlet.
    #[cold]
    #[inline(never)]
    fn show(
        &mut self,
        inner: InnerRate,
        position: u64,
        block: &[f32],
        to: impl Fn(&mut dyn Outlet, u64, &[f32]),
    ) {
        let (first, count) = inner.leaving(position, block, &mut self.leaving);
        self.open.iter_mut().for_each(|outlet| to(&mut **outlet, first, &self.leaving[..count]));
    }

    /// Shows a channel of which means leave. They are kept up while no port is open, so that one
    /// that opens between two samples is shown whole ones.
    #[cold]
    #[inline(never)]
    pub(crate) fn haptic_means(&mut self, channel: usize, inner: InnerRate, position: u64, block: &[f32]) {
        let mean = &mut self.means[channel];
        let (first, count) = inner.leaving_means(position, block, mean, &mut self.leaving);
        for outlet in &mut self.open {
            outlet.haptic(channel, first, &self.leaving[..count]);
        }
    }

    /// Shows an audio bus.
    pub(crate) fn bus(&mut self, bus: usize, inner: InnerRate, position: u64, block: &[f32]) {
        if self.are_open() {
            self.show(inner, position, block, |outlet, first, leaving| outlet.bus(bus, first, leaving));
        }
    }

    /// Shows a channel of pickups.
    pub(crate) fn pickup(&mut self, channel: usize, inner: InnerRate, position: u64, block: &[f32]) {
        if self.are_open() {
            self.show(inner, position, block, |outlet, first, leaving| {
                outlet.pickup(channel, first, leaving)
            });
        }
    }

    /// Tests whether any port is open.
    pub(crate) fn are_open(&self) -> bool {
        !self.open.is_empty()
    }

    /// Every contact has been shown up to this sample.
    pub(crate) fn shown(&mut self, before: u64) {
        for outlet in &mut self.open {
            outlet.shown(before);
        }
    }

    /// Shows contacts to the outlets as well as to a tap.
    pub(crate) fn beside<'a>(&'a mut self, tap: &'a mut dyn Tap) -> Beside<'a> {
        Beside { tap, outlets: self }
    }
}

/// A tap, and the outlets beside it.
pub(crate) struct Beside<'a> {
    tap: &'a mut dyn Tap,
    outlets: &'a mut Outlets,
}

impl Tap for Beside<'_> {
    fn is_watching(&self) -> bool {
        self.outlets.watching || self.tap.is_watching()
    }

    fn wants_inner_samples(&self) -> bool {
        !self.outlets.watching && self.tap.wants_inner_samples()
    }

    fn contact(&mut self, block: &ContactBlock<'_>) {
        if self.tap.is_watching() {
            self.tap.contact(block);
        }
        if self.outlets.watching {
            self.outlets.open.iter_mut().for_each(|outlet| outlet.contact(block));
        }
    }
}
