//! Normal maps that were resized, saved as JPEG or cut from larger ones, of surfaces with steep
//! edges: the heights must be the surface's, and no wave may come out much stronger than it is.
//! Longer tables, of files: `examples/normal_map_table`.

use crate::normals;
use crate::surfaces;

use asperity_pictures::gradient_field::{DERIVATIVES, Derivative, differences, slopes};
use asperity_pictures::normal_map::{Green, NormalMapHeights, NormalMapOptions, heights_from_normals};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use image::imageops::FilterType;
use normals::{as_jpeg, cut, halved, halved_heights, normal_map, thirds, without_slant};
use surfaces::{correlation, fractal};

/// Raised discs with edges two texels wide, 32 texels apart, 3 texels high, on slightly uneven
/// ground: a tread plate.
fn studs(n: usize) -> Raster {
    let ground = fractal(n, 4.0, 1.0, 41);
    Raster::from_fn(n, n, |x, y| {
        let row = y / 32;
        let from = |i: usize, shift: usize| ((i + shift) % 32) as f64 - 15.5;
        let distance = from(x, 16 * (row % 2)).hypot(from(y, 0));
        3.0 * (0.5 * (10.0 - distance) + 0.5).clamp(0.0, 1.0) + 2.0 * ground.at(x, y)
    })
}

/// Rough ground with an rms slope of 0.35.
fn ground(n: usize) -> Raster {
    let surface = fractal(n, 4.0, 1.0, 42);
    let power = slopes(&surface, Derivative::Exact).power();
    surface.map(|z| z * 0.35 / power.sqrt())
}

fn made(map: &[Raster; 3]) -> NormalMapHeights {
    heights_from_normals(&map[0], &map[1], &map[2], &NormalMapOptions::default()).unwrap()
}

/// Whether the true heights tile. Those that do not are compared without their slant, which no map
/// keeps that is not told to.
#[derive(Clone, Copy, PartialEq)]
enum Truth {
    Tiles,
    Ends,
}

/// Asserts the bars and prints how near they are.
fn check(what: &str, made: &NormalMapHeights, truth: (&Raster, Truth), least_r: f64) {
    let (truth, tiles) = (truth.0, truth.1 == Truth::Tiles);
    let [z, t] = [&made.height_px, truth].map(|h| if tiles { h.clone() } else { without_slant(h) });
    let (r, thirds) = (correlation(&z, &t), thirds(&z, &t, tiles));
    println!("{what}: r {r:.4}, thirds {thirds:.3?}, {:?} {}", made.derivative, made.derivative_is_certain);
    assert!(r >= least_r, "{what}: r {r}");
    assert!(thirds.iter().all(|&third| third <= 1.5), "{what}: {thirds:?}");
}

#[test]
fn steep_edges_in_resized_maps_are_not_sobels_blindness() {
    let surface = studs(512);
    for green in [Green::OpenGl, Green::DirectX] {
        for derivative in [Derivative::Exact, Derivative::Central] {
            let map = normal_map(&slopes(&surface, derivative), green);
            for filter in [FilterType::Triangle, FilterType::Lanczos3, FilterType::CatmullRom] {
                let made = made(&halved(&map, filter));
                check(
                    &format!("{derivative:?} {filter:?}"),
                    &made,
                    (&halved_heights(&surface), Truth::Tiles),
                    0.97,
                );
                assert!(made.tileable && made.green == green);
                // No difference of its own texels made the halved map.
                assert!(made.derivative != Derivative::Sobel, "{derivative:?} {filter:?}");
                assert!(!made.derivative_is_certain, "{derivative:?} {filter:?}");
            }
        }
    }
}

