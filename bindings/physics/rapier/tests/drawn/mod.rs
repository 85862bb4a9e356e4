//! Things and ground that are drawn by chance, for levels in any physics engine.

use asperity::dsp::rng::Rng;
use asperity::{Body, Material, Stock, Surface};

/// A thing of 10 g to 100 kg and ground of 1 µm to 1 mm.
pub struct Drawn {
    pub mass_kg: f64,
    /// Ground of 8 m by 8 m.
    pub ground: Surface,
    pub ground_of: Material,
    /// Body that rings under the ground, if any does.
    pub slab: Option<Body>,
    pub thing: Body,
    pub thing_of: Material,
    /// Half the height of a collider about as large as wood of its mass, m.
    pub half_m: f32,
    /// A ball, a cylinder, or twice a box of 3 to 2 to 2.
    pub shape: u32,
}

fn material(rng: &mut Rng) -> Material {
    Material::PRESETS[(rng.uniform() * Material::PRESETS.len() as f64) as usize].material
}

impl Drawn {
    pub fn new(rng: &mut Rng) -> Self {
        let [mass_kg, relief_m] =
            [10f64.powf(-2.0 + 4.0 * rng.uniform()), 10f64.powf(-6.0 + 3.0 * rng.uniform())];
        let ground_of = material(rng);
        let slab = (rng.uniform() < 0.7).then(|| Body::stock(Stock::Plate, ground_of, 0.5).unwrap());
        let kind = Stock::ALL[(rng.uniform() * Stock::ALL.len() as f64) as usize].1;
        let (thing_of, size_m) = (material(rng), 0.3 * (mass_kg / 5.0).cbrt().clamp(0.1, 3.0));
        Self {
            mass_kg,
            ground: Surface::flat(8.0, 8.0)
                .unwrap()
                .material(ground_of)
                .micro_relief_m(relief_m)
                .wraps(false),
            ground_of,
            slab,
            thing: Body::stock(kind, thing_of, size_m).unwrap(),
            thing_of,
            half_m: (0.5 * (mass_kg / 700.0).cbrt()) as f32,
            shape: (4.0 * rng.uniform()) as u32,
        }
    }
}

/// Number of sixty of which limiters take 6 dB at most.
pub fn within(mut limited_db: impl FnMut(Drawn) -> f64) -> usize {
    let mut rng = Rng::new(5460);
    let limited: Vec<f64> = (0..60).map(|_| limited_db(Drawn::new(&mut rng))).collect();
    let within = limited.iter().filter(|by_db| **by_db <= 6.0).count();
    let most_db = limited.iter().fold(0.0, |a, b| f64::max(a, *b));
    println!("limiter ≤ 6 dB in {within} of 60, at most {most_db:.1} dB");
    within
}
