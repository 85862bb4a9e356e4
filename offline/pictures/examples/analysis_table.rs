//! Prints the measured tables of the offline analysis; `dimension`, `cubes`, `lattice`, `framed`,
//! `unseen`, `controls` or `groups` prints one, names of picture files print what is found in them,
//! and `reliefs` writes the six reliefs of the thesis (§8.3) as height maps into the working
//! directory, for `asperity texture compare`. `cargo run --release -p asperity-pictures
//! --example analysis_table`

#[path = "../tests/support/exact_brownian.rs"]
mod exact_brownian;
#[path = "../tests/support/framed.rs"]
mod framed;
#[path = "../tests/support/patterns.rs"]
mod patterns;
#[path = "../tests/support/wallpaper.rs"]
mod wallpaper;

use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_pictures::fractal_dimension as fd;
use asperity_pictures::symmetry::{self, WallpaperGroup};
use asperity_surface::image_io::{Channel, load_channel, save_gray16};
use asperity_surface::raster::Raster;
use exact_brownian::{pair, quantise};
use std::time::Instant;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let asked = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    if asked("dimension") {
        dimension();
    }
    if asked("cubes") {
        cubes();
    }
    if asked("lattice") {
        lattice();
    }
    if asked("framed") {
        framed_squares();
    }
    if wanted.iter().any(|w| w == "unseen") {
        unseen();
    }
    if wanted.iter().any(|w| w == "reliefs") {
        write_reliefs();
    }
    if asked("controls") {
        controls();
    }
    if asked("groups") {
        groups();
    }
    for file in wanted.iter().filter(|w| w.contains('.')) {
        picture(file);
    }
}

/// Table 6.1 of the thesis beside ours; its pictures are not to be had, only their dimensions and
/// three sizes.
fn cubes() {
    const PAIRS: u64 = 5;
    let table = [
        (2.2, 256, [2.22, 2.21, 2.20, 2.20]),
        (2.5, 256, [2.36, 2.36, 2.36, 2.51]),
        (2.8, 256, [2.44, 2.44, 2.44, 2.78]),
        (2.7, 130, [2.39, 2.38, 2.37, 2.68]),
        (2.7, 185, [2.42, 2.42, 2.43, 2.68]),
        (2.7, 235, [2.42, 2.42, 2.43, 2.69]),
    ];
    println!("\nTable 6.1, exact Brownian surfaces, 256 levels, {} each: the document's / ours", 2 * PAIRS);
    println!("  D    side   D_B          D_I          D_C          D_P          recommended");
    for (d, size, theirs) in table {
        let generator = ExactBrownian::new(size, 3.0 - d);
        let mut ours = [0.0; 5];
        for surface in (0..PAIRS).flat_map(|seed| pair(&generator, 100 + seed)) {
            let found = fd::fractal_dimension(&quantise(&surface, 256)).unwrap().dimension;
            let all = [
                found.box_counting,
                found.information,
                found.correlation,
                found.probability,
                found.recommended,
            ];
            for (sum, value) in ours.iter_mut().zip(all) {
                *sum += value / (2 * PAIRS) as f64;
            }
        }
        print!("  {d:.1}  {size:4} ");
        for (theirs, ours) in theirs.iter().zip(ours) {
            print!("  {theirs:.2} / {ours:.2}");
        }
        println!("         / {:.2}", ours[4]);
    }
}

