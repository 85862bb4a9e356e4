//! What 64 contacts cost each against one alone: ns a sample and contact on silent plates, in turn,
//! so that both see the same machine.
//!
//! `cargo run --release --example many_contacts -- [KERNEL] [FRAMES] [GROUND] [CONTACTS] [TURNS]`,
//! for example `avx2 64 map 64 400`. GROUND is `map` (a displacement and a roughness map),
//! `heights` (a displacement map) or `flat`; the micro-relief is a scene's own in all of them. With
//! 0 turns nothing is compared: the contacts alone are rendered for four seconds, for a profiler.

use asperity::dsp::simd::Isa;
use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Extent, Renderer, Scene, Surface, SurfaceId,
    Wrap,
};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::error::Error;
use std::f64::consts::PI;
use std::time::Instant;

const REPORT_HZ: f64 = 60.0;
const SIDE_M: f64 = 0.14;

struct Strokes {
    scene: Scene,
    renderer: Renderer,
    surfaces: Vec<SurfaceId>,
    reports: u64,
}

fn ground(kind: &str) -> Result<HeightMap, Box<dyn Error>> {
    let waves = Raster::from_fn(512, 512, |x, y| {
        let (u, v) = (x as f64 / 512.0, y as f64 / 512.0);
        0.5 + 0.25 * (2.0 * PI * 40.0 * u).sin() + 0.25 * (2.0 * PI * 23.0 * (u + v)).cos()
    });
    let rough = Raster::from_fn(256, 256, |x, _| if x < 128 { 0.2 } else { 0.8 });
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 2e-4 };
    Ok(match kind {
        "map" => HeightMap::new(&waves, extent, Wrap::Repeat)?.with_roughness_map(&rough)?,
        "heights" => HeightMap::new(&waves, extent, Wrap::Repeat)?,
        "flat" => HeightMap::flat(extent, 0.5)?,
        other => return Err(format!("GROUND {other}: is none of map, heights, flat").into()),
    })
}

impl Strokes {
    fn new(kernel: Isa, map: &HeightMap, contacts: usize) -> Result<Self, Box<dyn Error>> {
        let config = Config { kernel: Some(kernel), ..Config::default() };
        let asperity::Engine { mut scene, renderer, .. } = config.build()?;
        let surfaces = (0..contacts).map(|_| scene.add_surface(Surface::new(map.clone(), SIDE_M, SIDE_M)?));
        let surfaces = surfaces.collect::<Result<Vec<_>, _>>()?;
        Ok(Self { scene, renderer, surfaces, reports: 0 })
    }

    fn report(&mut self) -> Result<(), Box<dyn Error>> {
        let time_s = self.reports as f64 / REPORT_HZ;
        for (i, surface) in self.surfaces.iter().enumerate() {
            let (id, phase, speed_m_s) = (ContactId(i as u64), i as f64 * 0.37, 0.1 + 0.002 * i as f64);
            let sample = ContactSample {
                uv: [(phase + speed_m_s * time_s) / SIDE_M, 0.3 + phase],
                velocity_m_s: Some([speed_m_s, 0.0]),
                normal_force_n: 0.5,
                ..ContactSample::default()
            };
            let event = match self.reports {
                0 => ContactEvent::begin(id, *surface, ChannelId(0), sample),
                _ => ContactEvent::moved(id, sample),
            };
            self.scene.report(time_s, event)?;
        }
        self.reports += 1;
        Ok(())
    }

    /// Renders 256 samples, or as many whole blocks as fit; ns a sample.
    fn turn(&mut self, frames: usize) -> Result<f64, Box<dyn Error>> {
        let (mut haptic, mut audio) = ([0.0f32; 256], [0.0f32; 256]);
        let blocks = 256 / frames;
        let end = self.renderer.position() + (blocks * frames) as u64;
        while self.reports as f64 / REPORT_HZ * 44_100.0 < end as f64 {
            self.report()?;
        }
        let began = Instant::now();
        for _ in 0..blocks {
            self.renderer.render(&mut [&mut haptic[..frames]], &mut [&mut audio[..frames]]);
        }
        Ok(began.elapsed().as_secs_f64() * 1e9 / (blocks * frames) as f64)
    }
}

fn median(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of.get(of.len() / 2).copied().unwrap_or(f64::NAN)
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |i: usize, default: &'static str| words.get(i).map_or(default, String::as_str);
    let kernel = Isa::from_name(word(0, "avx2")).ok_or("KERNEL: is none of portable, neon, avx2, avx512")?;
    let (frames, map) = (word(1, "64").parse::<usize>()?, ground(word(2, "map"))?);
    let (contacts, turns) = (word(3, "64").parse::<usize>()?, word(4, "400").parse::<usize>()?);
    if !(1..=256).contains(&frames) || contacts == 0 {
        return Err("FRAMES must be 1 to 256 and CONTACTS 1 or more".into());
    }
    let mut many = Strokes::new(kernel, &map, contacts)?;
    if turns == 0 {
        for _ in 0..4 * 44_100 / 256 {
            many.turn(frames)?;
        }
        return Ok(());
    }
    let mut one = Strokes::new(kernel, &map, 1)?;
    let (mut ones, mut manys) = (Vec::new(), Vec::new());
    for turn in 0..turns + 50 {
        let pair = (one.turn(frames)?, many.turn(frames)? / contacts as f64);
        if turn >= 50 {
            ones.push(pair.0);
            manys.push(pair.1);
        }
    }
    let ratio = median(ones.iter().zip(&manys).map(|(one, many)| many / one).collect());
    println!(
        "{} {frames} frames {}: one {:.1} ns a sample, {contacts} contacts {:.1} ns each: {ratio:.3}",
        kernel.name(),
        word(2, "map"),
        median(ones),
        median(manys)
    );
    Ok(())
}
