//! Rings of frequency and sectors of direction of a spectrum, and what a field of slopes shows in
//! it.

use std::f64::consts::PI;

/// Sectors of directions whose power is measured apart. Ours: 4 to 24 differ by less than a tenth
/// of the error.
pub(super) const SECTORS: usize = 8;
/// |D|² below which a derivative sees nothing.
pub(super) const UNSEEN: f64 = 1e-9;

/// Statistics of a field of slopes at one frequency.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Seen {
    /// |D|².
    pub square: f64,
    /// |D_x* P + D_y* Q|².
    pub along: f64,
    /// |D_y P − D_x Q|²/|D|², which no surface has.
    pub across: f64,
}

/// Which ring of frequencies and which sector of directions every place of a spectrum lies in.
#[derive(Debug)]
pub(super) struct Bands {
    ring: Vec<u32>,
    sector: Vec<u8>,
    pub rings: usize,
    /// Width of a ring, radians per texel.
    pub width: f64,
    /// True where k and its mirror image are one, as in waves of a map that goes on mirrored.
    mirrored: bool,
}

impl Bands {
    /// Bands of a spectrum stored column by column, from its frequencies along u and v, radians per
    /// texel, and the rings' width.
    pub fn new(along_u: &[f64], along_v: &[f64], width: f64) -> Self {
        let places = || along_u.iter().flat_map(|&wx| along_v.iter().map(move |&wy| (wx, wy)));
        let ring: Vec<u32> = places().map(|(wx, wy)| (wx.hypot(wy) / width).round() as u32).collect();
        let rings = 1 + ring.iter().max().copied().unwrap_or(0) as usize;
        let mirrored = along_v.iter().all(|&wy| wy >= 0.0);
        Self { ring, sector: places().map(|(wx, wy)| sector(wx, wy)).collect(), rings, width, mirrored }
    }

    pub fn ring(&self, place: usize) -> usize {
        self.ring[place] as usize
    }

    /// Number of rings of all sectors.
    pub fn count(&self) -> usize {
        SECTORS * self.rings
    }

    /// Which ring of which sector, sector after sector.
    pub fn of(&self, place: usize) -> usize {
        self.sector[place] as usize * self.rings + self.ring(place)
    }

    /// Band of the same ring in the sector a quarter turn away.
    pub fn across(&self, band: usize) -> usize {
        let turned = (band / self.rings + SECTORS / 2) % SECTORS;
        let sector = if self.mirrored { (SECTORS - turned) % SECTORS } else { turned };
        sector * self.rings + band % self.rings
    }
}

/// Which sector of directions a frequency lies in; k and −k lie in the same.
fn sector(wx: f64, wy: f64) -> u8 {
    // The sectors' middles, not their edges, lie on the axes, and the smallest step decides no
    // sector.
    let turn = wy.atan2(wx).rem_euclid(PI) / PI * SECTORS as f64;
    (turn + 0.5) as u8 % SECTORS as u8
}
