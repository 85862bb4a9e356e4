//! Six plates and seven materials by both observers. What they say is printed and stands in
//! `docs/lab/feel.md`, whatever it is; held to are the controls.

use asperity::surface::solid_materials::SolidMaterial;
use asperity_evidence::compare::{Asked, Comparison};
use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_evidence::likeness::Impression;
use asperity_evidence::observer::{constants, second};
use asperity_evidence::plates::{
    CONDITIONS, PLATES, Table, against_itself, judge, lots, seven_materials, six_plates,
};
use asperity_evidence::reliefs::{Relief, SHAPES, Shape};
use asperity_pictures::metamer::{MetamerOptions, metamer};
use asperity_surface::raster::Raster;
use asperity_surface::solid_noise::{SolidCut, SolidNoise};

/// Templates and trials a class; people had 24 trials a plate and 16 a material.
const COUNT: u64 = 16;

fn message(tables: &[Table], names: &[&str]) {
    println!("observers {} {}", constants::constants_sha256(), second::constants_sha256());
    let chance = 1.0 / names.len() as f64;
    let se = (chance * (1.0 - chance) / (names.len() as f64 * COUNT as f64)).sqrt();
    for table in tables {
        let each: Vec<String> =
            (0..names.len()).map(|i| format!("{:.2}", table.confusion.right(i))).collect();
        let [half, two, none] = table.other_kappa;
        println!(
            "{} {}: {} mean {:.3}; κ ½ {half:.3}, 2 {two:.3}, 0 {none:.3}; shuffled {:.3}",
            table.observer,
            table.condition,
            each.join(" "),
            table.confusion.mean(),
            table.shuffled
        );
        names.iter().zip(&table.confusion.counts).for_each(|(name, row)| println!("{name:>12} {row:?}"));
        assert!((table.shuffled - chance).abs() < 2.0 * se, "{} {}", table.observer, table.condition);
    }
}

#[test]
fn the_second_observers_constants_are_those_fixed_beforehand() {
    assert_eq!(
        second::constants_sha256(),
        "ed5cba719d6160e8954fc33859e9f77161c2a63b5432de632433d7edee9342d6"
    );
}

#[test]
fn a_rhythm_of_the_grounds_period_is_heard_not_steady_noise() {
    let rate_hz = 44_100.0;
    let mut rng = asperity_dsp::rng::Rng::new(5);
    let mut depths = |depth: f64, rate: f64| {
        let beat = |n: usize| 1.0 + depth * (std::f64::consts::TAU * rate * n as f64 / rate_hz).sin();
        let noise: Vec<f64> = (0..66_150).map(|n| 0.05 * beat(n) * rng.normal()).collect();
        second::rhythm(&noise, rate_hz, 0.1, |_| 1e9).iter().map(|f| f.value).collect::<Vec<f64>>()
    };
    // 0.1 m/s over 8 mm: 12.5 Hz, the fifth of nine periods.
    let (beating, steady) = (depths(0.5, 12.5), depths(0.0, 12.5));
    // Full depth 0.5 is −6 dB, the threshold −24.4 dB.
    assert!((beating[9 + 4] - 18.4).abs() < 1.5, "{beating:?}");
    assert!(beating[9 + 4] > steady[9 + 4] + 6.0, "{beating:?}\n{steady:?}");
    assert!((beating[9 + 1] - steady[9 + 1]).abs() < 6.0, "{beating:?}\n{steady:?}");
    // 0.1 m/s over 32 mm is 3 Hz, and no rhythm.
    assert!(beating[0].is_nan());
}

#[test]
fn both_observers_say_what_they_say_of_the_six_plates() {
    let [known, asked] = lots(&six_plates(), COUNT, true).unwrap();
    message(&judge(&known, &asked, &CONDITIONS), &PLATES);
    let itself = against_itself(&known, &asked);
    println!("a plate against itself: {itself:?}");
    let se = (0.25 / (6.0 * COUNT as f64)).sqrt();
    assert!(itself.iter().all(|right| (right - 0.5).abs() < 2.0 * se), "{itself:?}");
}

#[test]
fn both_observers_say_what_they_say_of_the_seven_materials() {
    let names = SolidMaterial::SEVEN.map(SolidMaterial::name);
    let [known, asked] = lots(&seven_materials(), COUNT, false).unwrap();
    message(&judge(&known, &asked, &CONDITIONS[..1]), &names);
}

