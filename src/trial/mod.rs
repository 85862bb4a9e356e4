//! Trials: what reference motions come to on a body, and on a surface with its body and each probe.

mod bench;

use crate::game::levels::{BodyTrial, FAST_M_S, FORCES_N, Probes, StrokeTrial, SurfaceTrials, Trials, kinds};
use crate::model::body::Body;
use crate::model::config::Config;
use crate::model::error::AddError;
use crate::model::event::Touching;
use crate::model::levels::{
    FROM, PAUSE_S, REFERENCE_FORCE_N, REFERENCE_SPEED_M_S, STROKE_S, WAYS, mean_power,
};
use crate::model::material::Material;
use crate::model::probe::THING_PROBE;
use crate::model::surface::{Roughness, Surface};
use asperity_dsp::micro_contact::Probe;
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, Setup, SurfaceBlock};
use bench::{Bench, Motion, RATE_HZ};
use std::hash::{DefaultHasher, Hash};

/// Trials of every scene.
pub(crate) const TRIALS: Trials = Trials { of_body, of_surface, content };

/// Length of each, and time between two of them, s: the next one is louder.
const FAST_S: f64 = 0.2;
const FAST_PAUSE_S: f64 = 0.02;
/// Jumps of their force: a physics engine's contacts carry now less and now more than the weight
/// that rests on them, from step to step.
const FAST_JUMPS: f64 = 0.5;

/// Strikes a body and draws it over a plain ground.
fn of_body(config: &Config, body: &Body) -> Result<BodyTrial, AddError> {
    let mut bench = Bench::new(config)?;
    let id = bench.scene.add_body(alone(body))?;
    let surface = bench.scene.add_surface(plain_ground()?)?;
    // All of a rigid thing: what is heard of its tip alone would make bodies, and strikes, louder.
    let rigid = THING_PROBE;
    let rigid = bench.scene.add_probe(rigid)?;
    let drawn = Touching::on(surface).probe(rigid).held_by(id);
    let drawn = bench.stroke(drawn, 0, [1.0; 2], &along(WAYS[1])).heard.sqrt();
    let [struck, burst] = bench.strikes(id);
    Ok(BodyTrial { drawn, struck, burst })
}

/// Renders over a surface with each probe, and gives the surface back. What rings is `body`: its
/// own, or where it has none, what is held. Each probe has an engine of its own, in which nothing
/// rings yet.
fn of_surface(
    config: &Config,
    mut surface: Surface,
    body: &Body,
    probes: &Probes,
) -> Result<SurfaceTrials, AddError> {
    let mut trials = Vec::new();
    for (place, probe) in probes {
        let trial;
        (surface, trial) = with_probe(config, surface, body, place.map(|_| *probe))?;
        trials.push(trial);
    }
    Ok((surface, trials))
}

fn with_probe(
    config: &Config,
    mut surface: Surface,
    body: &Body,
    probe: Option<Probe>,
) -> Result<(Surface, StrokeTrial), AddError> {
    let mut bench = Bench::new(config)?;
    let id = bench.scene.add_body(alone(body))?;
    let own = surface.body;
    surface.body = own.map(|_| id);
    let size_m = [surface.width_m, surface.height_m];
    let probe = probe.map(|probe| bench.scene.add_probe(probe)).transpose()?;
    let holder = own.is_none().then_some(id);
    let touching = Touching { probe, holder, ..Touching::on(bench.scene.add_surface(surface)?) };
    let channels = kinds(&config.actuators).len();
    let both: Vec<[f64; 2]> =
        (0..channels).map(|channel| reference(&mut bench, touching, channel, size_m)).collect();
    let fast = FORCES_N.map(|force_n| {
        let fast = Motion {
            force_n,
            speed_m_s: FAST_M_S,
            jumps: FAST_JUMPS,
            length_s: FAST_S,
            pause_s: FAST_PAUSE_S,
            ..along(WAYS[1])
        };
        bench.stroke(touching, 0, size_m, &fast).heard.sqrt()
    });
    let trial = StrokeTrial {
        heard: both.iter().fold(0.0, |most, [heard, _]| f64::max(most, *heard)),
        felt: both.iter().map(|[_, felt]| *felt).collect(),
        fast,
    };
    let slot = bench.renderer.hand_over().surfaces.pop();
    let (_, slot) = slot.ok_or(AddError::Unknown("surface"))?;
    Ok((Surface { body: own, ..slot.surface }, trial))
}

