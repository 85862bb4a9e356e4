//! Figures and tables of the sources, computed again and put beside what is printed.
//!
//! Each is one function without arguments, so that whoever runs it gets the same numbers, but for
//! times.

mod contacts;
mod graphics;
mod metamers;
mod solids;

use serde::Serialize;
use std::collections::BTreeMap;

/// Columns of numbers by name.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// A figure or table of a source beside ours.
#[derive(Debug, Clone, Serialize)]
pub struct Evidence {
    /// Name on the command line.
    pub name: &'static str,
    /// Title of what is computed.
    pub title: &'static str,
    /// Numbers as printed, where there are any.
    pub document: Columns,
    /// Numbers of this build.
    pub ours: Columns,
    /// Comparison in a sentence.
    pub sentence: String,
}

/// A computation of the list.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Name: source, then figure or table.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    compute: fn() -> Result<Found, String>,
}

/// Numbers as printed, ours, and the comparison.
type Found = (Columns, Columns, String);

/// Every computation.
pub const ALL: [Entry; 5] = [
    Entry { name: "000-cycle", title: "Time of a haptic cycle on a solid", compute: solids::cycle },
    Entry { name: "001-fig-4", title: "Profiles of 1/f^α noise, α = 1 and 2", compute: contacts::profiles },
    Entry {
        name: "002-fig-5",
        title: "Five surfaces and their metamers, told apart by the observer",
        compute: metamers::told_apart,
    },
    Entry {
        name: "004-table-6-1",
        title: "Dimensions of Brownian surfaces by four estimators",
        compute: graphics::dimensions,
    },
    Entry {
        name: "004-fig-6-10",
        title: "Strength of a Brownian surface against its dimension (figures 6.10 to 6.13)",
        compute: graphics::strength,
    },
];

impl Entry {
    /// Computes it.
    ///
    /// # Errors
    /// When the engine refuses a surface.
    pub fn run(&self) -> Result<Evidence, String> {
        let (document, ours, sentence) = (self.compute)()?;
        Ok(Evidence { name: self.name, title: self.title, document, ours, sentence })
    }
}

fn columns<const N: usize>(of: [(&str, Vec<f64>); N]) -> Columns {
    of.into_iter().map(|(name, values)| (name.to_owned(), values)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str) -> Evidence {
        ALL.into_iter().find(|entry| entry.name == name).unwrap().run().unwrap()
    }

    #[test]
    fn profiles_have_the_slopes_of_their_figure() {
        let evidence = found("001-fig-4");
        let (document, ours) = (&evidence.document["alpha"], &evidence.ours["alpha"]);
        assert_eq!(document, &[1.0, 2.0]);
        assert!(document.iter().zip(ours).all(|(a, b)| (a - b).abs() < 0.1), "{ours:?}");
    }

    #[test]
    fn dimensions_are_nearer_to_the_true_ones_than_the_printed_box_counts() {
        let evidence = found("004-table-6-1");
        let of = |columns: &Columns, name: &str| columns[name].clone();
        for (n, truth) in of(&evidence.document, "true").into_iter().enumerate() {
            assert!((of(&evidence.ours, "recommended")[n] - truth).abs() < 0.02, "{evidence:?}");
            assert!(
                (of(&evidence.ours, "probability")[n] - of(&evidence.document, "probability")[n]).abs() < 0.1
            );
        }
    }

    #[test]
    fn a_surface_is_stronger_the_higher_its_dimension() {
        let ours = found("004-fig-6-10").ours;
        for name in ["acceleration_m_s2", "orthogonal_n", "lateral_n"] {
            assert!(ours[name].windows(2).all(|pair| pair[0] > pair[1]), "{name}: {:?}", ours[name]);
        }
        assert!(ours["hurst"].is_sorted());
    }
}
