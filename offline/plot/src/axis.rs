//! Axes: ranges, ticks and SI prefixes.

/// One axis of a panel.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity on the axis.
    pub label: String,
    /// Unit without prefix (`m`, `s`, `Hz`, `N·s`); `dB`, `%` and an empty unit take no prefix.
    pub unit: String,
    /// Logarithmic.
    pub log: bool,
    /// Ends; none = as the data need.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis.
    #[must_use]
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), log: false, range: None }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { log: true, ..Self::new(label, unit) }
    }

    /// Sets the ends.
    #[must_use]
    pub fn range(mut self, from: f64, to: f64) -> Self {
        self.range = Some([from, to]);
        self
    }

    /// Starts at zero and leaves room above `high`, for things that are never negative.
    #[must_use]
    pub fn above_zero(self, high: f64) -> Self {
        let high = if high.is_finite() && high > 0.0 { high } else { 1.0 };
        self.range(0.0, high * 1.15)
    }
}

const PREFIXES: [(f64, &str); 9] = [
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
    (1e-15, "f"),
];

/// The factor and the prefix that bring `size` into 1–1000.
fn prefix(size: f64, unit: &str) -> (f64, &'static str) {
    if unit.is_empty() || unit == "dB" || unit == "%" || !(size.is_finite() && size > 0.0) {
        return (1.0, "");
    }
    PREFIXES
        .iter()
        .find(|(factor, _)| size >= factor * 0.999_999)
        .copied()
        .unwrap_or(PREFIXES[PREFIXES.len() - 1])
}

/// A value with its unit and the prefix that fits, three digits: `12.3 µm`.
#[must_use]
pub fn quantity(value: f64, unit: &str) -> String {
    let (factor, name) = prefix(value.abs(), unit);
    let scaled = value / factor;
    let digits = match scaled.abs() {
        size if size >= 99.95 || size == 0.0 => 0,
        size if size >= 9.995 => 1,
        _ => 2,
    };
    let space = if unit == "%" { "" } else { " " };
    format!("{}{space}{name}{unit}", minus(&format!("{scaled:.digits$}"))).trim_end().to_owned()
}

/// A difference in decibels with its sign, one digit, no −0.0: `+1.2`, `−0.1`.
#[must_use]
pub fn decibels(value: f64) -> String {
    let tenths = (10.0 * value).round() / 10.0;
    if tenths == 0.0 { "0.0".to_owned() } else { minus(&format!("{tenths:+.1}")) }
}

/// A count and what is counted: `1 event`, `2 events`.
#[must_use]
pub fn counted(count: u64, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A typographic minus.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}

/// A tick: where, and what stands there (nothing at a minor one).
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Position in the axis' own unit.
    pub at: f64,
    /// Number, or empty.
    pub text: String,
}

/// An axis ready to draw: maps values to 0–1.
#[derive(Debug, Clone)]
pub struct Ruler {
    /// Ends.
    pub range: [f64; 2],
    /// Logarithmic.
    pub log: bool,
    /// Ticks inside the ends.
    pub ticks: Vec<Tick>,
    /// `height (µm)`.
    pub caption: String,
}

impl Ruler {
    /// Fits an axis to data that reach from `low` to `high`, with about `count` ticks.
    #[must_use]
    pub fn new(axis: &Axis, low: f64, high: f64, count: usize) -> Self {
        if axis.log {
            Self::logarithmic(axis, low, high, count)
        } else {
            Self::linear(axis, low, high, count)
        }
    }

    fn linear(axis: &Axis, low: f64, high: f64, count: usize) -> Self {
        let [from, to] = axis.range.unwrap_or_else(|| padded(low, high));
        let (factor, name) = prefix(from.abs().max(to.abs()), &axis.unit);
        // An axis may run downwards, as the rows of a map do.
        let (low, high) = (from.min(to), from.max(to));
        let inside = |step: f64| {
            let first = (low / factor / step - 1e-9).ceil() as i64;
            let last = (high / factor / step + 1e-9).floor() as i64;
            first..=last.min(first + 50)
        };
        // One number says nothing about a scale.
        let step = (count..count + 8)
            .map(|count| nice_step((high - low) / factor, count))
            .find(|step| inside(*step).count() > 1)
            .unwrap_or_else(|| nice_step((high - low) / factor, count));
        let digits = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let ticks = inside(step)
            .map(|index| {
                let value = index as f64 * step;
                Tick { at: value * factor, text: minus(&format!("{value:.digits$}")) }
            })
            .collect();
        Self { range: [from, to], log: false, ticks, caption: caption(&axis.label, name, &axis.unit) }
    }

    fn logarithmic(axis: &Axis, low: f64, high: f64, count: usize) -> Self {
        let [from, to] = axis.range.unwrap_or([low / 1.3, high * 1.3]);
        let usable = from.is_finite() && to.is_finite() && from > 0.0 && to > from;
        let (from, to) = if usable { (from, to) } else { (1.0, 10.0) };
        let decades = (to / from).log10();
        // `1k` is half as wide as `1.75`.
        let every = (decades / (2 * count).max(1) as f64).ceil().max(1.0) as i64;
        let tens = (from.log10() - 1e-9).ceil() as i64..=(to.log10() + 1e-9).floor() as i64;
        // One number says nothing about a scale.
        let dense = decades * 3.0 <= count as f64 || tens.count() < 2;
        let numbered: &[i64] = if dense { &[1, 2, 5] } else { &[1] };
        let mut ticks = Vec::new();
        for decade in from.log10().floor() as i64..=to.log10().ceil() as i64 {
            for digit in 1..10 {
                let at = digit as f64 * 10f64.powi(decade as i32);
                if at < from * 0.999_999 || at > to * 1.000_001 || (every > 1 && digit > 1) {
                    continue;
                }
                let named = numbered.contains(&digit) && decade.rem_euclid(every) == 0;
                ticks.push(Tick { at, text: if named { short(at, &axis.unit) } else { String::new() } });
            }
        }
        Self { range: [from, to], log: true, ticks, caption: caption(&axis.label, "", &axis.unit) }
    }

