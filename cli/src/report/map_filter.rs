//! Map filters compared: the error of reading heights between the texels of a map.

use super::cases::{Case, LENGTH_M};
use super::through::Truth;
use super::{BLOCK, Row, SAMPLE_RATE_HZ, refused};
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity::{Extent, Wrap};
use asperity_surface::height_field::{HeightField, PathBlock, SurfaceBlock};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::f64::consts::PI;

const SIDE: usize = 512;
const SIDE_M: f64 = 0.14;
/// 12.8 texels a period.
const WAVES: f64 = 40.0;
const SECONDS: f64 = 0.5;
const SPEED_M_S: f64 = 0.1;
const REFERENCE: &str =
    "the analytic rate of climb over a sine of 12.8 texels a period in a 16-bit map, oblique path";

fn height(x: f64) -> f64 {
    0.5 + 0.5 * (2.0 * PI * WAVES * x / SIDE_M).sin()
}

/// Ways to read a map that the engine does not offer, to compare with.
#[derive(Clone, Copy)]
enum Baseline {
    Nearest,
    Bilinear,
}

impl Baseline {
    fn read(self, map: &Raster, width_m: f64, [x_m, y_m]: [f64; 2]) -> f64 {
        let texels = map.width as f64 / width_m;
        let (x, y) = (x_m * texels - 0.5, y_m * texels - 0.5);
        let at = |i: f64, j: f64| {
            let wrap = |k: f64, size: usize| (k as i64).rem_euclid(size as i64) as usize;
            map.values[wrap(j, map.height) * map.width + wrap(i, map.width)]
        };
        match self {
            Self::Nearest => at(x.round(), y.round()),
            Self::Bilinear => {
                let (i, j) = (x.floor(), y.floor());
                let (u, v) = (x - i, y - j);
                (at(i, j) * (1.0 - u) + at(i + 1.0, j) * u) * (1.0 - v)
                    + (at(i, j + 1.0) * (1.0 - u) + at(i + 1.0, j + 1.0) * u) * v
            }
        }
    }
}

struct Course {
    position_m: Vec<[f64; 2]>,
    velocity_m_s: [f64; 2],
}

fn course() -> Course {
    let (vx, vy) = (SPEED_M_S * 0.29f64.cos(), SPEED_M_S * 0.29f64.sin());
    let position_m = (0..(SECONDS * SAMPLE_RATE_HZ) as usize)
        .map(|n| {
            let t = n as f64 / SAMPLE_RATE_HZ;
            [0.013 + vx * t, 0.017 + vy * t]
        })
        .collect();
    Course { position_m, velocity_m_s: [vx, vy] }
}

/// The engine's way.
fn spline(map: &mut HeightMap, course: &Course, step_m: f64) -> Vec<f64> {
    let velocity_m_s = [course.velocity_m_s; BLOCK];
    let footprint_m = [step_m; BLOCK];
    let mut out = SurfaceBlock::default();
    let mut heights = Vec::with_capacity(course.position_m.len());
    for (index, part) in course.position_m.chunks(BLOCK).enumerate() {
        let path = PathBlock {
            position_m: part,
            velocity_m_s: &velocity_m_s[..part.len()],
            footprint_m: &footprint_m[..part.len()],
            normal_force_n: &[],
            first_sample: (index * BLOCK) as u64,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        map.sample(&path, &mut out);
        heights.extend_from_slice(&out.height_m[..part.len()]);
    }
    heights
}

fn rates(heights: &[f64]) -> impl Iterator<Item = f64> + '_ {
    heights.windows(2).map(|pair| (pair[1] - pair[0]) * SAMPLE_RATE_HZ)
}

