//! Mixtures of what two surfaces give: heights and what is felt beside them by one weight, forces
//! by the same.

use crate::height_field::SurfaceBlock;

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
