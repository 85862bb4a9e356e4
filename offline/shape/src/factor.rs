//! Sparse Cholesky factor of K − σM, and the inertia that counts the modes below a frequency.
//!
//! Below all modes (σ < 0) the matrix is positive definite and K − σM = L Lᵀ. Above some, K − σM =
//! L D Lᵀ, and by Sylvester's law as many numbers of D are negative as there are modes below σ
//! (Parlett, The Symmetric Eigenvalue Problem, ch. 3).

use crate::error::ShapeError;
use crate::system::System;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::{ldlt::factor::LdltRegularization, llt::factor::LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Most multiplications of a factor: two of them and the rest are about a minute of one processor,
/// and [`MOST_DEGREES_OF_FREEDOM`](crate::volume_mesh::MOST_DEGREES_OF_FREEDOM) then have at most
/// 182 million numbers, 1.5 GB (steps ≥ numbers² / unknowns). A thin body takes fewer for its
/// unknowns than a chunky one.
pub const MOST_STEPS: f64 = 2.2e11;

/// The order of elimination and the pattern of the factor; the same for every shift.
#[derive(Debug)]
pub struct Symbolic {
    cholesky: SymbolicCholesky<u32>,
    /// Multiplications of a factor.
    pub steps: f64,
}

/// A factor of K − σM for solving.
#[derive(Debug)]
pub struct Factor<'a> {
    symbolic: &'a SymbolicCholesky<u32>,
    values: Vec<f64>,
}

fn out_of_memory() -> ShapeError {
    ShapeError::new("", "there is not enough memory for this many unknowns", "mesh it coarser")
}

impl Symbolic {
    /// Orders the unknowns so that the factor stays small: by minimum degree or by nested
    /// dissection, whichever fills less.
    ///
    /// # Errors
    /// When memory runs out, or a factor would take more than `most_steps`.
    pub fn of(system: &System, most_steps: f64) -> Result<Self, ShapeError> {
        let (starts, rows, _) = system.shifted(0.0);
        let n = system.unknowns();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        let with = |order: SymmetricOrdering<'_, u32>| {
            factorize_symbolic_cholesky(pattern, Side::Lower, order, params).map_err(|_| out_of_memory())
        };
        let minimum_degree = with(SymmetricOrdering::Amd)?;
        let forward: Vec<u32> = crate::dissection::order(&system.nodes, &mut system.pairs())
            .into_iter()
            .flat_map(|node| [3 * node, 3 * node + 1, 3 * node + 2])
            .collect();
        let mut inverse = vec![0; n];
        for (new, &old) in forward.iter().enumerate() {
            inverse[old as usize] = new as u32;
        }
        let dissected = with(SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, n)))?;
        let smaller = dissected.len_val() < minimum_degree.len_val();
        let symbolic = if smaller { dissected } else { minimum_degree };
        let steps = steps(&symbolic);
        if steps > most_steps {
            let what = format!(
                "is too fine for a body as thick as it is: its {n} unknowns take {steps:.1e} steps of work"
            );
            return Err(ShapeError::new("", what, format!("at most {most_steps:.1e}: mesh it coarser")));
        }
        Ok(Self { cholesky: symbolic, steps })
    }

    /// Factors K − σM for a σ below all modes.
    ///
    /// # Errors
    /// When memory runs out, or the matrix is not positive definite (an element so flat that
    /// rounding wins).
    pub fn factor(&self, system: &System, sigma: f64) -> Result<Factor<'_>, ShapeError> {
        let (starts, rows, values) = system.shifted(sigma);
        let n = system.unknowns();
        let matrix =
            SparseColMatRef::new(SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows), &values);
        let scratch = self.cholesky.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| out_of_memory())?;
        let mut factor = vec![0.0; self.cholesky.len_val()];
        self.cholesky
            .factorize_numeric_llt(
                &mut factor,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| {
                let what = "its stiffness is not positive: some tetrahedra are too flat";
                ShapeError::new("", what, "mesh it anew with better elements")
            })?;
        Ok(Factor { symbolic: &self.cholesky, values: factor })
    }

    /// Number of modes, the six rigid ones included, below `frequency_hz`.
    ///
    /// # Errors
    /// When memory runs out, or a mode lies exactly there.
    pub fn modes_below(&self, system: &System, frequency_hz: f64) -> Result<usize, ShapeError> {
        let sigma = (std::f64::consts::TAU * frequency_hz).powi(2);
        let (starts, rows, values) = system.shifted(sigma);
        let n = system.unknowns();
        let matrix =
            SparseColMatRef::new(SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows), &values);
        let scratch = self.cholesky.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| out_of_memory())?;
        let mut factor = vec![0.0; self.cholesky.len_val()];
        self.cholesky
            .factorize_numeric_ldlt(
                &mut factor,
                matrix,
                Side::Lower,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| {
                ShapeError::new("--up-to", "a mode lies exactly there", "choose another frequency")
            })?;
        Ok(self.pivots(&factor).filter(|&d| d < 0.0).count())
    }

    /// The diagonal D of a factor L D Lᵀ.
    fn pivots<'a>(&'a self, factor: &'a [f64]) -> Box<dyn Iterator<Item = f64> + 'a> {
        match self.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(raw) => {
                Box::new(raw.col_ptr().iter().take(raw.ncols()).map(|&start| factor[start as usize]))
            }
            SymbolicCholeskyRaw::Supernodal(raw) => {
                let (begin, end) = (raw.supernode_begin(), raw.supernode_end());
                Box::new((0..raw.n_supernodes()).flat_map(move |s| {
                    let columns = (end[s] - begin[s]) as usize;
                    let start = raw.col_ptr_for_val()[s] as usize;
                    let length = raw.col_ptr_for_val()[s + 1] as usize - start;
                    let rows = length / columns.max(1);
                    (0..columns).map(move |j| factor[start + j * rows + j])
                }))
            }
        }
    }
}

/// Multiplications that a factor takes: the squares of its columns' lengths.
fn steps(symbolic: &SymbolicCholesky<u32>) -> f64 {
    let square = |length: usize| (length as f64).powi(2);
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(raw) => {
            raw.col_ptr().windows(2).map(|column| square((column[1] - column[0]) as usize)).sum()
        }
        SymbolicCholeskyRaw::Supernodal(raw) => (0..raw.n_supernodes())
            .map(|s| {
                let columns = (raw.supernode_end()[s] - raw.supernode_begin()[s]) as usize;
                let values = raw.col_ptr_for_val();
                let rows = (values[s + 1] - values[s]) as usize / columns.max(1);
                (0..columns).map(|j| square(rows - j)).sum::<f64>()
            })
            .sum(),
    }
}

impl Factor<'_> {
    /// Memory for [`solve`](Self::solve) of `columns` right sides at once.
    ///
    /// # Errors
    /// When it runs out.
    pub fn scratch(&self, columns: usize) -> Result<MemBuffer, ShapeError> {
        let request = self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq);
        MemBuffer::try_new(request).map_err(|_| out_of_memory())
    }

    /// Solves (K − σM) x = b in place.
    pub fn solve(&self, b: MatMut<'_, f64>, scratch: &mut MemBuffer) {
        LltRef::new(self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            b,
            Par::Seq,
            MemStack::new(scratch),
        );
    }
}