fn lattice() {
    const SEEDS: u64 = 24;
    println!("\nLattice, 256², {SEEDS} random patterns a kind and row: share found right");
    println!("  row         square  rectangular  rhombic  oblique  hexagonal  all     least merit   ms");
    for (name, stress) in patterns::ROWS {
        let (mut all, mut time, mut least) = (0.0, 0.0, f64::INFINITY);
        print!("  {name:10}");
        for (k, kind) in patterns::KINDS.into_iter().enumerate() {
            let mut right = 0.0;
            for seed in 0..SEEDS {
                let (pattern, truth) = patterns::picture(kind, stress, 256, 1000 * k as u64 + seed + 1);
                let start = Instant::now();
                let found = symmetry::find_lattice(&pattern);
                time += 1e3 * start.elapsed().as_secs_f64() / (5 * SEEDS) as f64;
                if let Some(l) = found.filter(|l| patterns::is_lattice([l.t1_px, l.t2_px], truth)) {
                    right += 1.0 / SEEDS as f64;
                    least = least.min(merit(l.confidence));
                }
            }
            all += right / 5.0;
            print!("  {right:8.3}");
        }
        println!("    {all:.3}   {least:6.1}     {time:.1}");
    }
}

/// What a search made of a picture whose lattice is known.
#[derive(Default)]
struct Tally {
    all: usize,
    right: usize,
    /// Lattices with a cell smaller than the true one, told with confidence.
    fractions: usize,
    none: usize,
    wrong: Vec<String>,
}

impl Tally {
    fn add(&mut self, name: &str, picture: &Raster, truth: [[f64; 2]; 2]) {
        self.all += 1;
        let area = (truth[0][0] * truth[1][1] - truth[0][1] * truth[1][0]).abs();
        match symmetry::find_lattice(picture) {
            Some(l) if patterns::is_lattice([l.t1_px, l.t2_px], truth) => self.right += 1,
            Some(l) => {
                self.fractions += usize::from(l.cell_area_px2() < 0.8 * area);
                self.wrong.push(format!("{name}: {:.2?} {:.2?} {:.2}", l.t1_px, l.t2_px, l.confidence));
            }
            None => {
                self.none += 1;
                self.wrong.push(format!("{name}: none"));
            }
        }
    }

    fn print(&self, name: &str) {
        println!(
            "  {name:16} right {} of {} ({:.3}), fractions {}, none {}",
            self.right,
            self.all,
            self.right as f64 / self.all as f64,
            self.fractions,
            self.none
        );
        for line in &self.wrong {
            println!("      {line}");
        }
    }
}

fn framed_squares() {
    println!("\nSquares in frames and the reliefs of the thesis");
    let mut grid = Tally::default();
    for (seed, case) in framed::Framed::grid().into_iter().enumerate() {
        grid.add(&format!("{case:?}"), &case.picture(seed as u64), case.truth());
    }
    grid.print("grid");
    let mut drawn = Tally::default();
    for seed in 0..200 {
        let case = framed::Framed::drawn(seed, 5.0);
        drawn.add(&format!("{case:?}"), &case.picture(seed), case.truth());
    }
    drawn.print("drawn by lot");
    let mut thesis = Tally::default();
    for (name, picture, truth) in framed::thesis_pictures() {
        thesis.add(&name, &picture, truth);
    }
    thesis.print("thesis");
}

/// Seeds that nothing was tuned on: frames and random motifs of any rotation with 5 to 8 repeats a
/// side, clean and under noise.
fn unseen() {
    println!("\nSeeds that nothing was tuned on");
    let mut drawn = Tally::default();
    for seed in 50_000..50_200 {
        let case = framed::Framed::drawn(seed, 5.0);
        drawn.add(&format!("{case:?}"), &case.picture(seed), case.truth());
    }
    drawn.print("frames");
    for (name, stress) in patterns::ROWS.into_iter().take(3) {
        let mut few = Tally::default();
        for (kind, seed) in patterns::KINDS.into_iter().flat_map(|kind| (0..16).map(move |seed| (kind, seed)))
        {
            // A picture that holds 5 to 8 of the longer translation.
            let (_, basis) = patterns::picture(kind, stress, 32, 70_000 + seed);
            let longest = basis.iter().map(|t| t[0].hypot(t[1])).fold(0.0, f64::max);
            let side = ((5.0 + seed as f64 % 4.0) * longest).ceil() as usize;
            let (pattern, truth) = patterns::picture(kind, stress, side, 70_000 + seed);
            few.add(&format!("{kind:?} {seed}, {side} px"), &pattern, truth);
        }
        few.print(name);
    }
}

