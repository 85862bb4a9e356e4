//! Heights from a normal map.
//!
//! ```text
//! n = 2 (r, g, b) − 1        dz/du = −n_x / n_z        dz/dv = ±n_y / n_z
//! ```
//! with + for OpenGL maps (green brightens towards a slope facing up the image) and − for DirectX
//! maps; v grows downwards. The slopes are integrated by [`crate::gradient_field`].
//!
//! What a map does not say is read from it by asking which answer makes it the normals of a
//! surface: the convention of its green channel, and which differences of texels it was made with.
//! Corrugations and waves as long along u as along v are the same map whatever made them, up to the
//! waves' heights: there [`Derivative::ExactOrCentral`] is taken and said to be uncertain. Over a
//! wave of ω radians a texel it errs by (ω − sin ω)/(ω + sin ω) in both cases, 0.32 % at 32 texels,
//! and no method can do better in the worse one. Told which, waves of 11 to 26 texels come out
//! within 0.5 %.
//!
//! 8-bit maps round each component of a normal to 1/127.5: a slope's variance from that is
//! ```text
//! σ² (1 + p² + q²) ((1 + p²)² + 2 p² q² + (1 + q²)²)/2        σ² = (1/127.5)²/12, p and q the slopes
//! ```
//! and [`SlopeSpectrum::heights`] takes no more height from the slopes than that leaves. Normals
//! that were resized, saved as JPEG or painted over are those of no surface by more than that: how
//! much is measured at every frequency, as what lies across the derivative, and taken off too. What
//! made such a map is never certain, and where heights by differences would have more of the
//! shortest waves than of longer ones (`short_waves`), true slopes are taken; where it is flat but
//! for walls, these are taken for narrower than they look ([`Walls`]); of the derivatives that may
//! have, the one that raises short waves the least is taken. 8-bit maps have no number for 0
//! (127.5), so that a flat map tilts by 0.4 %: the mean slope of a map that tiles is dropped, and
//! of one that does not, too, unless [`NormalMapOptions::keep_tilt`]. What is flat in a map comes
//! out at the step next to 0: where that step stands out of the others, its texels are taken for
//! what they are on average.
//!
//! A normal of a surface's heights never points down, and half of a map's never lean one way more
//! than they point up: a picture in which more than [`MOST_DOWN`] do, or whose mean leans beyond
//! 45°, is a photograph (or holds normals of an object, not of its surface) and is refused. Of 41
//! public normal maps, averaged and JPEG, the worst has 0.1 % and leans by 34°; of 58 public colour
//! maps and photographs none passes.

mod decode;
mod plausible;
mod seams;
mod short_waves;
mod zero_code;

pub use plausible::MOST_DOWN;

use crate::borders::Borders;
use crate::gradient_field::{Derivative, SlopeSpectrum, Walls, integrate_periodic};
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;
use decode::{rounding_noise, rounding_steps, slopes_of_normals};
use short_waves::outgrow_longer_ones;

/// A green convention is only decided when its curl is at most this fraction of the other's.
const DECIDED: f64 = 0.8;
/// Variance that half-precision floats, the coarsest ones in files, leave in slopes, over their
/// power.
const FLOATS: f64 = 1e-7;

/// Which way green points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Green {
    /// The one that makes the map integrable; OpenGL when it makes no difference.
    #[default]
    Detect,
    /// Up the image.
    OpenGl,
    /// Down the image.
    DirectX,
}

/// Facts given about a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NormalMapOptions {
    /// Which way green points.
    pub green: Green,
    /// Operator that took its slopes from heights; `None`: estimated.
    pub derivative: Option<Derivative>,
    /// True where it tiles.
    pub borders: Borders,
    /// Keep the mean slope of a map that does not tile.
    pub keep_tilt: bool,
}

/// The surface of a normal map.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMapHeights {
    /// Heights in texels (multiply by the size of a texel), mean 0.
    pub height_px: Raster,
    /// Which way green points.
    pub green: Green,
    /// True where the map shows it: false when both conventions fit alike.
    pub green_is_certain: bool,
    /// Operator that took its slopes.
    pub derivative: Derivative,
    /// True where it was given or the map shows it: false when several fit alike, or none to within
    /// rounding.
    pub derivative_is_certain: bool,
    /// True where it tiles.
    pub tileable: bool,
    /// Degree to which it was taken for flat places with walls between them, 0–1 ([`Walls`]): short
    /// waves are then lowered.
    pub walls: f64,
    /// Part that is not integrable, 0–1 of the power of its slopes' derivatives.
    pub curl: f64,
}

