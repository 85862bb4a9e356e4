//! Contacts side by side have the bits of each alone.

use asperity_dsp::micro_contact::{
    Bend, Beside, ContactSample, ContactState, GroundBetween, Integrator, LANES, MicroContact, Probe,
    run_side_by_side,
};
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;

/// A contact that is run alone and beside others.
struct Twin {
    design: MicroContact,
    alone: ContactState,
    beside: ContactState,
    height_m: Vec<f64>,
    force_n: Vec<f64>,
    bends: Vec<Bend>,
    halves: Vec<[Bend; 2]>,
    kind: usize,
    rows: [Vec<ContactSample>; 2],
}

/// What is known of the ground between samples: nothing, heights midway, or at the quarters.
fn known<'a>(kind: usize, bends: &'a [Bend], halves: &'a [[Bend; 2]]) -> GroundBetween<'a> {
    match kind {
        0 => GroundBetween::AtSamples,
        1 => GroundBetween::Midway(bends),
        _ => GroundBetween::Quarters(halves),
    }
}

/// Ground of a random kind under a random probe: smooth, bouncing, light, steep, or with numbers that are none.
fn twin(rng: &mut Rng, integrator: Integrator, level: Level, rate_hz: f64, n: usize) -> Twin {
    let probe = Probe {
        contact_stiffness_n_m: 1e4 * libm::exp2(8.0 * rng.uniform()),
        pad_damping_n_s_m: 2.0 * rng.uniform(),
        finger_mass_kg: 5e-3 + 0.04 * rng.uniform(),
        ..Probe::default()
    };
    let design = MicroContact::new(&probe, integrator, rate_hz).unwrap().on(level);
    let size_m = 1e-6 * libm::exp2(9.0 * rng.uniform());
    let (wave_hz, noise) = (50.0 + 2e3 * rng.uniform(), rng.uniform());
    let press_n = 0.01 + 2.0 * rng.uniform() * rng.uniform();
    let mut height_m: Vec<f64> = (0..n)
        .map(|i| {
            let t = i as f64 / rate_hz;
            size_m * (libm::sin(std::f64::consts::TAU * wave_hz * t) + 0.2 * noise * rng.normal())
        })
        .collect();
    let mut force_n: Vec<f64> = (0..n).map(|i| press_n * (1.0 + 0.5 * libm::sin(i as f64 * 1e-3))).collect();
    if rng.uniform() < 0.3 {
        let at = |rng: &mut Rng| ((n - 1) as f64 * rng.uniform()) as usize;
        (height_m[at(rng)], height_m[at(rng)]) = (f64::NAN, 0.5);
        (force_n[at(rng)], force_n[at(rng)]) = (-1.0, f64::INFINITY);
    }
    let state = if rng.uniform() < 0.5 {
        design.landing_later(height_m[0], force_n[0], 0.3 * rng.uniform(), rng.uniform())
    } else {
        design.riding(height_m[0], force_n[0], 0.01 * rng.normal())
    };
    let rows = [vec![ContactSample::default(); n], vec![ContactSample::default(); n]];
    let mut bend = || [(); 4].map(|()| 0.1 * size_m * rng.normal());
    let mut bends: Vec<Bend> = (0..n).map(|_| bend()).collect();
    let mut halves: Vec<[Bend; 2]> = (0..n).map(|_| [bend(), bend()]).collect();
    if rng.uniform() < 0.2 {
        let at = ((n - 1) as f64 * rng.uniform()) as usize;
        (bends[at][1], halves[at][1][3]) = (f64::NAN, f64::INFINITY);
    }
    let kind = (3.0 * rng.uniform()) as usize;
    Twin { design, alone: state, beside: state, height_m, force_n, bends, halves, kind, rows }
}

