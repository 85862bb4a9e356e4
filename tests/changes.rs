//! Parameters of a surface changed under a sliding contact, through the scene: no sample step above
//! −60 dB of the signal, felt or heard.

use crate::common;
use crate::sliding;

use asperity::Surface;
use asperity::surface::combine::{BandSplit, Crossfade, Mask, Scale, Sum};
use asperity::surface::combine::{BandWeights, CrossfadeTo, ScaleTo};
use asperity::surface::height_field::HeightField;
use asperity::surface::height_map::{Extent, HeightMap};
use asperity::surface::raster::Raster;
use asperity::surface::sand::{Layer, SandDesign, SandLaw, SandSource};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::SolidNoise;
use asperity::surface::wrap::Wrap;
use common::SIDE_M;
use sliding::{Stroke, assert_no_step};

fn solid(material: SolidMaterial) -> Box<dyn HeightField> {
    Box::new(SolidNoise::new(material.parameters(), 3).unwrap())
}

fn surface(source: impl HeightField + 'static) -> Surface {
    Surface::new(source, SIDE_M, SIDE_M).unwrap().wraps(false).micro_relief_m(0.0)
}

/// Slides, changes, slides on, and looks for a step from before the first change.
fn changed<C: Copy + Send + Sync + 'static>(what: &str, surface: Surface, changes: &[C]) -> Stroke {
    let mut stroke = Stroke::on(surface, 1.0);
    stroke.slide(0.4);
    for change in changes {
        let id = stroke.surface;
        stroke.scene.change_surface(id, *change).unwrap();
        stroke.slide(0.17);
    }
    assert_eq!(stroke.scene.stats().quarantined, 0, "{what}: every change is taken");
    assert_no_step(&stroke, 0.3, what);
    stroke
}

#[test]
fn every_parameter_of_solid_noise() {
    let start = SolidMaterial::RoughGlass.parameters();
    let with = |spoil: fn(&mut asperity::surface::solid_noise::SolidNoiseParameters)| {
        let mut parameters = start;
        spoil(&mut parameters);
        parameters
    };
    let changes = [
        with(|p| p.modules[0].frequency = 6.0),
        with(|p| p.modules[0].octaves = 3),
        with(|p| (p.modules[0].octaves, p.modules[0].lacunarity) = (3, 1.7)),
        with(|p| (p.modules[0].octaves, p.modules[0].persistence) = (2, 0.3)),
        with(|p| p.modules[0].magnitude = 9.0),
        with(|p| p.modules[1] = SolidMaterial::Granite.parameters().modules[0]),
        with(|p| p.texture_factor_per_m = 250.0),
        with(|p| p.amplitude_m = -2e-5),
        with(|p| (p.limit_n, p.cap_n, p.viscosity_n_s_m, p.friction) = (0.5, 3.0, 5.0, 0.9)),
        start,
    ];
    changed("solid noise", surface(SolidNoise::new(start, 3).unwrap()), &changes);
    let materials = [SolidMaterial::Pebbles, SolidMaterial::Gravel, SolidMaterial::Wood, SolidMaterial::Sand];
    let changes = materials.map(|m| m.parameters());
    changed("materials", surface(SolidNoise::new(start, 3).unwrap()), &changes);
}

#[test]
fn scale_crossfade_band_split_and_a_masked_sum() {
    let scale = Scale::new(solid(SolidMaterial::Gravel), 1.0).unwrap();
    changed("scale", surface(scale), &[0.0, 3.0, -1.0, 0.2].map(ScaleTo));
    let fade = Crossfade::new(solid(SolidMaterial::Pebbles), solid(SolidMaterial::Gravel));
    changed("crossfade", surface(fade), &[1.0, 0.3, 0.0].map(CrossfadeTo));
    let split = BandSplit::new(solid(SolidMaterial::Gravel), solid(SolidMaterial::Sand), 2e-3).unwrap();
    let weights = [[0.0, 1.0], [2.0, 0.0], [1.0, 1.0]].map(BandWeights);
    changed("band split", surface(split), &weights);
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let half = Raster::from_fn(8, 8, |x, _| 0.5 + 0.4 * (x as f64 * std::f64::consts::FRAC_PI_4).sin());
    let mask = Box::new(HeightMap::new(&half, extent, Wrap::Repeat).unwrap());
    let sum = Box::new(Sum::new(vec![solid(SolidMaterial::Granite), solid(SolidMaterial::RoughGlass)]));
    let scaled = Box::new(Scale::new(sum, 1.0).unwrap());
    let masked = Mask::new(mask, scaled, solid(SolidMaterial::Pebbles));
    changed("scaled sum in a mask", surface(masked), &[4.0, 0.0, 1.0].map(ScaleTo));
}

#[test]
fn the_law_of_sand() {
    let design = SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 280, ..SandDesign::default() };
    let law = design.law;
    let layers = [Some(Layer { from_m: 1e-4, hardness: 5.0 }), None, None, None];
    let changes = [
        SandLaw { wetness: 1.0, ..law },
        SandLaw { stiffness_n: 100.0, drag_s_per_m: 50.0, ..law },
        SandLaw { exponent_per_m: 8.0, layers, grain_m: 1e-3, ..law },
        law,
    ];
    // Grains hit the body one by one: what is heard has onsets of its own, so only what is felt
    // counts.
    let sand = surface(SandSource::synchronous(&design, 1).unwrap());
    let mut stroke = Stroke::on(sand.excitation(asperity::Excitation::COLLISIONS), 1.0);
    stroke.slide(0.4);
    for change in changes {
        stroke.scene.change_surface(stroke.surface, change).unwrap();
        stroke.slide(0.17);
    }
    assert_eq!(stroke.scene.stats().quarantined, 0);
    let [felt, _] = stroke.steps_db(0.3);
    println!("sand: largest step felt {felt:.1} dB");
    assert!(felt < -60.0, "{felt} dB");
}
