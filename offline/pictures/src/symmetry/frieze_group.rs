//! Frieze group of a strip: one of seven.
//!
//! A strip repeats along x. What else can carry it onto itself: a mirror across (x → c − x), a
//! mirror along (y → d − y), a glide (y → d − y, x → x + ½), a half turn (both). Each is tried at
//! every c and d; it is a symmetry if strip and image agree.
//!
//! | group | mirror across | mirror along | glide | half turn |
//! |---|---|---|---|---|
//! | p1 | | | | |
//! | p11g | | | • | |
//! | p1m1 | • | | | |
//! | p11m | | • | (•) | |
//! | p2 | | | | • |
//! | p2mg | • | | • | • |
//! | p2mm | • | • | (•) | • |

use asperity_surface::raster::Raster;
use serde::Serialize;

/// Least correlation of a strip with its image. Source: ours; strips of the tests reach 0.97 and
/// more under their own symmetries, 0.94 under others.
const SYMMETRY_LIMIT: f64 = 0.955;

/// Longest strip that is compared texel by texel; longer ones are averaged down.
const LONGEST: usize = 64;

/// Tolerance for its height: its axis is found to half a texel, so that it is kept finer.
const HIGHEST: usize = 256;

/// Correlation of the rows' means below which they differ.
const LEAST_OF_ROWS: f64 = 0.7;

/// Share of the pattern that an image must cover to be compared.
const LEAST_COVERED: f64 = 0.9;

/// One of the seven ways in which a strip can repeat.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "these are the names")]
pub enum FriezeGroup {
    P1,
    P11g,
    P1m1,
    P11m,
    P2,
    P2mg,
    P2mm,
}

impl FriezeGroup {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::P1, Self::P11g, Self::P1m1, Self::P11m, Self::P2, Self::P2mg, Self::P2mm];

    /// The International short symbol.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::P1 => "p1",
            Self::P11g => "p11g",
            Self::P1m1 => "p1m1",
            Self::P11m => "p11m",
            Self::P2 => "p2",
            Self::P2mg => "p2mg",
            Self::P2mm => "p2mm",
        }
    }
}

/// The group of a strip that repeats along x. Stripes have the mirror along them whatever their
/// profile.
pub(super) fn frieze_group(strip: &Raster, stripes: bool) -> FriezeGroup {
    let parts = Parts::new(&reduced(strip));
    let is = |agreement: f64| agreement >= SYMMETRY_LIMIT;
    let across = is(parts.across());
    if stripes {
        return if across { FriezeGroup::P2mm } else { FriezeGroup::P11m };
    }
    let half = parts.detail.width / 2;
    let (along, glide, turn) = (is(parts.along(0)), is(parts.along(half)), is(parts.turned()));
    match (across, along, glide, turn) {
        (true, true, ..) => FriezeGroup::P2mm,
        (true, false, true, _) | (true, false, false, true) | (false, false, true, true) => FriezeGroup::P2mg,
        (false, true, ..) => FriezeGroup::P11m,
        (true, ..) => FriezeGroup::P1m1,
        (_, _, true, _) => FriezeGroup::P11g,
        (.., true) => FriezeGroup::P2,
        _ => FriezeGroup::P1,
    }
}

/// A strip taken apart: what its rows are on the mean, which any movement along x leaves alone, and
/// the rest.
struct Parts {
    rows: Vec<f64>,
    detail: Raster,
}

impl Parts {
    fn new(strip: &Raster) -> Self {
        let mean = |y: usize| strip.row(y).iter().sum::<f64>() / strip.width as f64;
        let rows: Vec<f64> = (0..strip.height).map(mean).collect();
        let detail = Raster::from_fn(strip.width, strip.height, |x, y| strip.at(x, y) - rows[y]);
        Self { rows, detail }
    }

    /// Best correlation with the image under x → c − x.
    fn across(&self) -> f64 {
        let energy: f64 = self.detail.values.iter().map(|v| v * v).sum();
        let width = self.detail.width;
        let product = |c: usize| {
            let row = |y: usize| {
                let row = self.detail.row(y);
                (0..width).map(|x| row[x] * row[(c + width - x) % width]).sum::<f64>()
            };
            (0..self.detail.height).map(row).sum::<f64>()
        };
        (0..width).map(product).fold(0.0, f64::max) / energy.max(f64::MIN_POSITIVE)
    }

    /// Best correlation over all axes with the image under y → d − y, x → x + `moved`.
    fn along(&self, moved: usize) -> f64 {
        let width = self.detail.width;
        self.over_axes(|x| (x + moved) % width)
    }

    /// Best correlation over all centres with the image under y → d − y, x → c − x.
    fn turned(&self) -> f64 {
        let width = self.detail.width;
        (0..width).map(|c| self.over_axes(|x| (c + width - x) % width)).fold(0.0, f64::max)
    }

    /// Best correlation over the axes d whose image covers most of the pattern and whose rows do
    /// not differ.
    fn over_axes(&self, image_x: impl Fn(usize) -> usize) -> f64 {
        let (width, height) = (self.detail.width, self.detail.height);
        let energy: f64 = self.detail.values.iter().map(|v| v * v).sum();
        let agreement = |d: usize| {
            // Products and energies of the rows that the image covers: of the detail, of the rows'
            // means.
            let (mut product, mut covered, mut rows, mut rows_covered) = (0.0, 0.0, 0.0, 0.0);
            for y in (0..height).filter(|y| d >= *y && d - y < height) {
                let (row, image) = (self.detail.row(y), self.detail.row(d - y));
                product += (0..width).map(|x| row[x] * image[image_x(x)]).sum::<f64>();
                covered += row.iter().map(|v| v * v).sum::<f64>();
                rows += width as f64 * self.rows[y] * self.rows[d - y];
                rows_covered += width as f64 * self.rows[y] * self.rows[y];
            }
            if covered < LEAST_COVERED * energy {
                return 0.0;
            }
            let detail = product / covered.max(f64::MIN_POSITIVE);
            // The rows' means hold what slow light the strip has left: they veto, but do not
            // measure.
            let differ = rows_covered >= 0.05 * covered && rows < LEAST_OF_ROWS * rows_covered;
            if differ { detail.min(rows / rows_covered) } else { detail }
        };
        (0..2 * height - 1).map(agreement).fold(0.0, f64::max)
    }
}

/// A strip of mean 0, no larger than [`LONGEST`] by [`HIGHEST`] and of even length.
fn reduced(strip: &Raster) -> Raster {
    let (columns, rows) = (strip.width.div_ceil(LONGEST), strip.height.div_ceil(HIGHEST).max(1));
    let (width, height) = (strip.width / columns / 2 * 2, strip.height / rows);
    let mean = strip.mean();
    Raster::from_fn(width.max(2), height.max(1), |x, y| {
        let part =
            |i: usize, n: usize, whole: usize| i * whole / n..((i + 1) * whole / n).max(i * whole / n + 1);
        let (mut sum, mut count) = (0.0, 0.0);
        for v in part(y, height.max(1), strip.height) {
            for u in part(x, width.max(2), strip.width) {
                sum += strip.at(u.min(strip.width - 1), v.min(strip.height - 1)) - mean;
                count += 1.0;
            }
        }
        sum / count
    })
}
