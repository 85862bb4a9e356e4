//! Felt relief: the spectrum over place in third octaves, its slope, and its levels with their
//! errors.
//!
//! ```text
//! Ŝ(q) = Σ (P − N) / Σ |H|² (q/q₀)^−s / v     over the bins of a third octave about q₀, all windows
//! se = 4.34 (1 + N/(P − N)) / √((B + Δ) T)    dB;  B: width of the band, Δ: a bin, T: time
//! ```
//! s = 2.5: 40 made strokes are read no better with the slope that each band has.

use crate::db;
use crate::floor::Floor;
use crate::recording::{STANDSTILL_M_S, Window};
use serde::Serialize;

/// Third octaves of wavenumbers: centre i is at 10^(i/10) 1/m.
pub const BANDS: usize = 60;
/// Wavenumber beyond which no tip rides, 1/m: 20 µm.
const FINEST_Q: f64 = 5e4;
/// Slope of the spectrum within a third octave.
const SLOPE: f64 = 2.5;
/// Shortest time of a group, s.
const LEAST_S: f64 = 0.5;
/// Power over the floor below which a band does not count.
const LEAST_OVER_FLOOR: f64 = 0.25;
/// Error of every level that no longer recording takes away, dB.
const LEAST_SE_DB: f64 = 0.1;

/// Centre of a third octave, 1/m.
#[must_use]
pub fn wavenumber(band: usize) -> f64 {
    10f64.powf(band as f64 / 10.0)
}

/// Level of a third octave in windows of one stroke, speed and force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Group of windows.
    pub group: usize,
    /// Third octave of wavenumbers.
    pub band: usize,
    /// Frequency of its centre at the group's speed, Hz.
    pub frequency_hz: f64,
    /// Density of the felt height, dB re 1 m³.
    pub level_db: f64,
    /// Standard error of sampling, dB.
    pub se_db: f64,
}

/// Windows of one stroke at one speed and force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Stroke, by its place.
    pub stroke: usize,
    /// Mean speed, m/s.
    pub speed_m_s: f64,
    /// Mean force, N.
    pub force_n: f64,
    /// Time, s.
    pub seconds: f64,
    #[serde(skip)]
    members: Vec<usize>,
}

/// Windows sorted into groups: speeds within a third of an octave, forces within half.
#[must_use]
pub fn groups(windows: &[Window]) -> Vec<Group> {
    let mut all: Vec<(_, Group)> = Vec::new();
    for (i, window) in windows.iter().enumerate() {
        if window.speed_m_s < STANDSTILL_M_S || window.force_n <= 0.0 {
            continue;
        }
        let key = (
            window.stroke,
            (3.0 * window.speed_m_s.log2()).round() as i64,
            (2.0 * window.force_n.log2()).round() as i64,
        );
        let place = all.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            let none = Group {
                stroke: window.stroke,
                speed_m_s: 0.0,
                force_n: 0.0,
                seconds: 0.0,
                members: Vec::new(),
            };
            all.push((key, none));
            all.len() - 1
        });
        let group = &mut all[place].1;
        group.speed_m_s += window.speed_m_s;
        group.force_n += window.force_n;
        group.seconds += window.stands_for_s;
        group.members.push(i);
    }
    all.retain(|(_, group)| group.seconds >= LEAST_S);
    all.into_iter()
        .map(|(_, group)| {
            let count = group.members.len() as f64;
            Group { speed_m_s: group.speed_m_s / count, force_n: group.force_n / count, ..group }
        })
        .collect()
}

/// Levels of the felt height between two frequencies; `lines_q` are wavenumbers of lines, whose
/// bins do not count. `colour_db` is the response of the rig, where it is known.
#[must_use]
pub fn levels(
    (windows, groups): (&[Window], &[Group]),
    floors: &[Floor],
    (low_hz, high_hz): (f64, f64),
    lines: &[(f64, f64)],
    colour_db: &dyn Fn(f64) -> f64,
) -> Vec<Level> {
    let edge = 10f64.powf(0.05);
    let mut all = Vec::new();
    for (place, group) in groups.iter().enumerate() {
        let mut sums = vec![[0.0f64; 5]; BANDS];
        for window in group.members.iter().map(|i| &windows[*i]) {
            let v = window.speed_m_s;
            let floor = &floors[window.stroke].density;
            let response = &window.response;
            for (band, sum) in sums.iter_mut().enumerate() {
                let centre = wavenumber(band);
                let (from_hz, to_hz) = (centre * v / edge, centre * v * edge);
                if from_hz < low_hz || to_hz > high_hz.min(0.45 * window.rate_hz) || centre * edge > FINEST_Q
                {
                    continue;
                }
                let from = (from_hz / window.bin_hz).ceil() as usize;
                let to = ((to_hz / window.bin_hz).ceil() as usize).max(from + 1);
                for i in from..to.min(window.density.len()) {
                    let q = i as f64 * window.bin_hz / v;
                    if lines.iter().any(|(line, reach)| (q - line).abs() < reach + 2.0 * window.bin_hz / v) {
                        continue;
                    }
                    let rig = 10f64.powf(0.1 * colour_db(i as f64 * window.bin_hz));
                    // Bins weigh alike for the spectrum of a line of this slope.
                    let white = (q / centre).powf(SLOPE) / (response[i] * rig).max(f64::MIN_POSITIVE);
                    sum[0] += window.density[i] * white * v;
                    sum[1] += floor[i] * white * v;
                    sum[2] += 1.0;
                }
                sum[3] += window.stands_for_s;
                sum[4] = to_hz - from_hz + window.bin_hz;
            }
        }
        for (band, [power, floor, bins, seconds, width_hz]) in sums.into_iter().enumerate() {
            let own = power - floor;
            if bins < 1.0 || own <= LEAST_OVER_FLOOR * floor {
                continue;
            }
            let sampling = 4.34 * (1.0 + floor / own) / (width_hz * seconds).sqrt();
            all.push(Level {
                group: place,
                band,
                frequency_hz: wavenumber(band) * group.speed_m_s,
                level_db: db(own / bins),
                se_db: sampling.hypot(LEAST_SE_DB),
            });
        }
    }
    all
}

