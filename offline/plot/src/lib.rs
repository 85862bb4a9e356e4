//! Pictures a person understands at a glance, as SVG that needs no font and no viewer but a
//! browser.
//!
//! A [`Figure`] is rows of [`Panel`]s; a panel is two [`Axis`] and [`Layer`]s drawn in order. Units
//! stand on the axes with the prefix that fits (µm, ms, kHz). A line of any length is drawn by its
//! smallest and largest value a pixel column, so that no click is lost and a minute costs no more
//! than a second.
//!
//! ```
//! use asperity_plot::{Axis, Figure, Panel, SpectrogramOptions, spectrogram};
//!
//! let samples: Vec<f32> = (0..4800).map(|n| (n as f32 * 0.06).sin()).collect();
//! let mut figure = Figure::new("tile.wav");
//! let panel = Panel::new("recording", Axis::new("time", "s"), Axis::log("frequency", "Hz"));
//! figure.row(220.0, [panel.with(spectrogram(&samples, 48_000.0, &SpectrogramOptions::default()))]);
//! assert!(figure.svg().starts_with("<svg"));
//! ```
//!
//! The SVG is written by hand: a plotting library brings four packages and cannot place a picture.

mod axis;
pub mod colour;
mod decimate;
mod draw;
pub mod pixels;
mod spectrogram;
mod svg;

pub use axis::{Axis, counted, decibels, quantity};
pub use colour::palette;
pub use spectrogram::{SpectrogramOptions, spectrogram, third_octaves};
pub use svg::{Svg, TextStyle};

/// One picture.
#[derive(Debug, Clone)]
pub struct Figure {
    /// First line, large.
    pub title: String,
    /// Lines below it, small.
    pub subtitle: Vec<String>,
    /// Width of the whole picture.
    pub width_px: f64,
    rows: Vec<Row>,
}

#[derive(Debug, Clone)]
struct Row {
    height_px: f64,
    panels: Vec<Panel>,
}

impl Figure {
    /// A figure without panels, 1200 pixels wide.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), subtitle: Vec::new(), width_px: 1200.0, rows: Vec::new() }
    }

    /// Adds a line below the title.
    #[must_use]
    pub fn subtitle(mut self, line: impl Into<String>) -> Self {
        self.subtitle.push(line.into());
        self
    }

    /// Adds a row of panels side by side, each as wide as its weight asks, with plots `height_px`
    /// high.
    pub fn row(&mut self, height_px: f64, panels: impl IntoIterator<Item = Panel>) {
        self.rows.push(Row { height_px, panels: panels.into_iter().collect() });
    }

    /// The picture.
    #[must_use]
    pub fn svg(&self) -> String {
        draw::figure(self)
    }
}

/// One coordinate system.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Short; what is seen.
    pub title: String,
    /// Share of the row's width.
    pub weight: f64,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Makes a unit as long across as down, as on a map; needs both axes' ranges.
    pub true_scale: bool,
    /// Back to front.
    pub layers: Vec<Layer>,
}

impl Panel {
    /// A panel without layers.
    #[must_use]
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), weight: 1.0, x, y, true_scale: false, layers: Vec::new() }
    }

    /// Makes a unit as long across as down.
    #[must_use]
    pub fn true_scale(mut self) -> Self {
        self.true_scale = true;
        self
    }

    /// Sets the share of the row's width.
    #[must_use]
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }

    /// Adds a layer in front.
    #[must_use]
    pub fn with(mut self, layer: impl Into<Layer>) -> Self {
        self.layers.push(layer.into());
        self
    }
}

/// Values to draw.
#[derive(Debug, Clone)]
pub enum Series {
    /// `y[i]` at `start + i · step`; the fastest for signals.
    Uniform {
        /// Abscissa of the first value.
        start: f64,
        /// Distance of two values.
        step: f64,
        /// The values; anything not finite is a gap.
        y: Vec<f64>,
    },
    /// Any points.
    Points(Vec<[f64; 2]>),
}

impl Series {
    /// A signal sampled at `rate_hz` from `start_s` on.
    #[must_use]
    pub fn signal(samples: impl IntoIterator<Item = f64>, rate_hz: f64, start_s: f64) -> Self {
        Self::Uniform { start: start_s, step: 1.0 / rate_hz, y: samples.into_iter().collect() }
    }

