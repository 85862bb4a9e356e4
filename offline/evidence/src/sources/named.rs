//! Tests in which people named what they felt or heard, asked of the observers.

use super::{Columns, Found, columns};
use crate::abx::Size;
use crate::likeness;
use crate::observer::{Confusion, Judge};
use crate::plates::{self, CONDITIONS, Make, PLATES};
use crate::reliefs::{Relief, Shape};
use asperity_surface::raster::Raster;
use asperity_surface::solid_materials::SolidMaterial;

fn judged(
    of: &[Make],
    conditions: &[(&'static str, &[usize])],
    placed: bool,
) -> Result<Vec<plates::Table>, String> {
    let [known, asked] = plates::lots(of, 16, placed).map_err(|error| error.to_string())?;
    Ok(plates::judge(&known, &asked, conditions))
}

/// Three confusion matrices of the six plates, row by row.
pub fn six_plates() -> Result<Found, String> {
    let tables = judged(&plates::six_plates(), &CONDITIONS, true)?;
    let mut ours = Columns::new();
    let mut means = Vec::new();
    for table in &tables {
        let counts = table.confusion.counts.iter();
        let shares = counts.flat_map(|row| {
            let all = f64::from(row.iter().sum::<u32>().max(1));
            row.iter().map(move |count| f64::from(*count) / all)
        });
        ours.insert(format!("{}, {} observer", table.condition, table.observer), shares.collect());
        let least = (0..PLATES.len()).map(|plate| table.confusion.right(plate)).fold(1.0, f64::min);
        means.push((table, least));
    }
    let of = |observer: &str| {
        let each = means.iter().filter(|(table, _)| table.observer == observer).map(|(table, least)| {
            format!("{} {:.2}, least {least:.2}", table.condition, table.confusion.mean())
        });
        each.collect::<Vec<_>>().join("; ")
    };
    let sentence = format!(
        "Printed are colours: every plate above 0.60, 0.85 on average, most with both senses. First observer: {}. Second, with rhythm, speed and force: {}. Plates in the order {}.",
        of("first"),
        of("second"),
        PLATES.join(", ")
    );
    Ok((columns([("least", vec![0.6]), ("mean", vec![0.85])]), ours, sentence))
}

/// Share of right names of each of the seven materials.
pub fn seven_materials() -> Result<Found, String> {
    let of = plates::seven_materials();
    let mut ours = Columns::new();
    let mut means = Vec::new();
    for table in judged(&of, &CONDITIONS[..1], false)? {
        ours.insert(
            format!("{} observer", table.observer),
            (0..of.len()).map(|material| table.confusion.right(material)).collect(),
        );
        means.push(format!("{} observer {:.2}", table.observer, table.confusion.mean()));
    }
    let names: Vec<_> = SolidMaterial::SEVEN.iter().map(|material| material.name()).collect();
    let sentence = format!(
        "People named 84.8 % on average, gravel and pebbles 93.8 %, all but wood and granite above 70 %; the rest is a picture. By \
         touch: {}. Materials in the order {}.",
        means.join(", "),
        names.join(", ")
    );
    let printed = columns([("mean", vec![0.848]), ("gravel", vec![0.938]), ("pebbles", vec![0.938])]);
    Ok((printed, ours, sentence))
}

/// The reliefs as the thesis groups them.
const RELIEFS: [(Shape, f64); 6] = [
    (Shape::Spheres, 6.0),
    (Shape::Spheres, 8.0),
    (Shape::Quads, 6.0),
    (Shape::Quads, 8.0),
    (Shape::Ovals, 6.0),
    (Shape::Ovals, 8.0),
];
/// Rounds: side, m, and height of the elements, m; named after it.
const ROUNDS: [(&str, f64, f64); 2] = [("80 mm", 0.08, 2e-3), ("40 mm", 0.04, 1e-3)];
/// Strokes of each relief that are learnt, and asked.
const STROKES: (usize, usize) = (60, 60);

/// Names that the observer gives strokes of 0.4 s over the six reliefs.
fn named(side_m: f64, relief_m: f64) -> Result<Confusion, String> {
    const TEXELS: usize = 320;
    let mut known = Vec::new();
    let mut asked = Vec::new();
    for (place, (shape, across)) in RELIEFS.into_iter().enumerate() {
        let relief = Relief { shape, across, size: TEXELS };
        let map = Raster::from_fn(TEXELS, TEXELS, |x, y| relief.height(x, y));
        let (low, high) = map.range();
        let map = map.map(|height| (height - low) / (high - low));
        let size = Size { texel_m: side_m / TEXELS as f64, relief_m };
        let all = likeness::percepts(&map, false, size, STROKES.0 + STROKES.1, 80 + place as u64);
        let mut all = all.map_err(|error| error.to_string())?;
        asked.push(all.split_off(STROKES.0));
        known.push(all);
    }
    Ok(Confusion::of(&Judge::new(known, 1.0), &asked, 10, 8))
}

/// Shares of names from a relief's own group, by round: coarse, fine, spheres, quads, ovals, the
/// first two shapes together.
pub fn groups() -> Result<Found, String> {
    const GROUPS: [&[usize]; 6] = [&[0, 2, 4], &[1, 3, 5], &[0, 1], &[2, 3], &[4, 5], &[0, 1, 2, 3]];
    let printed = columns([
        ("80 mm", vec![0.78, 0.72, 0.55, 0.55, 0.55, 0.84]),
        ("40 mm", vec![0.73, 0.77, 0.50, 0.48, 0.78, 0.93]),
    ]);
    let mut ours = Columns::new();
    for (round, side_m, relief_m) in ROUNDS {
        let counts = named(side_m, relief_m)?.counts;
        let share = |group: &&[usize]| {
            let rows = || group.iter().map(|row| &counts[*row]);
            let own: u32 = rows().map(|row| group.iter().map(|column| row[*column]).sum::<u32>()).sum();
            f64::from(own) / f64::from(rows().flatten().sum::<u32>().max(1))
        };
        ours.insert(round.to_owned(), GROUPS.iter().map(share).collect());
    }
    let round = |name: &str| {
        let each: Vec<String> = ours[name].iter().map(|share| format!("{share:.2}")).collect();
        each.join(", ")
    };
    let sentence = format!(
        "Own group named, coarse, fine, spheres, quads, ovals, spheres or quads: people 0.78, 0.72, 0.55, 0.55, 0.55, 0.84 on 80 mm \
         and 0.73, 0.77, 0.50, 0.48, 0.78, 0.93 on 40 mm; the observer, after one stroke of 0.4 s, {} and {}.",
        round("80 mm"),
        round("40 mm")
    );
    Ok((printed, ours, sentence))
}

/// Shares of people by right names out of five of the six reliefs.
pub fn right_names() -> Result<Found, String> {
    let printed = columns([
        ("80 mm", vec![0.10, 0.40, 0.15, 0.10, 0.25, 0.0]),
        ("40 mm", vec![0.0, 0.25, 0.35, 0.25, 0.05, 0.10]),
    ]);
    let mut ours = Columns::new();
    let mut means = Vec::new();
    for (round, side_m, relief_m) in ROUNDS {
        let confusion = named(side_m, relief_m)?;
        let right: Vec<f64> = (0..RELIEFS.len()).map(|relief| confusion.right(relief)).collect();
        let shares = of_five(&right);
        means.push(shares.iter().zip(0u8..).map(|(share, n)| share * f64::from(n)).sum::<f64>());
        ours.insert(round.to_owned(), shares.to_vec());
    }
    let sentence = format!(
        "Right names out of five, on average: people 2.0 on 80 mm and 2.4 on 40 mm; the observer {:.1} and {:.1}. Its answers are \
         independent of each other, so that its shares lie closer together than people's.",
        means[0], means[1]
    );
    Ok((printed, ours, sentence))
}

/// Shares by right names, 0 to 5, where one of the six is left out at random.
fn of_five(right: &[f64]) -> [f64; 6] {
    let mut shares = [0.0; 6];
    for left_out in 0..right.len() {
        let mut own = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for (_, p) in right.iter().enumerate().filter(|(relief, _)| *relief != left_out) {
            for n in (0..own.len()).rev() {
                let before: f64 = if n > 0 { own[n - 1] } else { 0.0 };
                own[n] = own[n] * (1.0 - p) + before * p;
            }
        }
        shares.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / right.len() as f64);
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_names_of_equal_chances_are_binomial() {
        let shares = of_five(&[0.4; 6]);
        let ways = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
        for (n, (share, ways)) in shares.iter().zip(ways).enumerate() {
            let expected = ways * 0.4f64.powi(n as i32) * 0.6f64.powi(5 - n as i32);
            assert!((share - expected).abs() < 1e-12, "{n}: {share} for {expected}");
        }
    }
}
