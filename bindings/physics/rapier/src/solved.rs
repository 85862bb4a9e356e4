//! A contact as the solver left it: the impulse-weighted mean of a pair's points.

use crate::vector::vec3;
use crate::view::View;
use asperity_pairs::{Motion, Points, Solved};
use rapier3d::prelude::*;

/// `None` when nothing presses. `before`: how both moved before the step; `nominal_n`: what presses
/// where neither is moved by the other.
pub(crate) fn solved(
    pair: &ContactPair,
    view: &View<'_>,
    before: [Motion; 2],
    nominal_n: [f32; 2],
) -> Option<Solved> {
    let first = view.colliders.get(pair.collider1)?.position();
    let (mut point_m, mut normal, mut impulse_n_s, mut restitution) =
        (Vector::ZERO, Vector::ZERO, 0.0, 0.0f32);
    let mut points = Points::default();
    for manifold in pair.solver_manifolds() {
        // A point of a compound is told in the space of its part.
        let place = manifold.subshape_pos1().map_or(*first, |part| *first * part);
        for contact in &manifold.points {
            let impulse = pushed_n_s(&contact.data);
            points.add(vec3(place * contact.local_p1));
            point_m += place * contact.local_p1 * impulse;
            normal += manifold.data.normal * impulse;
            impulse_n_s += impulse;
            restitution = restitution.max(manifold.data.restitution);
        }
    }
    if impulse_n_s <= 0.0 {
        return overlapping(pair, view, nominal_n);
    }
    let (point_m, normal) = (vec3(point_m / impulse_n_s), vec3(normal.normalize_or_zero()));
    let gained_m_s = [pair.collider1, pair.collider2].map(|collider| {
        let body = view.body_of(collider).filter(|body| body.is_dynamic());
        vec3(view.gravity * (body.map_or(0.0, |body| body.gravity_scale()) * view.step_s))
    });
    let closing_m_s = Solved::closing_m_s(before, gained_m_s, point_m, normal);
    Some(Solved { point_m, normal, impulse_n_s, restitution, closing_m_s, is_nominal: false, points })
}

/// Two that the solver never pushes apart, because nothing moves either, one of them a hand or a
/// character: where they overlap they press with a nominal impulse.
fn overlapping(pair: &ContactPair, view: &View<'_>, nominal_n: [f32; 2]) -> Option<Solved> {
    let bodies = [pair.collider1, pair.collider2].map(|collider| view.body_of(collider));
    let hands = bodies.iter().zip(nominal_n).filter(|(body, _)| body.is_some_and(RigidBody::is_kinematic));
    let impulse_n_s = view.step_s * hands.fold(0.0f32, |most, (_, force_n)| most.max(force_n));
    if bodies.iter().flatten().any(|body| body.is_dynamic()) || impulse_n_s <= 0.0 {
        return None;
    }
    let first = view.colliders.get(pair.collider1)?.position();
    let (mut point_m, mut normal, mut count) = (Vector::ZERO, Vector::ZERO, 0.0);
    let mut points = Points::default();
    for manifold in manifolds(pair) {
        let place = manifold.subshape_pos1().map_or(*first, |part| *first * part);
        for contact in manifold.points.iter().filter(|contact| contact.dist <= 0.0) {
            points.add(vec3(place * contact.local_p1));
            point_m += place * contact.local_p1;
            normal += place.rotation * manifold.local_n1;
            count += 1.0;
        }
    }
    (count > 0.0).then(|| Solved {
        point_m: vec3(point_m / count),
        normal: vec3(normal.normalize_or_zero()),
        impulse_n_s,
        restitution: 0.0,
        closing_m_s: 0.0,
        is_nominal: true,
        points,
    })
}

/// Manifolds of a pair: a method from rapier 0.36 on, a field before.
#[cfg(not(feature = "bevy-rapier-0-36"))]
fn manifolds(pair: &ContactPair) -> &[ContactManifold] {
    pair.manifolds()
}

#[cfg(feature = "bevy-rapier-0-36")]
fn manifolds(pair: &ContactPair) -> &[ContactManifold] {
    &pair.manifolds
}

/// Impulse of a point in the step, N·s.
#[cfg(not(feature = "bevy-rapier-0-36"))]
fn pushed_n_s(point: &ContactData) -> f32 {
    point.impulse
}

/// Impulse in rapier 0.35, which counts what the step before handed over as well: of steps alike
/// that is what this one hands on, a quarter of the weight of what lies still.
#[cfg(feature = "bevy-rapier-0-36")]
fn pushed_n_s(point: &ContactData) -> f32 {
    (point.impulse - point.warmstart_impulse).max(0.0)
}
