//! The stress table of the lattice, the pictures that have none, all 17 wallpaper groups, and the
//! corpus.

use crate::exact_brownian;
use crate::patterns;
use crate::wallpaper;

use asperity_dsp::rng::Rng;
use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_pictures::symmetry::{
    WallpaperGroup, averaged_cell, best_lattice, find_lattice, wallpaper_group,
};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use patterns::{KINDS, Kind, ROWS, Stress, is_lattice, picture};

#[test]
fn lattices_are_found_in_every_row_of_the_stress_table() {
    const SEEDS: u64 = 4;
    let mut mean = 0.0;
    for (name, stress) in ROWS {
        let mut found = 0.0;
        for (k, kind) in KINDS.into_iter().enumerate() {
            for seed in 0..SEEDS {
                let (pattern, truth) = picture(kind, stress, 256, 1000 * k as u64 + seed + 1);
                let right = find_lattice(&pattern).is_some_and(|l| is_lattice([l.t1_px, l.t2_px], truth));
                found += f64::from(u8::from(right)) / (5 * SEEDS) as f64;
            }
        }
        assert!(found >= 0.9, "{name}: {found}");
        mean += found / ROWS.len() as f64;
    }
    assert!(mean >= 0.95, "{mean}");
}

/// Once taken for a multiple of their cell, or for translations of 4 texels at which every smooth
/// picture fits itself.
#[test]
fn a_warped_cell_is_neither_doubled_nor_lost_among_fine_ones() {
    for seed in [4, 23, 24] {
        let (pattern, truth) = picture(Kind::Rectangular, Stress::Warp(2.0), 256, 1000 + seed);
        let found = find_lattice(&pattern);
        assert!(found.is_some_and(|l| is_lattice([l.t1_px, l.t2_px], truth)), "{seed}: {found:?}");
    }
    for seed in [12, 16] {
        let pattern = wallpaper::picture(WallpaperGroup::Pgg, 256, 31 * seed + 7);
        let lattice = find_lattice(&pattern).unwrap();
        let group = wallpaper_group(&averaged_cell(&pattern, &lattice), &lattice).group;
        assert_eq!(group, WallpaperGroup::Pgg, "{seed}");
    }
}

#[test]
fn pictures_without_a_pattern_have_no_lattice() {
    let mut controls: Vec<(&str, Raster)> = Vec::new();
    for tenth in [1, 5, 9] {
        let generator = ExactBrownian::new(256, 1.0 - 0.1 * f64::from(tenth));
        controls.extend(exact_brownian::pair(&generator, 5).into_iter().map(|surface| ("Brownian", surface)));
    }
    for seed in 0..3 {
        controls.push(("blobs", patterns::blobs(256, 4.0 + 5.0 * seed as f64, seed)));
        controls.push(("grains", patterns::grains(192, 8.0 + 3.0 * seed as f64, seed)));
        controls.push(("stripes", patterns::stripes(256, 17.3, 0.4 * seed as f64, 0.3 * seed as f64, seed)));
        controls.push(("white noise", patterns::stripes(256, 1e9, 0.0, 1.0, seed)));
    }
    controls.push(("ramp", Raster::from_fn(128, 128, |x, y| (x + 2 * y) as f64)));
    controls.push(("grey", Raster::constant(128, 128, 0.5)));
    for (name, control) in &controls {
        assert!(find_lattice(control).is_none(), "{name}: {:?}", find_lattice(control));
    }
    // Five repeats on twenty texels: too few for the feature matrix; what the seam shows is the
    // pattern or nothing.
    let tiny = Raster::from_fn(20, 20, |x, y| ((x % 4) * (y % 4)) as f64);
    let found = find_lattice(&tiny).map(|lattice| [lattice.t1_px, lattice.t2_px]);
    assert!(found.is_none_or(|basis| is_lattice(basis, [[4.0, 0.0], [0.0, 4.0]])), "{found:?}");
}

/// Ripples and wrinkles: seeds and lengths that nothing was tuned on.
#[test]
fn waves_of_every_direction_and_nearly_one_length_have_no_lattice() {
    let (mut reported, mut all) = (0, 0);
    for (length, share) in [(6.5, 0.03), (11.0, 0.02), (11.0, 0.15), (20.0, 0.03), (20.0, 0.1), (25.0, 0.06)]
    {
        for seed in 500..512 {
            let picture = patterns::ring_of_waves(256, length, share, seed);
            let found = find_lattice(&picture);
            println!("{length} ±{share} {seed}: {found:?}");
            reported += usize::from(found.is_some_and(|lattice| lattice.confidence > 0.5));
            all += 1;
        }
    }
    println!("{reported} of {all} told as lattices");
    assert!(100 * reported <= 3 * all, "{reported} of {all} told as lattices");
}

#[test]
fn a_lattice_does_not_depend_on_contrast_and_survives_eight_bits() {
    let (pattern, truth) = picture(KINDS[3], ROWS[0].1, 200, 77);
    let found = find_lattice(&pattern).unwrap();
    let dim = find_lattice(&pattern.map(|v| ((v * 12.0).round() + 128.0) / 255.0)).unwrap();
    assert!(is_lattice([dim.t1_px, dim.t2_px], truth));
    for (a, b) in found.t1_px.iter().chain(&found.t2_px).zip(dim.t1_px.iter().chain(&dim.t2_px)) {
        assert!((a - b).abs() < 0.1);
    }
}

