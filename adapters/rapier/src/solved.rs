//! A contact as the solver left it: the impulse-weighted mean of a pair's points.

use crate::view::View;
use rapier3d::prelude::*;

#[derive(Clone, Copy)]
pub(crate) struct Solved {
    /// Where, in space, m.
    pub point_m: Vector,
    /// Of length 1, from the first collider to the second.
    pub normal: Vector,
    /// Along the normal, over the whole step, N·s.
    pub impulse_n_s: f32,
    pub restitution: f32,
}

impl Solved {
    /// `None` when nothing presses.
    pub fn of(pair: &ContactPair, view: &View<'_>) -> Option<Self> {
        let first = view.colliders.get(pair.collider1)?.position();
        let (mut point_m, mut normal, mut impulse_n_s, mut restitution) =
            (Vector::ZERO, Vector::ZERO, 0.0, 0.0f32);
        for manifold in pair.solver_manifolds() {
            // A point of a compound is told in the space of its part.
            let place = manifold.subshape_pos1().map_or(*first, |part| *first * part);
            for contact in &manifold.points {
                let impulse = contact.data.impulse;
                point_m += place * contact.local_p1 * impulse;
                normal += manifold.data.normal * impulse;
                impulse_n_s += impulse;
                restitution = restitution.max(manifold.data.restitution);
            }
        }
        (impulse_n_s > 0.0).then(|| Self {
            point_m: point_m / impulse_n_s,
            normal: normal.normalize_or_zero(),
            impulse_n_s,
            restitution,
        })
    }
}