/// Four pieces each of materials, heights 0 to 1: solids, Brownian surfaces, reliefs.
fn pieces() -> Vec<Vec<Raster>> {
    const SIDE: usize = 256;
    let whole = |map: Raster| {
        let (low, high) = map.range();
        map.map(|height| (height - low) / (high - low))
    };
    let solid = |material: &SolidMaterial| {
        let parameters = material.parameters();
        let piece = |seed: u64| {
            let noise = SolidNoise::new(parameters, seed).unwrap();
            let at = |x: usize, y: usize| SolidCut::SLANTED.at([x, y].map(|n| 1.5625e-4 * n as f64));
            whole(Raster::from_fn(SIDE, SIDE, |x, y| noise.definition(&parameters, at(x, y))))
        };
        (1..5).map(piece).collect()
    };
    let brownian = |hurst: f64| -> Vec<Raster> {
        let map = |values: Vec<f64>| whole(Raster { width: SIDE, height: SIDE, values });
        (1..3).flat_map(|seed| ExactBrownian::new(SIDE, hurst).pair(seed)).map(map).collect()
    };
    let relief = |shape: Shape| {
        let relief = Relief { shape, across: 6.0, size: SIDE };
        let piece = |n: usize| Raster::from_fn(SIDE, SIDE, |x, y| relief.height(x + 37 * n, y + 23 * n));
        (0..4).map(|n| whole(piece(n))).collect()
    };
    // Stretched from 0 to 1, granite is pebbles.
    let solids = SolidMaterial::SEVEN.iter().filter(|material| **material != SolidMaterial::Granite);
    let mut all: Vec<Vec<Raster>> = solids.map(solid).collect();
    all.extend([0.2, 0.5, 0.8].map(brownian));
    all.extend(SHAPES.map(relief));
    all
}

/// Share of strokes that the observer puts on the right one of two surfaces.
fn told_apart(one: &Raster, other: &Raster) -> f64 {
    let asked = Comparison { asked: Asked::Observer, strokes: 60, width_m: 0.04, relief_m: 0.002, seed: 31 };
    asked.table(&[one.clone(), other.clone()], 0, || ()).unwrap().mean
}

#[test]
fn other_pieces_of_a_material_and_its_metamers_rank_before_other_materials() {
    let impression = |map: &Raster| Impression::of(map, 0.04, 0.002, (40, 1)).unwrap();
    let pieces = pieces();
    let mut all: Vec<(usize, Impression)> = pieces
        .iter()
        .enumerate()
        .flat_map(|(material, maps)| maps.iter().map(move |map| (material, impression(map))))
        .collect();
    let asked = all.len();
    // The arrangement of the next material made to feel like this one's first piece. Asked for is
    // that only where the observer takes the two for one.
    for (material, maps) in pieces.iter().enumerate() {
        let look = &pieces[(material + 1) % pieces.len()][0];
        let made = metamer(look, &maps[0], &MetamerOptions::default(), |_| ()).unwrap().image;
        let share = told_apart(&made, &maps[0]);
        println!("metamer of material {material}: told apart {share:.2}");
        if share <= 0.65 {
            all.push((material, impression(&made)));
        }
    }
    println!("{} of {} metamers taken for their material", all.len() - asked, pieces.len());
    assert!(all.len() - asked >= 6);
    let mut own_first = [Vec::new(), Vec::new()];
    for (place, (material, original)) in all[..asked].iter().enumerate() {
        // A metamer is made like one piece, and found by that.
        let of_first = place % 4 == 0;
        let counts = |other: usize| other < asked || of_first || all[other].0 != *material;
        let mut ranked: Vec<(f64, bool)> = (0..all.len())
            .filter(|other| *other != place && counts(*other))
            .map(|other| (original.distance(&all[other].1), all[other].0 == *material))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let own = ranked.iter().filter(|(_, own)| *own).count();
        own_first[usize::from(own > 3)].push(ranked[..own].iter().all(|(_, own)| *own));
    }
    let right = |found: &[bool]| found.iter().filter(|first| **first).count();
    let [plain, with] = &own_first;
    println!(
        "own before others: {} of {} queries for pieces, {} of {} for pieces and a metamer",
        right(plain),
        plain.len(),
        right(with),
        with.len()
    );
    assert!((right(plain) + right(with)) as f64 >= 0.9 * asked as f64, "{own_first:?}");
    assert!(right(with) as f64 >= 0.9 * with.len() as f64, "{own_first:?}");
}
