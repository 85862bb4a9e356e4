//! Symmetries in lattice coordinates: integer matrices with translations, and the groups they make.

/// An integer 2 × 2 matrix that maps the lattice onto itself; rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Matrix(pub [[i64; 2]; 2]);

/// x → M·x + w, in lattice coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Operation {
    pub matrix: Matrix,
    pub translation: [f64; 2],
}

impl Matrix {
    pub const IDENTITY: Self = Self([[1, 0], [0, 1]]);

    pub fn determinant(self) -> i64 {
        let [[a, b], [c, d]] = self.0;
        a * d - b * c
    }

    /// Exact, because the determinant is ±1.
    pub fn inverse(self) -> Self {
        let [[a, b], [c, d]] = self.0;
        let sign = self.determinant();
        Self([[sign * d, -sign * b], [-sign * c, sign * a]])
    }

    pub fn times(self, other: Self) -> Self {
        let ([[a, b], [c, d]], [[e, f], [g, h]]) = (self.0, other.0);
        Self([[a * e + b * g, a * f + b * h], [c * e + d * g, c * f + d * h]])
    }

    pub fn apply(self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.0.map(|[a, b]| a as f64 * x + b as f64 * y)
    }

    pub fn apply_whole(self, [x, y]: [i64; 2]) -> [i64; 2] {
        self.0.map(|[a, b]| a * x + b * y)
    }

    /// 1, 2, 3, 4 or 6 for a rotation, by its trace; 0 for a reflection.
    pub fn rotation_order(self) -> usize {
        let [[a, _], [_, d]] = self.0;
        match (self.determinant(), a + d) {
            (1, 2) => 1,
            (1, -2) => 2,
            (1, -1) => 3,
            (1, 0) => 4,
            (1, 1) => 6,
            _ => 0,
        }
    }

    /// For a reflection: the shortest lattice vectors along its axis and across it, in lattice
    /// coordinates.
    pub fn axes(self) -> ([i64; 2], [i64; 2]) {
        let fixed = |sign: i64| {
            let mut found = [0, 0];
            // Entries in {−1, 0, 1} have axes with coordinates up to 2; the first primitive one is
            // enough.
            for candidate in [[1, 0], [0, 1], [1, 1], [1, -1], [2, 1], [1, 2], [2, -1], [1, -2]] {
                let image = self.apply_whole(candidate);
                if image == [sign * candidate[0], sign * candidate[1]] {
                    found = candidate;
                    break;
                }
            }
            found
        };
        (fixed(1), fixed(-1))
    }

    /// Tests whether the vectors along and across a reflection's axis span only half of the
    /// lattice.
    pub fn axes_are_centred(self) -> bool {
        let ([a, b], [c, d]) = self.axes();
        (a * d - b * c).abs() == 2
    }
}

/// All symmetries of a lattice with a reduced basis that fixes the origin, up to a relative change
/// `tolerance` of lengths and angles.
pub(super) fn holohedry(basis: [[f64; 2]; 2], tolerance: f64) -> Vec<Matrix> {
    let product = |p: [f64; 2], q: [f64; 2]| {
        let vector = |[m, n]: [f64; 2]| [0, 1].map(|k| m * basis[0][k] + n * basis[1][k]);
        let (p, q) = (vector(p), vector(q));
        p[0] * q[0] + p[1] * q[1]
    };
    let (e, f) = ([1.0, 0.0], [0.0, 1.0]);
    let lengths = (product(e, e).sqrt(), product(f, f).sqrt());
    let mut found = Vec::new();
    for code in 0..81 {
        let entry = |k: u32| i64::from(code / 3_i32.pow(k) % 3 - 1);
        let matrix = Matrix([[entry(0), entry(1)], [entry(2), entry(3)]]);
        if matrix.determinant().abs() != 1 {
            continue;
        }
        let (me, mf) = (matrix.apply(e), matrix.apply(f));
        let keeps = |before: f64, after: f64, scale: f64| (after - before).abs() <= tolerance * scale;
        if keeps(product(e, e), product(me, me), lengths.0 * lengths.0)
            && keeps(product(f, f), product(mf, mf), lengths.1 * lengths.1)
            && keeps(product(e, f), product(me, mf), lengths.0 * lengths.1)
        {
            found.push(matrix);
        }
    }
    found
}

/// The group that some matrices generate; at most the 12 members of the largest holohedry.
pub(super) fn closure(generators: &[Matrix]) -> Vec<Matrix> {
    let mut members = vec![Matrix::IDENTITY];
    let mut next = 0;
    while next < members.len() && members.len() <= 12 {
        for generator in generators {
            let product = generator.times(members[next]);
            if !members.contains(&product) {
                members.push(product);
            }
        }
        next += 1;
    }
    members
}