/// Measures the axis.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let sixteen_bit = |value: f64| (value * 65_535.0).round() / 65_535.0;
    let texel = |index: usize| (index as f64 + 0.5) / SIDE as f64 * SIDE_M;
    let raster = Raster::from_fn(SIDE, SIDE, |x, _| sixteen_bit(height(texel(x))));
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let mut map = HeightMap::new(&raster, extent, Wrap::Repeat).map_err(refused)?;
    let course = course();
    let exact: Vec<f64> = course.position_m.iter().map(|place| height(place[0])).collect();
    let reference: Vec<f64> = rates(&exact).collect();
    let row = |choice: &str, heights: &[f64], ns_per_sample: f64| {
        Row::of(("map filter", choice), ns_per_sample, relative_error(rates(heights), &reference), REFERENCE)
    };
    let mut rows = Vec::new();
    for (choice, baseline) in
        [("nearest texel (not offered)", Baseline::Nearest), ("bilinear (not offered)", Baseline::Bilinear)]
    {
        let read = || -> Vec<f64> {
            course.position_m.iter().map(|place| baseline.read(&raster, SIDE_M, *place)).collect()
        };
        let ns = ns_per_item(exact.len(), || {
            std::hint::black_box(read());
        });
        rows.push(row(choice, &read(), ns));
    }
    let heights = spline(&mut map, &course, SPEED_M_S / SAMPLE_RATE_HZ);
    let ns = ns_per_item(exact.len(), || {
        std::hint::black_box(spline(&mut map, &course, SPEED_M_S / SAMPLE_RATE_HZ));
    });
    rows.push(row("cubic B-spline with slope and mip levels", &heights, ns));
    Ok(rows)
}

const CASES_REFERENCE: &str = "the equation that the map of the case is drawn from (2048 texels on 140 mm, 16 bits), through the same contact at 8 times \
                               the rate; cases without a map have their own axis";

/// The 16-bit map of a case, with a height of 1.
fn map_of(case: &Case, seed: u64) -> Option<(Raster, f64)> {
    let (heights, _, relief_m) = case.relief(seed)?;
    let width = heights.len();
    let row = heights.iter().map(|height| (height * 65_535.0).round() / 65_535.0).collect::<Vec<_>>();
    Some((Raster { width, height: 4, values: row.repeat(4) }, relief_m))
}

/// Filters on the named cases that have a map: the contact's response to it.
pub fn rows_on_cases() -> Result<Vec<Row>, CliError> {
    let none = || refused("case: has no map; please report it");
    let truth = Truth::new(|case| case.roughness().is_none(), &|case, seed, places_m, _| {
        let (_, height, relief_m) = case.relief(seed).ok_or_else(none)?;
        Ok(places_m.iter().map(|x| relief_m * height((x / LENGTH_M).rem_euclid(1.0))).collect())
    })?;
    let course_of = |case: &Case, places_m: &[f64]| Course {
        position_m: places_m.iter().map(|x| [*x, 0.5 * LENGTH_M * 4.0 / 2048.0]).collect(),
        velocity_m_s: [case.speed_m_s, 0.0],
    };
    let costs = rows()?;
    let ns = |which: usize| costs.get(which).map_or(0.0, |row| row.ns_per_sample);
    let row = |which: usize, name: &str, read: &super::through::Heights<'_>| {
        truth.row(("map filter, on the cases", name.to_owned()), ns(which), CASES_REFERENCE, read)
    };
    let plain = |baseline: Baseline| {
        move |case: &Case, seed: u64, places_m: &[f64], _: f64| {
            let (map, relief_m) = map_of(case, seed).ok_or_else(none)?;
            let at = |place: &[f64; 2]| relief_m * baseline.read(&map, LENGTH_M, *place);
            Ok(course_of(case, places_m).position_m.iter().map(at).collect())
        }
    };
    let engine = |case: &Case, seed: u64, places_m: &[f64], rate_hz: f64| {
        let (raster, relief_m) = map_of(case, seed).ok_or_else(none)?;
        let extent = Extent { width_m: LENGTH_M, height_m: LENGTH_M * 4.0 / 2048.0, relief_m };
        let mut map = HeightMap::new(&raster, extent, Wrap::Repeat).map_err(refused)?;
        Ok(spline(&mut map, &course_of(case, places_m), case.speed_m_s / rate_hz))
    };
    Ok(vec![
        row(0, "nearest texel (not offered)", &plain(Baseline::Nearest))?,
        row(1, "bilinear (not offered)", &plain(Baseline::Bilinear))?,
        row(2, "cubic B-spline with slope and mip levels", &engine)?,
    ])
}
