//! Strokes whose forces are told at the rate of a device.

use asperity::live::ports::{ForceRow, ForceRows, Of};
use asperity::surface::sand::{SandDesign, SandLaw, SandSource};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::SolidNoise;
use asperity::{
    ChannelId, Config, ContactBlock, ContactEvent, ContactId, ContactSample, Engine, Surface, Tap,
};

pub const SIDE_M: f64 = 0.2;

/// Rows at a device's rate, and the path that the contact took.
pub struct Felt {
    pub rows: ForceRows,
    pub received: Vec<ForceRow>,
    pub path: Vec<([f64; 2], [f64; 2], f64)>,
    pub first: Option<u64>,
}

impl Felt {
    pub fn new(rate_hz: f64, sample_rate_hz: f64) -> Self {
        let rows = ForceRows::new(rate_hz, sample_rate_hz, 4);
        Self { rows, received: Vec::new(), path: Vec::new(), first: None }
    }
}

impl Tap for Felt {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.first.get_or_insert(block.first_sample);
        self.rows.close(block.first_sample, |row| self.received.push(row));
        self.rows.add(block);
        let rows = block.position_m.iter().zip(block.velocity_m_s).zip(block.contact_samples);
        self.path.extend(rows.map(|((p, v), row)| (*p, *v, row.height_m)));
    }
}

/// Reports at `hz` of a stroke, felt at `rows_hz`; without a `material` the surface is soft or
/// sand.
pub struct Stroke {
    pub sample_rate_hz: f64,
    pub rows_hz: f64,
    pub reports_hz: f64,
    pub seconds: f64,
}

impl Stroke {
    pub fn run(&self, surface: Surface, sample: impl Fn(f64) -> ContactSample) -> Felt {
        let config = Config { sample_rate_hz: self.sample_rate_hz, ..Config::default() };
        let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
        let id = scene.add_surface(surface).unwrap();
        let mut felt = Felt::new(self.rows_hz, self.sample_rate_hz);
        let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
        for step in 0..(self.seconds * self.reports_hz) as u32 {
            let t = f64::from(step) / self.reports_hz;
            let event = if step == 0 {
                ContactEvent::begin(ContactId(1), id, ChannelId(0), sample(t))
            } else {
                ContactEvent::moved(ContactId(1), sample(t))
            };
            scene.report(t, event).unwrap();
            let until = ((t + 1.0 / self.reports_hz) * self.sample_rate_hz) as u64;
            while renderer.position() < until {
                let n = 64.min((until - renderer.position()) as usize);
                renderer.render_tapped(&mut [&mut haptic[..n]], &mut [&mut audio[..n]], &mut felt);
            }
        }
        let Felt { rows, received, .. } = &mut felt;
        rows.close(u64::MAX, |row| received.push(row));
        received.retain(|row| matches!(row.of, Of::Contact(_)));
        felt
    }
}

pub fn block_of(material: SolidMaterial) -> Surface {
    let noise = SolidNoise::new(material.parameters(), 7).unwrap();
    Surface::new(noise, SIDE_M, SIDE_M).unwrap().wraps(false).friction(0.0).micro_relief_m(0.0)
}

pub fn sand(law: SandLaw) -> Surface {
    let design = SandDesign { width_m: SIDE_M, height_m: SIDE_M, cells: 400, law, ..SandDesign::default() };
    Surface::new(SandSource::synchronous(&design, 3).unwrap(), SIDE_M, SIDE_M).unwrap().wraps(false)
}