/// Moves the origin to a rotation centre (or onto an axis) and rounds the translations there to
/// sixths, so that the operations are an exact group. Nothing if the measured translations belong
/// to no group.
pub(super) fn snapped(measured: &[Operation]) -> Option<([f64; 2], Vec<Operation>)> {
    let rotation = measured
        .iter()
        .filter(|op| op.matrix.rotation_order() > 1)
        .max_by_key(|op| op.matrix.rotation_order());
    let reflection = measured.iter().find(|op| op.matrix.determinant() < 0);
    let origin = match (rotation, reflection) {
        (Some(op), _) => fixed_point(op),
        (None, Some(op)) => [0.5 * op.translation[0], 0.5 * op.translation[1]],
        (None, None) => return Some(([0.0; 2], measured.to_vec())),
    };
    let sixth = |t: f64| (6.0 * t).round().rem_euclid(6.0) / 6.0;
    let generators: Vec<Operation> = [rotation, reflection]
        .into_iter()
        .flatten()
        .map(|op| {
            let image = op.matrix.apply(origin);
            let at_origin = [0, 1].map(|k| sixth(op.translation[k] + image[k] - origin[k]));
            Operation { matrix: op.matrix, translation: at_origin }
        })
        .collect();
    let mut members = vec![Operation { matrix: Matrix::IDENTITY, translation: [0.0; 2] }];
    let mut next = 0;
    while next < members.len() {
        for generator in &generators {
            let product = composed(generator, &members[next], sixth);
            match members.iter().find(|op| op.matrix == product.matrix) {
                // Two different translations for one matrix: not a group on this lattice.
                Some(known) if known.translation != product.translation => return None,
                Some(_) => {}
                None => members.push(product),
            }
        }
        next += 1;
    }
    (members.len() == measured.len()).then_some((origin, members))
}

/// First `inner`, then `outer`.
fn composed(outer: &Operation, inner: &Operation, sixth: impl Fn(f64) -> f64) -> Operation {
    let image = outer.matrix.apply(inner.translation);
    Operation {
        matrix: outer.matrix.times(inner.matrix),
        translation: [0, 1].map(|k| sixth(image[k] + outer.translation[k])),
    }
}

/// The centre o = M·o + w of a rotation.
fn fixed_point(op: &Operation) -> [f64; 2] {
    let [[a, b], [c, d]] = op.matrix.0.map(|row| row.map(|v| v as f64));
    let determinant = (1.0 - a) * (1.0 - d) - b * c;
    let [u, v] = op.translation;
    [((1.0 - d) * u + b * v) / determinant, (c * u + (1.0 - a) * v) / determinant]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holohedries_have_the_orders_of_the_five_lattices() {
        let root = 3.0_f64.sqrt();
        for (basis, order) in [
            ([[10.0, 1.0], [3.0, 14.0]], 2),
            ([[10.0, 0.0], [0.0, 14.0]], 4),
            ([[10.0, 4.0], [10.0, -4.0]], 4),
            ([[10.0, 2.0], [-2.0, 10.0]], 8),
            ([[10.0, 0.0], [5.0, 5.0 * root]], 12),
            ([[10.0, 0.0], [-5.0, 5.0 * root]], 12),
        ] {
            let [a, b] = super::super::lattice::reduced(basis[0], basis[1]);
            assert_eq!(holohedry([a, b], 0.03).len(), order, "{basis:?}");
        }
    }

    #[test]
    fn axes_of_a_rectangle_are_primitive_and_of_a_rhombus_centred() {
        assert!(!Matrix([[-1, 0], [0, 1]]).axes_are_centred());
        assert!(Matrix([[0, 1], [1, 0]]).axes_are_centred());
        assert_eq!(Matrix([[0, -1], [-1, 0]]).axes(), ([1, -1], [1, 1]));
    }

    #[test]
    fn a_noisy_glide_group_snaps_to_an_exact_one() {
        let pgg = [
            Operation { matrix: Matrix::IDENTITY, translation: [0.0, 0.0] },
            Operation { matrix: Matrix([[-1, 0], [0, -1]]), translation: [0.31, 0.77] },
            Operation { matrix: Matrix([[-1, 0], [0, 1]]), translation: [0.81, 0.52] },
            Operation { matrix: Matrix([[1, 0], [0, -1]]), translation: [0.49, 0.26] },
        ];
        let (origin, members) = snapped(&pgg).unwrap();
        assert!((origin[0] - 0.155).abs() < 1e-12 && (origin[1] - 0.385).abs() < 1e-12);
        let glide = members.iter().find(|op| op.matrix == pgg[2].matrix).unwrap();
        assert_eq!((members.len(), glide.translation), (4, [0.5, 0.5]));
    }
}