    /// Position of a value between the ends, 0–1 inside.
    #[must_use]
    pub fn place(&self, value: f64) -> f64 {
        let [from, to] = self.range;
        if self.log {
            (value.max(f64::MIN_POSITIVE) / from).ln() / (to / from).ln()
        } else {
            (value - from) / (to - from)
        }
    }
}

/// `label (µm)`.
fn caption(label: &str, prefix: &str, unit: &str) -> String {
    match (label.is_empty(), unit.is_empty()) {
        (_, true) => label.to_owned(),
        (true, false) => format!("{prefix}{unit}"),
        (false, false) => format!("{label} ({prefix}{unit})"),
    }
}

/// A number on a logarithmic axis: `20`, `1k`, `100n`.
fn short(value: f64, unit: &str) -> String {
    if unit.is_empty() && !(1e-2..1e4).contains(&value) {
        return power_of_ten(value);
    }
    let (factor, name) = prefix(value, unit);
    let scaled = value / factor;
    let text = format!("{scaled:.6}");
    format!("{}{name}", text.trim_end_matches('0').trim_end_matches('.'))
}

/// `10⁻⁴`, `2·10⁻⁴`.
fn power_of_ten(value: f64) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let power = (value.log10() + 1e-9).floor();
    let digit = (value / 10f64.powf(power)).round() as u32;
    let raised: String = format!("{power:.0}")
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]))
        .collect();
    if digit == 1 { format!("10{raised}") } else { format!("{digit}·10{raised}") }
}

/// A little room around the data; room where there is one value only.
fn padded(low: f64, high: f64) -> [f64; 2] {
    if !(low.is_finite() && high.is_finite() && high >= low) {
        return [0.0, 1.0];
    }
    let room = (high - low) * 0.06;
    if room > f64::MIN_POSITIVE {
        [low - room, high + room]
    } else {
        let room = if low == 0.0 { 1.0 } else { low.abs() * 0.1 };
        [low - room, high + room]
    }
}

/// 1, 2 or 5 times a power of ten, so that `span` holds about `count` steps.
fn nice_step(span: f64, count: usize) -> f64 {
    let rough = (span / count.max(1) as f64).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(rough.log10().floor());
    let digit = rough / power;
    let nice = if digit <= 1.0 {
        1.0
    } else if digit <= 2.0 {
        2.0
    } else if digit <= 5.0 {
        5.0
    } else {
        10.0
    };
    nice * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_take_the_prefix_that_fits() {
        assert_eq!(quantity(1.234e-5, "m"), "12.3 µm");
        assert_eq!(quantity(0.0, "N"), "0 N");
        assert_eq!(quantity(-0.25, "N·s"), "−250 mN·s");
        assert_eq!(quantity(44_100.0, "Hz"), "44.1 kHz");
        assert_eq!(quantity(-61.25, "dB"), "−61.2 dB");
        assert_eq!([-0.04, -0.06, 1.23].map(decibels), ["0.0", "−0.1", "+1.2"]);
        assert_eq!([counted(0, "event"), counted(1, "event")], ["0 events", "1 event"]);
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let ruler = Ruler::new(&Axis::new("height", "m"), -1.3e-4, 2.2e-4, 5);
        assert_eq!(ruler.caption, "height (µm)");
        let texts: Vec<&str> = ruler.ticks.iter().map(|tick| tick.text.as_str()).collect();
        assert_eq!(texts, ["−100", "0", "100", "200"]);
    }

    #[test]
    fn an_axis_may_run_downwards() {
        let ruler = Ruler::new(&Axis::new("v", "m").range(0.1, 0.0), 0.0, 0.0, 3);
        assert!(ruler.ticks.len() >= 2);
        assert_eq!((ruler.place(0.1), ruler.place(0.0)), (0.0, 1.0));
    }

    #[test]
    fn a_frequency_axis_names_its_decades() {
        let ruler = Ruler::new(&Axis::log("frequency", "Hz").range(20.0, 20_000.0), 0.0, 0.0, 9);
        let texts: Vec<&str> =
            ruler.ticks.iter().map(|tick| tick.text.as_str()).filter(|text| !text.is_empty()).collect();
        assert_eq!(texts, ["20", "50", "100", "200", "500", "1k", "2k", "5k", "10k", "20k"]);
        // One decade alone is no scale, however low the panel.
        let low = Ruler::new(&Axis::log("frequency", "Hz").range(20.0, 800.0), 0.0, 0.0, 2);
        assert_eq!(low.ticks.iter().filter(|tick| !tick.text.is_empty()).count(), 5);
        assert!((ruler.place(200.0) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn data_without_extent_or_meaning_still_get_an_axis() {
        for (low, high) in [(0.0, 0.0), (5.0, 5.0), (f64::INFINITY, f64::NEG_INFINITY), (f64::NAN, 1.0)] {
            let ruler = Ruler::new(&Axis::new("x", "m"), low, high, 5);
            assert!(ruler.range[0] < ruler.range[1] && !ruler.ticks.is_empty());
            let ruler = Ruler::new(&Axis::log("x", "m"), low, high, 5);
            assert!(ruler.range[0] < ruler.range[1]);
        }
    }
}