#[test]
fn a_map_that_tiles_still_tiles_as_jpeg_and_gets_no_stronger() {
    for (name, surface) in [("studs", studs(256)), ("ground", ground(256))] {
        for derivative in DERIVATIVES {
            let map = normal_map(&slopes(&surface, derivative), Green::OpenGl);
            for (quality, half_colours) in [(75, true), (75, false), (90, true)] {
                let made = made(&as_jpeg(&map, quality, half_colours));
                check(
                    &format!("{name} {derivative:?} {quality} {half_colours}"),
                    &made,
                    (&surface, Truth::Tiles),
                    0.97,
                );
                assert!(made.tileable && made.green == Green::OpenGl, "{name} {derivative:?} {quality}");
                assert!(!made.derivative_is_certain, "{name} {derivative:?} {quality}");
            }
        }
    }
}

/// Holes with upright walls, 32 texels apart, 8 texels deep before the slopes are scaled to an rms
/// of 1: a perforated sheet.
fn perforated(n: usize) -> Raster {
    let sheet = Raster::from_fn(n, n, |x, y| {
        let shift = 16 * (y / 32 % 2);
        let from = |i: usize| (i % 32) as f64 - 15.5;
        -8.0 * (10.5 - from(x + shift).hypot(from(y))).clamp(0.0, 1.0)
    });
    let power = slopes(&sheet, Derivative::Exact).power();
    sheet.map(|z| z / power.sqrt())
}

#[test]
fn upright_walls_saved_as_jpeg_give_no_short_waves() {
    let surface = perforated(512);
    let map = normal_map(&slopes(&surface, Derivative::Exact), Green::OpenGl);
    for quality in [75, 85] {
        let made = made(&as_jpeg(&map, quality, true));
        let thirds = thirds(&made.height_px, &surface, true);
        println!("perforated {quality}: thirds {thirds:.3?}");
        assert!(thirds.iter().all(|&third| third <= 1.5), "{quality}: {thirds:?}");
    }
}

/// Means of 4 × 4.
fn quartered(fine: &Raster) -> Raster {
    Raster::from_fn(fine.width / 4, fine.height / 4, |x, y| {
        (0..16).map(|i| fine.at(4 * x + i % 4, 4 * y + i / 4)).sum::<f64>() / 16.0
    })
}

/// A 256² map as it is baked: normals of a surface of four times as many texels, averaged, lengths
/// 1 again; and the means of its heights.
fn baked(surface: &Raster) -> ([Raster; 3], Raster) {
    let fine = slopes(&surface.map(|z| 4.0 * z), Derivative::Central);
    let normal = |which: usize| {
        quartered(&Raster::from_fn(surface.width, surface.height, |x, y| {
            let (p, q) = (fine.along_u.at(x, y), fine.along_v.at(x, y));
            [-p, q, 1.0][which] / (1.0 + p * p + q * q).sqrt()
        }))
    };
    let normals = [0, 1, 2].map(normal);
    let level = |which: usize| {
        Raster::from_fn(surface.width / 4, surface.height / 4, |x, y| {
            let length = normals.iter().map(|n| n.at(x, y).powi(2)).sum::<f64>().sqrt();
            ((0.5 + 0.5 * normals[which].at(x, y) / length) * 255.0).round() / 255.0
        })
    };
    ([0, 1, 2].map(level), quartered(surface))
}

