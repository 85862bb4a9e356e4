//! A field of slopes by its waves, whether it tiles or not: transformed once, asked as often as it
//! takes.

use super::open::Open;
use super::tiling::Tiling;
use super::turning::{Evidence, share_across};
use super::{Derivative, Slopes, Walls};
use asperity_surface::raster::Raster;

enum Waves {
    Tiling(Tiling),
    /// As true slopes.
    Open(Open),
}

/// A field of slopes and its waves.
pub struct SlopeSpectrum {
    field: Slopes,
    waves: Waves,
}

impl std::fmt::Debug for SlopeSpectrum {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "SlopeSpectrum({} × {})", self.field.along_u.width, self.field.along_u.height)
    }
}

impl SlopeSpectrum {
    /// Spectrum of slopes of a surface that tiles, or does not.
    #[must_use]
    pub fn of(field: Slopes, tiles: bool) -> Self {
        let waves = if tiles {
            Waves::Tiling(Tiling::of(&field))
        } else {
            Waves::Open(Open::of(&field, Derivative::Exact))
        };
        Self { field, waves }
    }

    /// The slopes.
    #[must_use]
    pub fn field(&self) -> &Slopes {
        &self.field
    }

    /// Turns the slopes along v over.
    pub fn turn_v(&mut self) {
        self.field.along_v.values.iter_mut().for_each(|q| *q = -*q);
        match &mut self.waves {
            Waves::Tiling(tiling) => tiling.turn_v(),
            Waves::Open(open) => open.turn_v(),
        }
    }

    /// Distance of the slopes from those of any surface, 0–1 ([`super::curl`]).
    #[must_use]
    pub fn curl(&self, derivative: Derivative) -> f64 {
        match &self.waves {
            Waves::Tiling(tiling) => share_across(&tiling.all_seen(derivative)),
            Waves::Open(open) if of_true_slopes(derivative) => share_across(&open.all_seen(derivative)),
            Waves::Open(_) => share_across(&Open::of(&self.field, derivative).all_seen(derivative)),
        }
    }

    /// The derivatives that may have made the slopes, the likeliest first, never none; and whether
    /// it leaves no more than rounding, without which nothing is certain. `noise` is the variance
    /// that rounding leaves in each slope.
    #[must_use]
    pub fn possible_derivatives(&self, noise: f64) -> (Vec<Derivative>, bool) {
        match &self.waves {
            Waves::Tiling(tiling) => Evidence::of_tiling(tiling, noise).possible(),
            Waves::Open(_) => Evidence::of_inside(&self.field, noise).possible(),
        }
    }

    /// The surface with these slopes, mean 0; `noise` is the variance that rounding leaves in each
    /// at the most, `walls` what true slopes are of.
    #[must_use]
    pub fn heights(self, derivative: Derivative, noise: f64, walls: Walls) -> Raster {
        match self.waves {
            Waves::Tiling(tiling) => tiling.heights(derivative, noise, walls),
            Waves::Open(open) if of_true_slopes(derivative) => open.heights(derivative, noise, walls),
            Waves::Open(_) => Open::of(&self.field, derivative).heights(derivative, noise, walls),
        }
    }
}

fn of_true_slopes(derivative: Derivative) -> bool {
    matches!(derivative, Derivative::Exact | Derivative::ExactOrCentral)
}
