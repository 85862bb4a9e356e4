//! Mixtures of what two surfaces give: heights and what is felt beside them by one weight, forces by the same.

use crate::height_field::{Reaction, SurfaceBlock};

/// Moves sample `i` of `out` towards `other` by a weight.
pub(super) fn mix(out: &mut SurfaceBlock, other: &SurfaceBlock, i: usize, w: f64) {
    // Not a + w (b − a): that does not reach b exactly.
    let lerp = |a: &mut f64, b: f64| {
        if w == 1.0 {
            *a = b;
        } else if w != 0.0 {
            *a = (1.0 - w) * *a + w * b;
        }
    };
    lerp(&mut out.height_m[i], other.height_m[i]);
    lerp(&mut out.gradient[i][0], other.gradient[i][0]);
    lerp(&mut out.gradient[i][1], other.gradient[i][1]);
    lerp(&mut out.roughness[i], other.roughness[i]);
    lerp(&mut out.friction[i], other.friction[i]);
    lerp(&mut out.compliance_m_n[i], other.compliance_m_n[i]);
    out.answer.mix(i, 1.0 - w, &other.answer, w);
}

/// Adds a weighted reaction; grains keep their total momentum a second.
pub(crate) fn add(sum: Reaction, part: Reaction, weight: f64) -> Reaction {
    let weighted_rate = weight.abs() * part.grain_rate_per_s;
    let rate = sum.grain_rate_per_s + weighted_rate;
    let momentum = sum.grain_rate_per_s * sum.grain_impulse_n_s + weighted_rate * part.grain_impulse_n_s;
    Reaction {
        grain_rate_per_s: rate,
        grain_impulse_n_s: if rate > 0.0 { momentum / rate } else { 0.0 },
        stirs: sum.stirs || part.stirs,
    }
}
