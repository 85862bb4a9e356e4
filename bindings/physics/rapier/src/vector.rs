//! Vectors of rapier and of the rules of pairs: they may be of two releases of one library, so they
//! come and go as arrays.

use asperity_pairs::Vec3;
use rapier3d::prelude::Vector;

/// As rapier takes it.
pub(crate) fn own(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

/// As the rules take it.
pub(crate) fn vec3(v: Vector) -> Vec3 {
    Vec3::from_array(v.to_array())
}