/// Third octave of the felt spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Third octave of wavenumbers.
    pub band: usize,
    /// Density, dB re 1 m³.
    pub level_db: f64,
    /// Standard error of sampling, dB.
    pub se_db: f64,
}

/// Octave of the felt height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Octave {
    /// Wavelength about which it lies, m.
    pub wavelength_m: f64,
    /// Rms, m.
    pub rms_m: f64,
    /// Standard error of sampling, dB.
    pub se_db: f64,
    /// True where the recording does not hold it, and the slope of its neighbours goes on.
    pub is_extrapolated: bool,
}

/// Spectrum that goes on beyond its bands.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum<'a> {
    bands: &'a [Band],
}

impl<'a> Spectrum<'a> {
    /// Spectrum of bands in rising order; at least two.
    #[must_use]
    pub fn new(bands: &'a [Band]) -> Self {
        Self { bands }
    }

    /// Level at a place between third octaves, dB re 1 m³: a line between bands; beyond them the
    /// slope of the last one and a half octaves at the long end, of the last two at the short one,
    /// which rises no further.
    #[must_use]
    pub fn at(&self, place: f64) -> f64 {
        let bands = self.bands;
        let point = |band: &Band| (band.band as f64, band.level_db);
        let (first, last) = match bands {
            [] => return f64::NEG_INFINITY,
            [first, .., last] => (first, last),
            [only] => (only, only),
        };
        if place <= first.band as f64 {
            let slope = slope_of(&bands[..bands.len().min(6)]).min(0.0);
            return first.level_db + slope * (place - first.band as f64);
        }
        if place >= last.band as f64 {
            let slope = slope_of(&bands[bands.len().saturating_sub(7)..]).min(0.0);
            return last.level_db + slope * (place - last.band as f64);
        }
        let next = bands.partition_point(|band| band.band as f64 <= place);
        let ((x0, y0), (x1, y1)) = (point(&bands[next - 1]), point(&bands[next]));
        y0 + (y1 - y0) * (place - x0) / (x1 - x0)
    }

    /// Octave about a wavelength.
    #[must_use]
    pub fn octave(&self, wavelength_m: f64) -> Octave {
        const STEPS: usize = 24;
        let centre = -10.0 * wavelength_m.log10();
        let half = 10.0 * std::f64::consts::SQRT_2.log10();
        let power: f64 = (0..STEPS)
            .map(|i| {
                let place = centre - half + 2.0 * half * (i as f64 + 0.5) / STEPS as f64;
                // dq = q ln 10/10 d(place)
                10f64.powf(0.1 * self.at(place) + 0.1 * place)
            })
            .sum::<f64>()
            * (2.0 * half / STEPS as f64)
            * 0.1
            * std::f64::consts::LN_10;
        let inside: Vec<f64> = self
            .bands
            .iter()
            .filter(|band| (band.band as f64 - centre).abs() <= half)
            .map(|band| band.se_db)
            .collect();
        let (first, last) = (self.bands.first(), self.bands.last());
        let reached = first.is_some_and(|band| band.band as f64 - 0.5 <= centre - half)
            && last.is_some_and(|band| band.band as f64 + 0.5 >= centre + half);
        let se = inside.iter().map(|se| se * se).sum::<f64>().sqrt() / inside.len().max(1) as f64;
        Octave {
            wavelength_m,
            rms_m: power.sqrt(),
            se_db: if inside.is_empty() { f64::INFINITY } else { se },
            is_extrapolated: !reached,
        }
    }
}

/// Slope of the best line, dB a third octave.
fn slope_of(bands: &[Band]) -> f64 {
    let count = bands.len().max(1) as f64;
    let x = bands.iter().map(|band| band.band as f64).sum::<f64>() / count;
    let xx: f64 = bands.iter().map(|band| (band.band as f64 - x).powi(2)).sum();
    let xy: f64 = bands.iter().map(|band| (band.band as f64 - x) * band.level_db).sum();
    if xx > 0.0 { xy / xx } else { 0.0 }
}