/// The surface whose normals are nearest to the map's.
///
/// # Errors
/// When the three channels are not equally large or smaller than 4 × 4, hold numbers outside 0–1,
/// or are no normals of heights.
pub fn heights_from_normals(
    red: &Raster,
    green: &Raster,
    blue: &Raster,
    options: &NormalMapOptions,
) -> Result<NormalMapHeights, DesignError> {
    check([red, green, blue])?;
    plausible::check(red, green, blue)?;
    let steps = rounding_steps([red, green, blue]);
    let mut field = slopes_of_normals(red, green, blue, steps);
    let tileable = match options.borders {
        Borders::Detect => seams::tiles(&field),
        given => given == Borders::Periodic,
    };
    if tileable || !options.keep_tilt {
        for slope in [&mut field.along_u, &mut field.along_v] {
            let mean = slope.mean();
            slope.values.iter_mut().for_each(|v| *v -= mean);
        }
    }
    let noise = steps.map_or(FLOATS * field.power(), |steps| rounding_noise(&field, 2.0 / steps));
    let mut spectrum = SlopeSpectrum::of(field, tileable);
    let (green, green_is_certain) = which_green(&mut spectrum, options.green);
    let (derivative, derivative_is_certain) = which_derivative(&spectrum, noise, options.derivative);
    let rounding = steps.map(|_| noise);
    // Differences that did not make the slopes raise what resizing left in waves that they hardly
    // see.
    let is_guess =
        options.derivative.is_none() && matches!(derivative, Derivative::Central | Derivative::Sobel);
    let again = is_guess.then(|| spectrum.field().clone());
    let mut made = Made::of(spectrum, derivative, derivative_is_certain, rounding, tileable);
    if let Some(field) = again.filter(|_| outgrow_longer_ones(&made.height_px)) {
        let spectrum = SlopeSpectrum::of(field, tileable);
        made = Made::of(spectrum, Derivative::Exact, false, rounding, tileable);
    }
    let Made { height_px, derivative, derivative_is_certain, walls, curl } = made;
    Ok(NormalMapHeights {
        height_px,
        green,
        green_is_certain,
        derivative,
        derivative_is_certain,
        tileable,
        walls: walls.share(),
        curl,
    })
}

/// Heights by one derivative.
struct Made {
    height_px: Raster,
    derivative: Derivative,
    derivative_is_certain: bool,
    walls: Walls,
    curl: f64,
}

impl Made {
    /// Map of slopes that rounding left a variance of `rounding` in, if they were rounded.
    fn of(
        spectrum: SlopeSpectrum,
        derivative: Derivative,
        derivative_is_certain: bool,
        rounding: Option<f64>,
        tileable: bool,
    ) -> Self {
        let curl = spectrum.curl(derivative);
        // Normals made of this map's own heights by differences are those heights'; of others'
        // walls they say too much.
        let may_be_baked =
            matches!(derivative, Derivative::Exact | Derivative::ExactOrCentral) && !derivative_is_certain;
        let walls = if may_be_baked { Walls::of(spectrum.field()) } else { Walls::NONE };
        let height_px = match rounding {
            None if tileable => integrate_periodic(spectrum.field(), derivative),
            None => spectrum.heights(derivative, f64::INFINITY, walls),
            Some(noise) => spectrum.heights(derivative, noise, walls),
        };
        Self { height_px, derivative, derivative_is_certain, walls, curl }
    }
}

fn check(channels: [&Raster; 3]) -> Result<(), DesignError> {
    let first = channels[0];
    let smaller = first.width.min(first.height) as f64;
    DesignError::check("normal map side", smaller, "at least 4 texels", |n| n >= 4.0)?;
    for channel in channels {
        if (channel.width, channel.height) != (first.width, first.height) {
            let expected = "as wide and high as the red channel";
            return Err(DesignError { field: "channel width", value: channel.width as f64, expected });
        }
        if let Some(&value) = channel.values.iter().find(|v| !(0.0..=1.0).contains(*v)) {
            return Err(DesignError { field: "normal map", value, expected: "within 0 to 1" });
        }
    }
    Ok(())
}

/// Which way green points, by which the slopes turn less; they are turned to point up.
fn which_green(spectrum: &mut SlopeSpectrum, wanted: Green) -> (Green, bool) {
    let up = spectrum.curl(Derivative::Exact);
    spectrum.turn_v();
    let down = spectrum.curl(Derivative::Exact);
    let certain = up.min(down) < DECIDED * up.max(down);
    let (green, certain) = match wanted {
        Green::Detect if certain && down < up => (Green::DirectX, true),
        Green::Detect => (Green::OpenGl, certain),
        given => (given, true),
    };
    if green != Green::DirectX {
        spectrum.turn_v();
    }
    (green, certain)
}

/// The derivative that was given, or the one that the slopes leave, or of those they do not tell
/// apart the one that raises short waves the least.
fn which_derivative(spectrum: &SlopeSpectrum, noise: f64, given: Option<Derivative>) -> (Derivative, bool) {
    if let Some(derivative) = given {
        return (derivative, true);
    }
    let (possible, certain) = spectrum.possible_derivatives(noise);
    let may_be = |derivative| possible.contains(&derivative);
    match possible[..] {
        [only] => (only, certain),
        _ if certain && may_be(Derivative::Exact) && may_be(Derivative::Central) => {
            (Derivative::ExactOrCentral, false)
        }
        _ if may_be(Derivative::Exact) => (Derivative::Exact, false),
        _ => (Derivative::Central, false),
    }
}