/// The six reliefs as height maps, 320 texels a side, the same height of elements in all.
fn write_reliefs() {
    for (shape, across) in framed::SHAPES.into_iter().flat_map(|shape| [(shape, 6.0), (shape, 8.0)]) {
        let (relief, _) = framed::thesis_relief(shape, across, 320);
        let (low, high) = relief.range();
        let name = format!("{shape:?}{across}.png").to_lowercase();
        save_gray16(&name, &relief.map(|v| (v - low) / (high - low))).expect("a folder to write to");
    }
}

/// The standard errors behind a confidence.
fn merit(confidence: f64) -> f64 {
    symmetry::MERIT_LIMIT * (confidence / (1.0 - confidence)).sqrt()
}

fn controls() {
    println!("\nPictures without a lattice: largest merit of the best (limit {})", symmetry::MERIT_LIMIT);
    let show = |name: &str, pictures: Vec<Raster>| {
        let merits: Vec<f64> = pictures
            .iter()
            .map(|p| symmetry::best_lattice(p).map_or(0.0, |lattice| merit(lattice.confidence)))
            .collect();
        let refused = merits.iter().filter(|m| **m < symmetry::MERIT_LIMIT).count();
        let largest = merits.iter().copied().fold(0.0, f64::max);
        println!("  {name:14} refused {refused} of {}, largest merit {largest:.1}", merits.len());
    };
    for d in [2.1, 2.3, 2.5, 2.7, 2.9] {
        let generator = ExactBrownian::new(256, 3.0 - d);
        show(&format!("Brownian {d}"), (0..12).flat_map(|seed| pair(&generator, seed)).collect());
    }
    for radius in [4.0, 9.0, 16.0] {
        show(&format!("blobs {radius}"), (0..24).map(|seed| patterns::blobs(256, radius, seed)).collect());
    }
    for radius in [8.0, 14.0] {
        show(&format!("grains {radius}"), (0..24).map(|seed| patterns::grains(256, radius, seed)).collect());
    }
    let stripes = |noise| (0..24).map(|s| patterns::stripes(256, 17.3, 0.4 * s as f64, noise, s)).collect();
    for (length, share) in [(8.0, 0.02), (8.0, 0.1), (16.0, 0.02), (16.0, 0.1), (16.0, 0.25), (30.0, 0.05)] {
        let waves = |seed| patterns::ring_of_waves(256, length, share, seed);
        show(&format!("ring {length} ±{share}"), (0..24).map(waves).collect());
    }
    show("stripes", stripes(0.0));
    show("noisy stripes", stripes(0.5));
    show("white noise", (0..24).map(|seed| patterns::stripes(256, 1e9, 0.0, 1.0, seed)).collect());
}

fn groups() {
    const SEEDS: u64 = 20;
    println!("\nWallpaper groups, clean motifs of four random blobs, 256², {SEEDS} each");
    let (mut all, mut time) = (0.0, 0.0);
    for group in WallpaperGroup::ALL {
        let mut right = 0.0;
        let mut wrong = String::new();
        for seed in 0..SEEDS {
            let pattern = wallpaper::picture(group, 256, 31 * seed + 7);
            let Some(lattice) = symmetry::find_lattice(&pattern) else {
                wrong += " no lattice";
                continue;
            };
            let start = Instant::now();
            let found = symmetry::wallpaper_group(&symmetry::averaged_cell(&pattern, &lattice), &lattice);
            time += 1e3 * start.elapsed().as_secs_f64() / (17 * SEEDS) as f64;
            if found.group == group {
                right += 1.0 / SEEDS as f64;
            } else {
                wrong += &format!(" {} ({:.3})", found.group.name(), found.agreement);
            }
        }
        all += right / 17.0;
        println!("  {:5} {right:.2} {wrong}", group.name());
    }
    println!("  all {all:.3}, {time:.1} ms for cell and group");
}

