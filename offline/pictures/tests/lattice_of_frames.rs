//! Squares in frames and the reliefs of the thesis: no quarter or fifth of the lattice, no
//! multiple.

use crate::framed;
use crate::patterns;

use asperity_pictures::symmetry::find_lattice;
use asperity_surface::raster::Raster;
use framed::{Framed, thesis_pictures};
use patterns::is_lattice;

/// Shares of pictures whose lattice is found, and a line for each other one.
fn found(pictures: impl Iterator<Item = (String, Raster, [[f64; 2]; 2])>) -> (f64, Vec<String>) {
    let (mut all, mut wrong) = (0, Vec::new());
    for (name, picture, truth) in pictures {
        let lattice = find_lattice(&picture);
        if !lattice.is_some_and(|l| is_lattice([l.t1_px, l.t2_px], truth)) {
            wrong.push(format!("{name}: {lattice:?}"));
        }
        all += 1;
    }
    (1.0 - wrong.len() as f64 / f64::from(all), wrong)
}

/// The example `analysis_table framed` asks for all 864 and 200 drawn by lot.
#[test]
fn squares_in_frames_show_their_lattice_and_no_fraction_of_it() {
    let grid = Framed::grid().into_iter().enumerate().step_by(5);
    let pictures = grid.map(|(seed, case)| (format!("{case:?}"), case.picture(seed as u64), case.truth()));
    let (share, wrong) = found(pictures);
    assert!(share >= 0.99, "{share}: {wrong:#?}");
}

#[test]
fn frames_of_any_period_show_it() {
    let cases = (1000..1030).map(|seed| (seed, Framed::drawn(seed, 5.0)));
    let (share, wrong) =
        found(cases.map(|(seed, case)| (format!("{case:?}"), case.picture(seed), case.truth())));
    assert!(share >= 0.99, "{share}: {wrong:#?}");
}

/// 9 texels of ground and 38.7 of square: lines fit lines at 11.2, which divides no period, and no
/// coarser lattice of that was the true one.
#[test]
fn a_gap_that_divides_no_period_makes_no_lattice() {
    let case = Framed {
        size: 256,
        period: 47.665_784_591_808_915,
        gap: 0.188_631_645_031_273_4,
        outline: 2.177_147_757_261_991_5,
        rounded: false,
        noise: 0.0,
    };
    let lattice = find_lattice(&case.picture(0));
    assert!(lattice.is_some_and(|l| is_lattice([l.t1_px, l.t2_px], case.truth())), "{lattice:?}");
}

#[test]
fn the_reliefs_of_the_thesis_show_their_lattices_as_heights_and_lit() {
    let (share, wrong) = found(thesis_pictures().into_iter().filter(|(name, ..)| !name.contains("400")));
    assert!(share >= 0.99, "{share}: {wrong:#?}");
}

/// Graph paper: the fine lines alone would make a lattice of a fifth.
#[test]
fn a_bold_line_in_five_makes_the_cell_five_lines_wide() {
    for (fine, bold) in [(8, 40), (10, 40), (7, 42)] {
        let paper = Raster::from_fn(256, 256, |x, y| {
            let line = |i: usize| if i % bold < 2 { 1.0 } else { 0.6 * f64::from(u8::from(i % fine < 2)) };
            f64::max(line(x), line(y))
        });
        let truth = [[bold as f64, 0.0], [0.0, bold as f64]];
        let lattice = find_lattice(&paper);
        assert!(
            lattice.is_some_and(|l| is_lattice([l.t1_px, l.t2_px], truth)),
            "{fine}, {bold}: {lattice:?}"
        );
    }
}
