//! Edge modes of a map: what lies beyond its border.

/// Continuation of a map beyond its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The map repeats.
    #[default]
    Repeat,
    /// The edge texels go on for ever.
    Clamp,
    /// Every second copy is mirrored.
    Mirror,
}

impl Wrap {
    /// The texel of a row of `len` texels (at least 1) that stands at any index.
    #[must_use]
    #[inline(always)]
    pub fn index(self, index: i64, len: usize) -> usize {
        // Most are within the map, and a division takes longer than all the rest.
        if (index as u64) < len as u64 { index as usize } else { self.index_beyond(index, len) }
    }

    /// The texels at an index and at the next.
    #[must_use]
    #[inline(always)]
    pub fn index_and_next(self, index: i64, len: usize) -> [usize; 2] {
        let first = self.index(index, len);
        let next = match self {
            Self::Repeat if first + 1 < len => first + 1,
            Self::Repeat => 0,
            Self::Clamp | Self::Mirror => self.index(index + 1, len),
        };
        [first, next]
    }

    fn index_beyond(self, index: i64, len: usize) -> usize {
        let n = len as i64;
        let inside = match self {
            Self::Repeat => index.rem_euclid(n),
            Self::Clamp => index.clamp(0, n - 1),
            Self::Mirror => {
                let m = index.rem_euclid(2 * n);
                if m < n { m } else { 2 * n - 1 - m }
            }
        };
        inside as usize
    }

    /// Distance after which the surface is the same again, for a map that spans `extent_m`.
    #[must_use]
    pub fn period_m(self, extent_m: f64) -> f64 {
        match self {
            Self::Repeat => extent_m,
            Self::Clamp => f64::INFINITY,
            Self::Mirror => 2.0 * extent_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_beyond_the_edges_name_the_texel_that_shows_there() {
        let row = |wrap: Wrap| -> Vec<usize> { (-4..7).map(|i| wrap.index(i, 3)).collect() };
        assert_eq!(row(Wrap::Repeat), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(row(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
        assert_eq!(row(Wrap::Mirror), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for (index, len) in (-7..9).flat_map(|index| [(index, 3), (index, 1)]) {
                let expected = [index, index + 1].map(|index| wrap.index(index, len));
                assert_eq!(wrap.index_and_next(index, len), expected, "{wrap:?} {index} of {len}");
            }
        }
    }
}
