//! Figures and tables of the sources, computed again and put beside what is printed.
//!
//! Each is one function without arguments, so that every run gives the same numbers, but for
//! times.

mod contacts;
mod graphics;
mod metamers;
mod named;
mod sand;
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
    /// Largest difference of a column that both have, where one is claimed.
    pub within: Option<f64>,
}

/// Numbers as printed, ours, and the comparison.
type Found = (Columns, Columns, String);

/// Every computation.
pub const ALL: [Entry; 12] = [
    Entry::new("000-cycle", "Time of a haptic cycle on a solid", solids::cycle),
    Entry::new("000-fig-4", "Seven materials, named by touch", named::seven_materials),
    Entry::new("001-fig-4", "Profiles of 1/f^α noise, α = 1 and 2", contacts::profiles).within(0.1),
    Entry::new("001-fig-7", "Profile, pad and impulses of a finger on tiles", contacts::state),
    Entry::new("001-fig-10", "Six plates by touch, by ear and by both: confusions", named::six_plates),
    Entry::new(
        "002-fig-5",
        "Five surfaces and their metamers, told apart by the observer",
        metamers::told_apart,
    )
    .within(0.1),
    Entry::new("003-fig-6", "Groove of a stroke in sand whose force falls", sand::falling_force),
    Entry::new("003-fig-9", "A word written into sand (figures 9 to 12)", sand::writing).within(1e-9),
    Entry::new("004-table-6-1", "Dimensions of Brownian surfaces by four estimators", graphics::dimensions)
        .within(0.1),
    Entry::new(
        "004-fig-6-10",
        "Strength of a Brownian surface against its dimension (figures 6.10 to 6.13)",
        graphics::strength,
    )
    .within(0.0),
    Entry::new("004-fig-8-6", "Six reliefs named by groups (figures 8.6 to 8.11)", named::groups),
    Entry::new("004-table-8-1", "Right names out of five reliefs", named::right_names),
];

impl Entry {
    const fn new(name: &'static str, title: &'static str, compute: fn() -> Result<Found, String>) -> Self {
        Self { name, title, compute, within: None }
    }

    const fn within(self, within: f64) -> Self {
        Self { within: Some(within), ..self }
    }

    /// Computes it.
    ///
    /// # Errors
    /// When the engine refuses a surface.
    pub fn run(&self) -> Result<Evidence, String> {
        let (document, ours, sentence) = (self.compute)()?;
        Ok(Evidence { name: self.name, title: self.title, document, ours, sentence })
    }
}

impl Evidence {
    /// Largest difference between what is printed and ours, over the columns that both have.
    #[must_use]
    pub fn apart(&self) -> f64 {
        let both = self.document.iter().filter_map(|(name, printed)| Some((printed, self.ours.get(name)?)));
        let each = both.flat_map(|(printed, ours)| printed.iter().zip(ours));
        each.map(|(printed, ours)| (printed - ours).abs()).fold(0.0, f64::max)
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
