//! A force-feedback device in a loop: a mass with damping in a hand, a sampled law, and the energy
//! that the loop gives and takes.
//!
//! ```text
//! m ẍ = F_hand − b ẋ + F(x_k)        x: upwards; F is held from tick to tick
//! ```
//! Between two ticks every force is constant, so that the motion is exact:
//! ẋ(t) = w + (ẋ₀ − w) e^{−bt/m}, w = (F_hand + F) / b.

/// What hangs on the loop.
#[derive(Debug, Clone, Copy)]
pub struct Device {
    /// Mass of handle and hand, kg.
    pub mass_kg: f64,
    /// Damping of mechanics and hand, N·s/m.
    pub damping_n_s_m: f64,
    /// Ticks a second.
    pub rate_hz: f64,
    /// Step of its position sensor, m.
    pub resolution_m: f64,
}

/// Where it is at a tick.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tick {
    pub time_s: f64,
    /// How deep the tip stands, m.
    pub depth_m: f64,
    /// What the loop gives, N, upwards.
    pub force_n: f64,
    /// Energy that the loop has given since it began, less what it has taken, J.
    pub given_j: f64,
}

impl Device {
    /// Pushes a tip down that starts above the surface, and lets the loop answer `force_n(depth)`.
    pub fn push(
        &self,
        start_m: f64,
        push_n: impl Fn(f64) -> f64,
        seconds: f64,
        mut force_n: impl FnMut(f64) -> f64,
    ) -> Vec<Tick> {
        let step_s = 1.0 / self.rate_hz;
        let decay = (-self.damping_n_s_m * step_s / self.mass_kg).exp();
        let (mut x, mut v, mut given_j) = (start_m, 0.0, 0.0);
        let mut ticks = Vec::new();
        for tick in 0..(seconds * self.rate_hz) as u32 {
            let time_s = f64::from(tick) * step_s;
            let seen_m = -(x / self.resolution_m).round() * self.resolution_m;
            let loop_n = force_n(seen_m);
            ticks.push(Tick { time_s, depth_m: -x, force_n: loop_n, given_j });
            let terminal = (loop_n - push_n(time_s)) / self.damping_n_s_m;
            let way = terminal * step_s + (v - terminal) * self.mass_kg / self.damping_n_s_m * (1.0 - decay);
            v = terminal + (v - terminal) * decay;
            x += way;
            given_j += loop_n * way;
        }
        ticks
    }

    /// Energy that the loop gives in a cycle of a hand that moves the tip up and down by `swing_m`
    /// about `depth_m`, less what the device's damping takes in it, J.
    pub fn cycle_j(&self, depth_m: f64, swing_m: f64, hz: f64, force_n: impl Fn(f64) -> f64) -> f64 {
        let ticks = (self.rate_hz / hz).round();
        let place = |tick: f64| -depth_m + swing_m * (std::f64::consts::TAU * tick / ticks).sin();
        let given_j: f64 =
            (0..ticks as u32).map(f64::from).map(|k| force_n(-place(k)) * (place(k + 1.0) - place(k))).sum();
        let turn = std::f64::consts::TAU * self.rate_hz / ticks;
        given_j - std::f64::consts::PI * self.damping_n_s_m * turn * swing_m * swing_m
    }

    /// Time in which a swing against a spring falls to 1/e, s: a force that is held for a tick
    /// comes half a tick late, which takes k T/2 of the damping.
    pub fn fall_s(&self, stiffness_n_m: f64) -> f64 {
        2.0 * self.mass_kg / (self.damping_n_s_m - 0.5 * stiffness_n_m / self.rate_hz)
    }

    /// Whether it holds still in the end: its swing in the last quarter is no larger than some
    /// steps of its sensor.
    pub fn holds(&self, ticks: &[Tick]) -> bool {
        let last = &ticks[ticks.len() * 3 / 4..];
        let low = last.iter().fold(f64::INFINITY, |low, tick| low.min(tick.depth_m));
        let high = last.iter().fold(f64::NEG_INFINITY, |high, tick| high.max(tick.depth_m));
        high - low <= 4.0 * self.resolution_m
    }
}
