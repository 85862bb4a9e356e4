//! Support of the surface examples: a hand that draws lines, the forces it feels and their plot,
//! pictures.
#![allow(dead_code)]

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::{ContactBlock, ModalModel, Mode, Tap};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The folder named on the command line, or one of the example's name; made if it is not there.
pub fn folder(example: &str) -> Result<PathBuf, Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from(example), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// A wooden board under the surface.
pub fn board() -> Result<ModalModel, Box<dyn Error>> {
    let modes = [(310.0, 40.0, 0.3), (720.0, 55.0, 0.2), (1390.0, 80.0, 0.12), (2650.0, 120.0, 0.07)];
    let mode = |(frequency_hz, decay_per_s, amplitude)| Mode {
        frequency_hz,
        decay_per_s,
        amplitude,
        phase_rad: 0.0,
    };
    Ok(ModalModel::new(modes.map(mode).to_vec(), 0.01)?)
}

/// A hand that goes along lines at its own pace, told 60 times a second.
pub struct Hand {
    /// Side of the square surface, m.
    pub side_m: f64,
    /// Mean speed, m/s.
    pub speed_m_s: f64,
    /// Force it presses with, N.
    pub normal_force_n: f64,
    /// What it touches.
    pub surface: &'static str,
}

impl Hand {
    /// One contact along the points of a line, beginning at `start_s`; returns when it ends.
    pub fn draw(&self, log: &mut ContactLog, contact: u64, line: &[[f64; 2]], start_s: f64) -> f64 {
        let mut length = 0.0;
        let mut at_m = vec![0.0];
        for pair in line.windows(2) {
            length += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            at_m.push(length);
        }
        let seconds = length / self.speed_m_s;
        let steps = (60.0 * seconds).ceil() as usize;
        // Slow at both ends, as a hand is.
        let place = |t: f64| {
            let x = (t / seconds).clamp(0.0, 1.0);
            let way = length * x * x * (3.0 - 2.0 * x);
            let next = at_m.iter().position(|&m| m >= way).unwrap_or(line.len() - 1).max(1);
            let f = (way - at_m[next - 1]) / (at_m[next] - at_m[next - 1]).max(1e-12);
            [0, 1].map(|a| (line[next - 1][a] + f * (line[next][a] - line[next - 1][a])) / self.side_m)
        };
        for step in 0..=steps {
            let t = step as f64 / 60.0;
            let (before, after) = (place(t - 0.004), place(t + 0.004));
            let sample = ContactSample {
                uv: place(t),
                velocity_m_s: Some([0, 1].map(|a| (after[a] - before[a]) * self.side_m / 0.008)),
                normal_force_n: self.normal_force_n,
                closing_m_s: 0.0,
                ..ContactSample::default()
            };
            let event = match step {
                0 => LogEvent::begin(contact, self.surface, 0, sample),
                _ if step == steps => LogEvent::End { contact },
                _ => LogEvent::moved(contact, sample),
            };
            log.lines.push(LogLine { t: start_s + t, event });
        }
        start_s + steps as f64 / 60.0
    }
}

/// Mean force on the finger in every millisecond, N.
pub struct Forces {
    sample_rate_hz: f64,
    sums: Vec<([f64; 3], f64)>,
}

impl Forces {
    /// Nothing felt yet.
    pub fn new(sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, sums: Vec::new() }
    }

    /// Means, one a millisecond from 0 s on.
    pub fn means_n(&self) -> Vec<[f64; 3]> {
        self.sums.iter().map(|(sum, count)| sum.map(|s| s / count.max(1.0))).collect()
    }
}

impl Tap for Forces {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        for (i, force_n) in block.force_n.iter().enumerate() {
            let sample = block.first_sample + i as u64;
            let millisecond = (sample as f64 * 1e3 / self.sample_rate_hz) as usize;
            if self.sums.len() <= millisecond {
                self.sums.resize(millisecond + 1, ([0.0; 3], 0.0));
            }
            let (sum, count) = &mut self.sums[millisecond];
            *sum = std::array::from_fn(|a| sum[a] + force_n[a]);
            *count += 1.0;
        }
    }
}