#[test]
fn fine_patterns_of_large_pictures_are_found_at_full_resolution() {
    let fine = Raster::from_fn(1600, 1200, |x, y| ((x % 6) * (y % 5)) as f64);
    let lattice = find_lattice(&fine).unwrap();
    assert!(is_lattice([lattice.t1_px, lattice.t2_px], [[6.0, 0.0], [0.0, 5.0]]), "{lattice:?}");
}

#[test]
fn all_seventeen_wallpaper_groups_are_named() {
    const SEEDS: u64 = 5;
    let mut right = 0;
    let mut wrong = String::new();
    for group in WallpaperGroup::ALL {
        let mut right_here = 0;
        for seed in 0..SEEDS {
            let pattern = wallpaper::picture(group, 256, 31 * seed + 100);
            let found = find_lattice(&pattern)
                .map(|lattice| wallpaper_group(&averaged_cell(&pattern, &lattice), &lattice).group);
            if found == Some(group) {
                right_here += 1;
            } else {
                wrong += &format!(" {}→{found:?}", group.name());
            }
        }
        // Four random blobs may almost have a symmetry more; the example `analysis_table groups`
        // asks 20 of each.
        assert!(right_here + 1 >= SEEDS, "{}, wrong:{wrong}", group.name());
        right += right_here;
    }
    assert!(right as f64 >= 0.95 * (17 * SEEDS) as f64, "wrong:{wrong}");
}

#[test]
fn a_picture_of_five_cells_gives_them_to_a_fiftieth_texel() {
    for (width, height, period) in [(96, 80, 16), (80, 64, 13), (100, 90, 16), (128, 128, 16)] {
        let tiles =
            Raster::from_fn(width, height, |x, y| if x % period < 2 || y % period < 2 { 0.2 } else { 0.7 });
        let lattice = find_lattice(&tiles).unwrap();
        let truth = period as f64;
        let off = [lattice.t1_px[0] - truth, lattice.t1_px[1], lattice.t2_px[0], lattice.t2_px[1] - truth];
        assert!(off.iter().all(|o| o.abs() < 0.02), "{width} × {height}, {period}: {lattice:?}");
    }
}

#[test]
fn averaging_within_the_fundamental_domain_removes_noise() {
    for group in [WallpaperGroup::P2, WallpaperGroup::Pgg, WallpaperGroup::P4g, WallpaperGroup::P31m] {
        // Four random blobs may almost repeat within the cell; take a motif that is clear when
        // clean.
        let clear = (11..20).find_map(|seed| {
            let clean = patterns::normalised(&wallpaper::picture(group, 192, seed));
            let lattice = find_lattice(&clean)?;
            let cell = averaged_cell(&clean, &lattice);
            let is_clear = cell.reliability > 0.99 && wallpaper_group(&cell, &lattice).group == group;
            is_clear.then_some((clean, lattice))
        });
        let (clean, lattice) = clear.unwrap();
        let mut rng = Rng::new(12);
        let noisy = clean.map(|v| v + rng.normal());
        let truth = averaged_cell(&clean, &lattice).cell;
        let averaged = averaged_cell(&noisy, &lattice);
        let symmetric = wallpaper_group(&averaged, &lattice);
        assert_eq!(
            symmetric.group, group,
            "agreement {}, reliability {}",
            symmetric.agreement, averaged.reliability
        );
        let error = |cell: &Raster| {
            cell.values.iter().zip(&truth.values).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        let (before, after) = (error(&averaged.cell), error(&symmetric.cell));
        // The mean over n images lowers the noise by √n; half of that gain is asked for.
        let asked = 0.5 * (1.0 + 1.0 / (symmetric.order as f64).sqrt());
        assert!(after < asked * before, "{}: {before} → {after}", group.name());
    }
}

/// A picture of the corpus, or nothing where it is allowed to be absent.
fn corpus(file: &str) -> Option<Raster> {
    let path = asperity_evidence::corpus::corpus(&format!("photos/{file}"))?;
    Some(load_channel(path, Channel::Luma).unwrap().raster)
}

#[test]
fn photographs_with_a_lattice_show_it_and_the_others_are_refused() {
    // Counted on the pictures: 16 bars in 1024 texels; 32 × 24 tiles in 1024 texels.
    let counted = [
        ("MetalWalkway006_1K-PNG_Color.png", [[64.0, 0.0], [0.0, 64.0]]),
        ("Facade005_tiles_albedo.jpg", [[32.0, 0.0], [0.0, 1024.0 / 24.0]]),
    ];
    for (file, truth) in counted {
        let Some(photo) = corpus(file) else { continue };
        let lattice = find_lattice(&photo).unwrap();
        assert!(is_lattice([lattice.t1_px, lattice.t2_px], truth), "{file}: {lattice:?}");
    }
    if let Some(skin) = corpus("portilla_reptil_skin.pgm") {
        // Scales in a bent hexagonal packing, about 450 on 256².
        let area = find_lattice(&skin).unwrap().cell_area_px2();
        assert!((120.0..180.0).contains(&area), "{area}");
    }
    for file in ["portilla_nuts.pgm", "skimage_gravel.png", "Bricks102_1K-JPG_Color.jpg", "skimage_brick.png"]
    {
        let Some(photo) = corpus(file) else { continue };
        assert!(find_lattice(&photo).is_none(), "{file}: {:?}", best_lattice(&photo));
    }
}