fn bits(row: &ContactSample) -> [u64; 8] {
    let onset = row.onset.map_or([0.0; 2], |onset| [onset.offset, onset.closing_m_s]);
    let [offset, closing_m_s] = onset;
    [
        row.height_m,
        row.normal_force_n,
        row.pad_m,
        row.pad_velocity_m_s,
        row.finger_m,
        row.contact_force_n,
        offset,
        closing_m_s,
    ]
    .map(f64::to_bits)
}

/// Runs all twins alone and beside each other, the latter in blocks of random lengths; how many onsets there were.
fn run(rng: &mut Rng, twins: &mut [Twin]) -> usize {
    let n = twins[0].height_m.len();
    for twin in twins.iter_mut() {
        let ground = known(twin.kind, &twin.bends, &twin.halves);
        twin.design.run_over(&mut twin.alone, &twin.height_m, &twin.force_n, ground, &mut twin.rows[0]);
    }
    let mut at = 0;
    while at < n {
        let end = (at + 1 + (100.0 * rng.uniform()) as usize).min(n);
        // The company changes, as it does where contacts come and go.
        let count = 1 + (twins.len() as f64 * rng.uniform()) as usize;
        let (together, left) = twins.split_at_mut(count.min(twins.len()));
        let mut contacts: Vec<_> = together
            .iter_mut()
            .map(|twin| Beside {
                design: &twin.design,
                state: &mut twin.beside,
                height_m: &twin.height_m[at..end],
                normal_force_n: &twin.force_n[at..end],
                ground: known(twin.kind, &twin.bends[at..end], &twin.halves[at..end]),
                out: &mut twin.rows[1][at..end],
            })
            .collect();
        run_side_by_side(&mut contacts);
        for Twin { design, beside, height_m, force_n, bends, halves, kind, rows, .. } in left {
            let ground = known(*kind, &bends[at..end], &halves[at..end]);
            design.run_over(beside, &height_m[at..end], &force_n[at..end], ground, &mut rows[1][at..end]);
        }
        at = end;
    }
    for (k, twin) in twins.iter().enumerate() {
        for (i, (alone, beside)) in twin.rows[0].iter().zip(&twin.rows[1]).enumerate() {
            assert_eq!(bits(alone), bits(beside), "contact {k}, row {i}: {alone:?} and {beside:?}");
            assert_eq!(alone.onset.is_some(), beside.onset.is_some());
        }
        assert_eq!(twin.alone, twin.beside);
    }
    twins.iter().flat_map(|twin| &twin.rows[0]).filter(|row| row.onset.is_some()).count()
}

#[test]
fn contacts_side_by_side_have_the_bits_of_each_alone_whatever_they_touch_and_however_blocks_are_cut() {
    let mut rng = Rng::new(31);
    for level in Level::available() {
        let mut onsets = 0;
        for round in 0..60 {
            let rate_hz = [22.05e3, 44.1e3, 48e3, 192e3][round % 4];
            let count = 1 + round % LANES;
            let mut twins: Vec<_> =
                (0..count).map(|_| twin(&mut rng, Integrator::ExactEvent, level, rate_hz, 1500)).collect();
            if round % 3 == 0 {
                // Alike, so that those whose samples are two steps have company.
                let kind = (3.0 * rng.uniform()) as usize;
                twins.iter_mut().for_each(|twin| twin.kind = kind);
            }
            onsets += run(&mut rng, &mut twins);
        }
        assert!(onsets > 1000, "{level:?}: too few events were met: {onsets}");
    }
}

#[test]
fn contacts_of_several_integrators_side_by_side_have_the_bits_of_each_alone() {
    let mut rng = Rng::new(32);
    for _ in 0..30 {
        let mut twins: Vec<_> = (0..LANES)
            .map(|_| {
                let integrator = Integrator::ALL[(4.0 * rng.uniform()) as usize];
                twin(&mut rng, integrator, Level::detect(), 44.1e3, 700)
            })
            .collect();
        run(&mut rng, &mut twins);
    }
}