#[test]
fn walls_between_flat_places_are_as_strong_as_height_maps() {
    // Distances in texels of the baked map: round holes in rows, panels with grooves, discs of
    // three heights.
    let at = |i: usize| 0.25 * i as f64;
    let wall = |distance: f64, width: f64| (distance / width + 0.5).clamp(0.0, 1.0);
    let holes = |x: usize, y: usize| {
        let shift = 16.0 * (y / 128 % 2) as f64;
        let from = |v: f64| v.rem_euclid(32.0) - 15.9;
        6.0 * wall(from(at(x) + shift).hypot(from(at(y))) - 9.3, 1.5)
    };
    let panels = |x: usize, y: usize| {
        let edge = |v: f64, side: f64| (v.rem_euclid(side) - 0.5 * side).abs();
        let groove = (32.0 - edge(at(x), 64.0)).min(16.0 - edge(at(y) + 5.3, 32.0));
        1.2 * wall(groove - 1.7, 1.0)
    };
    let discs = |x: usize, y: usize| {
        let cell = (at(x) / 64.0) as usize + 3 * ((at(y) / 64.0) as usize);
        let from = |v: f64| v.rem_euclid(64.0) - 31.7;
        (1.0 + (cell % 3) as f64) * wall(21.4 - from(at(x)).hypot(from(at(y))), 1.2)
    };
    for (name, surface) in [
        ("holes", Raster::from_fn(1024, 1024, holes)),
        ("panels", Raster::from_fn(1024, 1024, panels)),
        ("discs", Raster::from_fn(1024, 1024, discs)),
    ] {
        let (map, truth) = baked(&surface);
        check(name, &made(&map), (&truth, Truth::Tiles), 0.97);
        check(&format!("{name}, JPEG"), &made(&as_jpeg(&map, 90, true)), (&truth, Truth::Tiles), 0.97);
        let piece = map.map(|channel| cut(&channel, [21, 10], [191, 203]));
        check(
            &format!("{name}, cut"),
            &made(&piece),
            (&cut(&truth, [21, 10], [191, 203]), Truth::Ends),
            0.97,
        );
    }
}

#[test]
fn short_waves_of_a_cut_map_are_as_strong_as_they_are() {
    for (name, surface) in [("studs", studs(512)), ("ground", ground(512))] {
        for derivative in DERIVATIVES {
            let map = normal_map(&slopes(&surface, derivative), Green::DirectX);
            // Neither side is a product of small numbers.
            let (from, size) = ([31, 60], [347, 211]);
            let piece = map.clone().map(|channel| cut(&channel, from, size));
            let truth = cut(&surface, from, size);
            let whole = made(&piece);
            check(&format!("{name} {derivative:?}"), &whole, (&truth, Truth::Ends), 0.99);
            assert!(!whole.tileable && whole.green == Green::DirectX);
            let jpeg = made(&as_jpeg(&piece, 85, true));
            check(&format!("{name} {derivative:?} JPEG"), &jpeg, (&truth, Truth::Ends), 0.97);
            assert!(!jpeg.tileable);
        }
    }
}

#[test]
fn clean_maps_with_steep_edges_still_tell_their_derivative() {
    let surface = studs(256);
    for derivative in DERIVATIVES {
        let made = made(&normal_map(&slopes(&surface, derivative), Green::OpenGl));
        check(&format!("{derivative:?}"), &made, (&surface, Truth::Tiles), 0.999);
        assert_eq!((made.derivative, made.derivative_is_certain), (derivative, true));
        // One that does not tile, with borders of its own.
        let piece = cut(&surface, [5, 9], [201, 180]);
        let field = differences(&piece, derivative);
        let open = self::made(&normal_map(&field, Green::OpenGl));
        check(&format!("{derivative:?} cut"), &open, (&piece, Truth::Ends), 0.99);
    }
}

#[test]
fn others_displacement_maps_return_from_halved_jpeg_normals() {
    let displacement = "textures/MetalWalkway006_1K-PNG_Displacement.png";
    let Some(file) = asperity_evidence::corpus::corpus(displacement) else { return };
    let heights = load_channel(file, Channel::Luma).unwrap().raster;
    let scale = 0.35 / differences(&heights, Derivative::Central).power().sqrt();
    let surface = heights.map(|z| z * scale);
    let map = normal_map(&slopes(&surface, Derivative::Central), Green::OpenGl);
    let truth = halved_heights(&surface);
    let small = halved(&map, FilterType::Lanczos3);
    check("halved", &made(&small), (&truth, Truth::Tiles), 0.97);
    let jpeg = made(&as_jpeg(&small, 90, true));
    check("halved, JPEG", &jpeg, (&truth, Truth::Tiles), 0.95);
    assert!(jpeg.tileable);
    let piece = small.map(|channel| cut(&channel, [40, 30], [300, 241]));
    check("halved, cut", &made(&piece), (&cut(&truth, [40, 30], [300, 241]), Truth::Ends), 0.97);
}