/// A plot of forces, a panel a name: along u, along v, out of the surface.
pub fn plot(panels: &[(&str, Vec<[f64; 3]>)], path: &Path) -> std::io::Result<()> {
    const WIDTH: usize = 900;
    const HEIGHT: f64 = 110.0;
    let colours = ["#c0392b", "#2471a3", "#7d8a8c"];
    let most_ms = panels.iter().map(|(_, forces)| forces.len()).max().unwrap_or(1).max(1);
    let total = HEIGHT * panels.len() as f64 + 40.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{total}\" font-family=\"sans-serif\" \
         font-size=\"12\"><rect width=\"{w}\" height=\"{total}\" fill=\"white\"/>\n",
        w = WIDTH + 160
    );
    for (n, (name, forces)) in panels.iter().enumerate() {
        let top = HEIGHT * n as f64 + 10.0;
        let peak = forces.iter().flatten().fold(1e-3_f64, |peak, f| peak.max(f.abs()));
        let y = |force: f64| top + 0.45 * HEIGHT * (1.0 - force / peak);
        let _ = writeln!(
            svg,
            "<text x=\"4\" y=\"{:.0}\">{name}</text><text x=\"4\" y=\"{:.0}\" fill=\"#888\">±{peak:.2} N</text>\
             <path d=\"M100 {:.1}h{WIDTH}\" stroke=\"#ddd\"/>",
            y(0.0),
            y(0.0) + 15.0,
            y(0.0)
        );
        for (axis, colour) in colours.iter().enumerate().rev() {
            let mut line = String::new();
            for column in 0..WIDTH {
                let range = column * most_ms / WIDTH..((column + 1) * most_ms / WIDTH).min(forces.len());
                let Some(part) = forces.get(range).filter(|part| !part.is_empty()) else { continue };
                let low = part.iter().fold(f64::INFINITY, |low, f| low.min(f[axis]));
                let high = part.iter().fold(f64::NEG_INFINITY, |high, f| high.max(f[axis]));
                let _ = write!(line, "M{} {:.1}V{:.1}", 100 + column, y(low) + 0.4, y(high) - 0.4);
            }
            let _ = writeln!(svg, "<path d=\"{line}\" stroke=\"{colour}\" fill=\"none\"/>");
        }
    }
    let _ = writeln!(
        svg,
        "<text x=\"100\" y=\"{:.0}\">0 to {:.1} s; <tspan fill=\"{}\">along u</tspan>, <tspan fill=\"{}\">along v\
         </tspan>, <tspan fill=\"{}\">out of the surface</tspan>: contact, friction and texture together</text></svg>",
        total - 10.0,
        most_ms as f64 / 1e3,
        colours[0],
        colours[1],
        colours[2]
    );
    std::fs::write(path, svg)
}

/// Heights (m) on a square of `side` points `spacing_m` apart, lit from the top left: grey, 0 to
/// 255.
pub fn lit(side: usize, spacing_m: f64, height_m: impl Fn(usize, usize) -> f64) -> Vec<u8> {
    let mut grey = Vec::with_capacity(side * side);
    for y in 0..side {
        for x in 0..side {
            let slope = |low: f64, high: f64| (high - low) / (2.0 * spacing_m);
            let u = slope(height_m(x.max(1) - 1, y), height_m((x + 1).min(side - 1), y));
            let v = slope(height_m(x, y.max(1) - 1), height_m(x, (y + 1).min(side - 1)));
            let shade = (0.8 + 0.42 * u + 0.42 * v) / (1.0 + u * u + v * v).sqrt();
            grey.push((255.0 * shade.clamp(0.0, 1.0)) as u8);
        }
    }
    grey
}