    /// A signal that holds each report's value until the next one, as the mean of `over_s` about
    /// each sample: without the stairs.
    #[must_use]
    pub fn of_reports(samples: &[f64], over_s: f64, rate_hz: f64, start_s: f64) -> Self {
        let sums: Vec<f64> = std::iter::once(0.0)
            .chain(samples.iter().scan(0.0, |sum, x| {
                *sum += x;
                Some(*sum)
            }))
            .collect();
        let half = (0.5 * over_s * rate_hz) as usize;
        let mean = |at: usize| {
            let (first, end) = (at.saturating_sub(half), (at + half + 1).min(samples.len()));
            (sums[end] - sums[first]) / (end - first) as f64
        };
        Self::signal((0..samples.len()).map(mean), rate_hz, start_s)
    }
}

/// Contents of a panel.
#[derive(Debug, Clone)]
pub enum Layer {
    /// A line, and the area below it when `fill` holds a colour.
    Line {
        /// In the legend; empty = not there.
        label: String,
        /// Stroke colour; empty = no stroke.
        colour: String,
        /// Stroke width.
        width_px: f64,
        /// Colour of the area between the line and the panel's bottom.
        fill: Option<String>,
        /// Stroke of dashes.
        dashed: bool,
        /// Values.
        data: Series,
    },
    /// Vertical lines from the bottom up to each value: impulses, mode amplitudes.
    Stems {
        /// In the legend; empty = not there.
        label: String,
        /// Stroke colour.
        colour: String,
        /// `[x, height]`.
        points: Vec<[f64; 2]>,
    },
    /// Dots, each with an area and perhaps a name.
    Dots {
        /// In the legend; empty = not there.
        label: String,
        /// Fill colour.
        colour: String,
        /// `[x, y]`.
        points: Vec<[f64; 2]>,
        /// Radius of each dot; one entry serves all.
        radius_px: Vec<f64>,
        /// Written beside the dots; empty = none.
        names: Vec<String>,
    },
    /// Full-height vertical rules: events.
    Rules {
        /// In the legend; empty = not there.
        label: String,
        /// Stroke colour.
        colour: String,
        /// Place.
        x: Vec<f64>,
    },
    /// A picture over a rectangle of the plane.
    Picture(Picture),
}

impl Layer {
    /// A line of 1.2 pixels.
    #[must_use]
    pub fn line(label: impl Into<String>, colour: &str, data: Series) -> Self {
        Self::Line {
            label: label.into(),
            colour: colour.to_owned(),
            width_px: 1.2,
            fill: None,
            dashed: false,
            data,
        }
    }

    /// A line with the area below it filled, as a surface is drawn.
    #[must_use]
    pub fn ground(label: impl Into<String>, data: Series) -> Self {
        Self::Line {
            label: label.into(),
            colour: palette::GROUND_EDGE.to_owned(),
            width_px: 1.0,
            fill: Some(palette::GROUND.to_owned()),
            dashed: false,
            data,
        }
    }
}

/// Colours over a rectangle; rows from the top.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Left and right edge.
    pub x: [f64; 2],
    /// Bottom and top edge.
    pub y: [f64; 2],
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Position of each pixel on the colour scale, 0–1.
    pub values: Vec<f32>,
    /// Colour scale.
    pub scale: colour::Scale,
    /// Legend of the scale: its ends and its unit; none = no colour bar.
    pub bar: Option<ColourBar>,
}

impl From<Picture> for Layer {
    fn from(picture: Picture) -> Self {
        Self::Picture(picture)
    }
}

/// Meaning of the ends of a colour scale.
#[derive(Debug, Clone)]
pub struct ColourBar {
    /// Values at 0 and 1.
    pub range: [f64; 2],
    /// Written above the bar.
    pub unit: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_below_the_title_is_broken_between_words() {
        let warning = "second strike: strike 1 of 60, at 0.100 s, is analysed until the next; ".repeat(4);
        let svg = Figure::new("hit.wav").subtitle(warning.trim()).svg();
        let texts = svg.lines().filter(|line| line.starts_with("<text") && line.contains("12.5"));
        let texts: Vec<&str> = texts.filter_map(|line| line.split(['>', '<']).nth(2)).collect();
        assert!(texts.len() > 1 && texts.iter().all(|line| line.len() < 170), "{texts:?}");
        assert_eq!(texts.join(" "), warning.trim());
    }

    #[test]
    fn reports_that_are_held_are_drawn_as_the_ramp_they_stand_for() {
        // 60 reports a second of a speed that grows by 1 a second, held at 6 kHz.
        let held: Vec<f64> = (0..6000).map(|n| (n / 100) as f64 / 60.0).collect();
        let Series::Uniform { y, .. } = Series::of_reports(&held, 1.0 / 60.0, 6000.0, 0.0) else { panic!() };
        let steepest = y[200..5800].windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        // The reports themselves step by 100 times as much.
        assert!(steepest < 2.1 / 6000.0, "{steepest}");
        assert!((y[3000] - 0.5).abs() < 0.01);
    }
}
