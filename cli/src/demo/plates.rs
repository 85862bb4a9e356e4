//! The six plates of the Hasti study (§V, Fig. 9), drawn from formulas.
//!
//! The paper gives the diameter (140 mm), the names and the scale of its height maps (4 mm);
//! wavelengths and profiles are ours. Two plates are flat and differ only in the roughness map;
//! four have relief.

use asperity_evidence::plates;

/// Width and height of a plate's maps, m.
pub const SIDE_M: f64 = 0.14;
/// Height of white over black in every displacement map, m.
pub const RELIEF_M: f64 = 0.004;
/// Pixels a side of a displacement map.
const DISPLACEMENT_PX: usize = 1024;
/// Pixels a side of a roughness map.
const ROUGHNESS_PX: usize = 256;
/// A plate: names, and what to notice.
#[derive(Debug, Clone, Copy)]
pub struct Plate {
    /// File stem.
    pub name: &'static str,
    /// Headline of the index.
    pub title: &'static str,
    /// Hints on what to listen to and look at.
    pub notice: &'static str,
    /// Pad displacement at sample value 1 of the haptic file, m.
    pub full_scale_m: f64,
}

/// The six, in the order of the paper's figure.
pub const PLATES: [Plate; 6] = [
    Plate {
        name: "matte-shiny",
        title: "Matte, then shiny",
        notice: "No relief at all, only the roughness map: the first half hisses and tingles, the second half is \
                 calm. On the way back the order is reversed.",
        full_scale_m: 3e-4,
    },
    Plate {
        name: "shiny-matte",
        title: "Shiny, then matte",
        notice: "The mirror image: only the place of the finger tells the two apart.",
        full_scale_m: 3e-4,
    },
    Plate {
        name: "ridge",
        title: "A single ridge",
        notice: "One soft bump of 4 mm in the middle of a smooth plate, crossed once slowly and once fast.",
        full_scale_m: 0.002,
    },
    Plate {
        name: "bumps",
        title: "Bumps",
        notice: "Round bumps of 1 mm on a 7 mm grid: rhythm rises with the speed of the finger.",
        full_scale_m: 0.001,
    },
    Plate {
        name: "sine",
        title: "Sine wave",
        notice: "1 mm waves of 7 mm length. The lowest line of the haptic spectrogram is speed over wavelength.",
        full_scale_m: 0.001,
    },
    Plate {
        name: "sawtooth",
        title: "Sawtooth",
        notice: "1 mm teeth, 7 mm apart: the finger falls off each one, and each fall is a click. Against the \
                 teeth, on the way back, it climbs them instead.",
        full_scale_m: 0.001,
    },
];

impl Plate {
    /// The 16-bit displacement map: pixels a side and grey values, top row first.
    #[must_use]
    pub fn displacement(&self) -> (usize, Vec<u16>) {
        let value = |x, y| {
            (plates::height_m(self.name, x, y) / RELIEF_M * 65_535.0).round().clamp(0.0, 65_535.0) as u16
        };
        (DISPLACEMENT_PX, raster(DISPLACEMENT_PX, value))
    }

    /// The 8-bit roughness map.
    #[must_use]
    pub fn roughness(&self) -> (usize, Vec<u8>) {
        let value = |x, _| (plates::roughness(self.name, x) * 255.0).round().clamp(0.0, 255.0) as u8;
        (ROUGHNESS_PX, raster(ROUGHNESS_PX, value))
    }
}

/// Samples a function at texel centres.
fn raster<T>(side: usize, value: impl Fn(f64, f64) -> T) -> Vec<T> {
    let at = |index: usize| (index as f64 + 0.5) / side as f64 * SIDE_M;
    (0..side * side).map(|index| value(at(index % side), at(index / side))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_plates_differ_only_in_roughness_and_mirror_each_other() {
        let [first, second, ..] = PLATES;
        assert!(first.displacement().1.iter().all(|&grey| grey == 0));
        assert_eq!(first.displacement(), second.displacement());
        let mirrored: Vec<u8> =
            first.roughness().1.chunks(ROUGHNESS_PX).flat_map(|row| row.iter().rev().copied()).collect();
        assert_eq!(mirrored, second.roughness().1);
    }

    #[test]
    fn the_ridge_uses_the_whole_range_and_the_rest_stays_below() {
        let peak = |name: &str| {
            let plate = PLATES.iter().find(|plate| plate.name == name).unwrap();
            f64::from(*plate.displacement().1.iter().max().unwrap()) / 65_535.0 * RELIEF_M
        };
        assert!((peak("ridge") - 0.004).abs() < 2e-5);
        for name in ["bumps", "sine", "sawtooth"] {
            assert!((peak(name) - 0.001).abs() < 3e-5, "{name}: {}", peak(name));
        }
    }
}