/// Rms heard and felt of the reference stroke in all directions.
fn reference(bench: &mut Bench, touching: Touching, channel: usize, size_m: [f64; 2]) -> [f64; 2] {
    let powers = WAYS.map(|way| bench.stroke(touching, channel, size_m, &along(way)));
    [powers.map(|power| power.heard), powers.map(|power| power.felt)]
        .map(|powers| mean_power(&powers).unwrap_or(0.0).sqrt())
}

/// The reference stroke.
fn along(way: [f64; 2]) -> Motion {
    Motion {
        way,
        speed_m_s: REFERENCE_SPEED_M_S,
        force_n: REFERENCE_FORCE_N,
        jumps: 0.0,
        length_s: STROKE_S,
        pause_s: PAUSE_S,
    }
}

/// The body on the bench's only bus, as loud as its modes.
fn alone(body: &Body) -> Body {
    Body {
        bus: 0,
        gain: 1.0,
        strike_gain: None,
        least_time_s: 0.0,
        sends: Default::default(),
        variation: 0.0,
        ..body.clone()
    }
}

/// A plane of stone.
fn plain_ground() -> Result<Surface, AddError> {
    Surface::flat(1.0, 1.0)
        .map(|plane| plane.material(Material::STONE))
        .map_err(|_| AddError::Unknown("plane"))
}

/// Content of a surface as far as reference strokes meet it, hashed.
fn content(surface: &mut Surface) -> Result<DefaultHasher, AddError> {
    let properties = surface.properties();
    surface.source.prepare(&Setup { sample_rate_hz: RATE_HZ, voices: 1, tip_radii_m: &[] })?;
    let size_m = [surface.width_m, surface.height_m];
    let mut hasher = DefaultHasher::new();
    sampled(&mut *surface.source, size_m, &mut hasher);
    if let Roughness::Map(map) = &mut surface.roughness {
        sampled(&mut **map, size_m, &mut hasher);
    } else {
        format!("{:?}", surface.roughness).hash(&mut hasher);
    }
    let Surface { wraps, strike_position, micro_relief_m, outer_scale_m, friction, .. } = *surface;
    let finish = (size_m, wraps, strike_position, micro_relief_m, outer_scale_m, friction);
    let Surface { compliance_m_n, excitation, stick_slip, frame, .. } = *surface;
    let Surface { micro_relief_octaves_db, long_waves, .. } = *surface;
    let rest = (compliance_m_n, excitation, stick_slip, frame, micro_relief_octaves_db, long_waves);
    let source = (properties.band, properties.reach_m, properties.extension);
    format!("{finish:?} {rest:?} {source:?}").hash(&mut hasher);
    Ok(hasher)
}

/// Hashes heights and slopes along the ways of the reference stroke.
fn sampled(source: &mut dyn HeightField, size_m: [f64; 2], hasher: &mut DefaultHasher) {
    const STEP_M: f64 = STROKE_S * REFERENCE_SPEED_M_S / MAX_BLOCK as f64;
    for way in WAYS {
        let place = |i: usize| [0, 1].map(|axis| FROM[axis] * size_m[axis] + way[axis] * i as f64 * STEP_M);
        let position_m: [[f64; 2]; MAX_BLOCK] = std::array::from_fn(place);
        let path = PathBlock {
            position_m: &position_m,
            velocity_m_s: &[way.map(|share| share * REFERENCE_SPEED_M_S); MAX_BLOCK],
            footprint_m: &[STEP_M; MAX_BLOCK],
            slopes: true,
            ..PathBlock::default()
        };
        let mut out = SurfaceBlock::default();
        source.sample(&path, &mut out);
        let slopes = out.gradient.as_flattened();
        let numbers = out.height_m.iter().chain(slopes).chain(&out.roughness).chain(&out.friction);
        numbers.for_each(|x| x.to_bits().hash(hasher));
    }
}
