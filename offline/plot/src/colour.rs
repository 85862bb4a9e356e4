//! Colours, few and always with the same meaning.

/// Colours of all pictures, by what they stand for.
pub mod palette {
    /// The surface, filled.
    pub const GROUND: &str = "#e4ddd0";
    /// The surface's edge.
    pub const GROUND_EDGE: &str = "#8c7f6a";
    /// The finger pad.
    pub const PAD: &str = "#1565c0";
    /// Collisions and impacts.
    pub const IMPACT: &str = "#d84315";
    /// Felt.
    pub const HAPTIC: &str = "#00796b";
    /// Heard.
    pub const AUDIO: &str = "#5e35b1";
    /// Distinct colours for rows of things without a meaning of their own; the first is the pad's,
    /// where it is alone.
    pub const SERIES: [&str; 8] =
        ["#1565c0", "#558b2f", "#ad1457", "#c28a00", "#455a64", "#00acc1", "#8d6e63", "#9e9d24"];
}

/// A colour scale from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Dark to bright with even steps to the eye, readable without colour vision: levels.
    Level,
    /// Inwards blue, outwards red, from 0.1 to 1 with rest in grey at 0.55; below that there is
    /// nothing: white.
    Swing,
    /// Through the colours of earth: heights under a path.
    Earth,
}

const LEVEL: [[u8; 3]; 9] = [
    [8, 8, 24],
    [32, 18, 77],
    [81, 18, 124],
    [130, 37, 129],
    [183, 55, 121],
    [229, 80, 100],
    [251, 135, 97],
    [254, 194, 135],
    [252, 250, 200],
];
const SWING: [[u8; 3]; 11] = [
    [255, 255, 255],
    [16, 60, 140],
    [46, 104, 186],
    [110, 158, 214],
    [170, 198, 226],
    [206, 214, 222],
    [222, 212, 206],
    [232, 184, 164],
    [226, 132, 104],
    [204, 74, 56],
    [150, 20, 34],
];
const EARTH: [[u8; 3]; 4] = [[94, 80, 63], [158, 139, 110], [214, 200, 174], [250, 246, 236]];

impl Scale {
    /// The colour at a position; positions outside 0–1 take the end's colour.
    #[must_use]
    pub fn at(self, position: f32) -> [u8; 3] {
        let stops: &[[u8; 3]] = match self {
            Self::Level => &LEVEL,
            Self::Swing => &SWING,
            Self::Earth => &EARTH,
        };
        let clamped = if position.is_finite() { position.clamp(0.0, 1.0) } else { 0.0 };
        let scaled = clamped * (stops.len() - 1) as f32;
        let index = (scaled as usize).min(stops.len() - 2);
        let part = scaled - index as f32;
        std::array::from_fn(|channel| {
            let (low, high) = (f32::from(stops[index][channel]), f32::from(stops[index + 1][channel]));
            (low + (high - low) * part).round() as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_grow_brighter_all_the_way() {
        let brightness = |position: f32| {
            let [r, g, b] = Scale::Level.at(position);
            0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
        };
        let steps: Vec<f32> = (0..=50).map(|i| brightness(i as f32 / 50.0)).collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0]), "{steps:?}");
    }
}