fn picture(file: &str) {
    let image = load_channel(file, Channel::Luma).expect("a readable picture").raster;
    let start = Instant::now();
    let lattice = symmetry::best_lattice(&image);
    let time = 1e3 * start.elapsed().as_secs_f64();
    println!("\n{file}: {} × {}, lattice sought in {time:.0} ms", image.width, image.height);
    if let Some(l) = lattice {
        let verdict = if l.confidence >= 0.5 { "found" } else { "refused" };
        println!("  {verdict}: {:.2?} {:.2?}, merit {:.1}", l.t1_px, l.t2_px, merit(l.confidence));
        if l.confidence >= 0.5 {
            let cell = symmetry::averaged_cell(&image, &l);
            let group = symmetry::wallpaper_group(&cell, &l);
            println!(
                "  {} (agreement {:.3}), reliability {:.3}, {} cells",
                group.group.name(),
                group.agreement,
                cell.reliability,
                cell.repeats
            );
        }
    }
    match fd::fractal_dimension(&image) {
        Ok(report) => {
            println!("  {:.3?} R {:.2}", report.dimension, report.roughness);
            for condition in report.conditions {
                println!("  {condition}");
            }
        }
        Err(error) => println!("  {error}"),
    }
}

fn dimension() {
    const PAIRS: u64 = 5;
    for levels in [256_u32, 65_536] {
        println!(
            "\nD, exact Brownian surfaces 256², {levels} levels, {} each: mean estimate (mean |error|)",
            2 * PAIRS
        );
        println!(
            "   D     recommended      box              information      correlation      probability      local64 rms  conditions"
        );
        let mut total = [0.0; 5];
        let mut time = [0.0; 3];
        for tenth in 1..=9 {
            let d = 2.0 + 0.1 * f64::from(tenth);
            let generator = ExactBrownian::new(256, 3.0 - d);
            let (mut mean, mut error, mut local) = ([0.0; 5], [0.0; 5], 0.0);
            let mut broken = 0;
            for seed in 0..PAIRS {
                for surface in pair(&generator, 77 * tenth as u64 + 10_000 * seed) {
                    let map = quantise(&surface, levels);
                    let n = 2.0 * PAIRS as f64;
                    let start = Instant::now();
                    let recommended = fd::transects(&map).unwrap().dimension;
                    time[0] += start.elapsed().as_secs_f64();
                    let start = Instant::now();
                    let cubes = fd::cube_dimensions(&map).unwrap();
                    time[1] += start.elapsed().as_secs_f64();
                    let start = Instant::now();
                    let probability = fd::probability_dimension(&map).unwrap();
                    time[2] += start.elapsed().as_secs_f64();
                    let found =
                        [recommended, cubes.box_counting, cubes.information, cubes.correlation, probability];
                    for i in 0..5 {
                        mean[i] += found[i] / n;
                        error[i] += (found[i] - d).abs() / n;
                    }
                    let places = fd::local_map(&map, 64, 64).unwrap().dimension;
                    local += places.values.iter().map(|v| (v - d) * (v - d)).sum::<f64>()
                        / (places.values.len() as f64 * n);
                    for condition in fd::fractal_dimension(&map).unwrap().conditions {
                        broken += 1;
                        println!("    D {d:.1}: {condition}");
                    }
                }
            }
            print!("  {d:.1}");
            for i in 0..5 {
                total[i] += error[i] / 9.0;
                print!("    {:.3} ({:.3})", mean[i], error[i]);
            }
            println!("    {:.3}        {broken}", local.sqrt());
        }
        println!(
            "  MAE  {:.4}  {:.3}  {:.3}  {:.3}  {:.4}",
            total[0], total[1], total[2], total[3], total[4]
        );
        let n = 18.0 * PAIRS as f64 / 1e3;
        println!(
            "  ms: recommended {:.2}, three cube dimensions {:.2}, probability {:.2}",
            time[0] / n,
            time[1] / n,
            time[2] / n
        );
    }
}
