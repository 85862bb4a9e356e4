//! A block of a map: heights, slopes and roughness along a path.

use super::{HeightMap, Roughness};
use crate::height_field::{PathBlock, SurfaceBlock};

impl HeightMap {
    /// Heights, slopes and roughness that a path meets, worked out in the memory that the block has
    /// for it.
    pub(super) fn sample_in(
        &self,
        path: &PathBlock<'_>,
        bounds_m: Option<&[[f64; 2]; 2]>,
        out: &mut SurfaceBlock,
    ) {
        let working = &mut out.working;
        let (n, of_all) = (path.len(), (widest_m(path.footprint_m), bounds_m));
        working.places.forget();
        let heights = self.dilated();
        if path.slopes {
            heights.sample_block::<true>(path, of_all, working);
            let slopes = working.samples.slope_u.iter().zip(&working.samples.slope_v).take(n);
            for (gradient, (u, v)) in out.gradient.iter_mut().zip(slopes) {
                *gradient = [*u, *v];
            }
        } else {
            heights.sample_block::<false>(path, of_all, working);
        }
        out.height_m[..n].copy_from_slice(&working.samples.value[..n]);
        if path.bare {
            return;
        }
        match &self.roughness {
            Roughness::Constant(roughness) => out.roughness[..n].fill(*roughness),
            Roughness::Map(map) => {
                map.sample_block::<false>(path, of_all, working);
                for (roughness, value) in out.roughness[..n].iter_mut().zip(&working.samples.value) {
                    *roughness = value.clamp(0.0, 1.0);
                }
            }
        }
    }

    /// Constants of a block.
    pub(super) fn tell_the_rest(&self, n: usize, out: &mut SurfaceBlock) {
        out.friction[..n].fill(self.friction);
        out.compliance_m_n[..n].fill(0.0);
        out.answer.clear();
    }
}

/// The longest of some footprints; looked at side by side.
pub(super) fn widest_m(footprint_m: &[f64]) -> f64 {
    let mut widest = [0.0; 8];
    let wider =
        |widest: &mut f64, footprint: &f64| *widest = if *footprint > *widest { *footprint } else { *widest };
    let (eights, rest) = footprint_m.as_chunks::<8>();
    for eight in eights {
        widest.iter_mut().zip(eight).for_each(|(widest, footprint)| wider(widest, footprint));
    }
    widest.iter_mut().zip(rest).for_each(|(widest, footprint)| wider(widest, footprint));
    widest.into_iter().fold(0.0, f64::max)
}
