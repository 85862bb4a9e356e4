//! Touches of a surface and its reaction to them.

/// Kinds of touch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TouchKind {
    /// A contact begins, before anything is read for it: what was kept of an earlier contact of
    /// this number is dropped.
    Begins,
    /// A contact presses on, moving or at rest: once every [`MAX_BLOCK`](super::MAX_BLOCK) samples
    /// of the absolute grid.
    #[default]
    Presses,
    /// A tip stands `depth_m` below the untouched surface: which force carries it there?
    Stands {
        /// Depth, m; below 0 above the surface.
        depth_m: f64,
    },
}

/// A touch of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Touch {
    /// Kind of touch.
    pub kind: TouchKind,
    /// The contact's slot, as in [`PathBlock::contact`](super::PathBlock::contact).
    pub contact: usize,
    /// Absolute index of the sample it belongs to.
    pub sample: u64,
    /// Position on the surface, metres.
    pub position_m: [f64; 2],
    /// Tangential velocity, m/s.
    pub velocity_m_s: [f64; 2],
    /// Force pressing the contact onto the surface, N.
    pub normal_force_n: f64,
}

/// Reaction of a surface to a touch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// Rate of small impacts among the surface's grains, 1/s; 0 for surfaces that do not give way.
    pub grain_rate_per_s: f64,
    /// Mean momentum of one such impact, N·s.
    pub grain_impulse_n_s: f64,
    /// The ground under the contact is changing, whether it moves or not: a contact that rests must
    /// be computed.
    pub wakes_contact: bool,
    /// The force that carries a tip where it [stands](TouchKind::Stands), N, 0 above the ground;
    /// none where the ground is hard.
    pub support_force_n: Option<f64>,
}

impl Reaction {
    /// Adds a weighted reaction; grains keep their total momentum a second.
    #[must_use]
    pub fn plus(self, part: Self, weight: f64) -> Self {
        let weighted_rate = weight.abs() * part.grain_rate_per_s;
        let rate = self.grain_rate_per_s + weighted_rate;
        let momentum =
            self.grain_rate_per_s * self.grain_impulse_n_s + weighted_rate * part.grain_impulse_n_s;
        let carried_n = part.support_force_n.map(|n| self.support_force_n.unwrap_or(0.0) + weight * n);
        Self {
            grain_rate_per_s: rate,
            grain_impulse_n_s: if rate > 0.0 { momentum / rate } else { 0.0 },
            wakes_contact: self.wakes_contact || part.wakes_contact,
            support_force_n: carried_n.or(self.support_force_n),
        }
    }
}
