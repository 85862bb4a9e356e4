//! Border terms of finite differences: their share of a field that does not tile.
//!
//! At the border a central difference of a mirrored image is half the difference to the only
//! neighbour (mirrored beyond the last texel), or none (mirrored at the last texel). Converters
//! take the one, the other, or the whole difference, which is twice the first. Which it was is read
//! from the field, by regression of the border's slopes on those expected from the two next to
//! them, 3/2 s₁ − 1/2 s₂.

use super::Slopes;

/// Share of a field's borders in the difference to the only neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BorderShare {
    None,
    Half,
    Whole,
}

impl BorderShare {
    pub(super) fn of(field: &Slopes) -> Self {
        let (w, h) = (field.along_u.width, field.along_u.height);
        if w.min(h) < 6 {
            return Self::Whole;
        }
        let (mut both, mut expected) = (0.0, 0.0);
        let mut regress = |border: f64, next: f64, after: f64| {
            let slope = 1.5 * next - 0.5 * after;
            both += border * slope;
            expected += slope * slope;
        };
        for y in 0..h {
            let row = field.along_u.row(y);
            regress(row[0], row[1], row[2]);
            regress(row[w - 1], row[w - 2], row[w - 3]);
        }
        for x in 0..w {
            let at = |y| field.along_v.at(x, y);
            regress(at(0), at(1), at(2));
            regress(at(h - 1), at(h - 2), at(h - 3));
        }
        match both / expected {
            share if share < 0.25 => Self::None,
            share if share < 0.75 => Self::Half,
            _ => Self::Whole,
        }
    }
}
