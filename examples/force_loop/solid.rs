//! Rows of solids against their law, two bodies cut from one block, and readers that come late.

use crate::picture::{Curve, svg};
use asperity::live::ports::{Force, ForcePort, ForceRow, Of};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::{SolidCut, SolidNoise};
use asperity::{ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Surface, SurfaceFrame};
use std::error::Error;
use std::path::Path;

const SIDE_M: f64 = 0.2;
const SEED: u64 = 7;
const ROWS_HZ: f64 = 5000.0;
const LAW: &str = "#e0a458";
const OURS: &str = "#1b6ca8";

type Failed = Box<dyn Error>;

/// Writes materials.svg, one_block.svg and readers.svg.
pub fn draw(folder: &Path) -> Result<(), Failed> {
    let mut panels = Vec::new();
    for material in SolidMaterial::SEVEN {
        let (ours, law, off) = rows_and_law(material)?;
        println!("{:11} rows are {:.2} % off the law", material.name(), 1e2 * off);
        let curve = |name: &str, colour, points| Curve { name: name.into(), colour, points };
        panels.push((material.name(), vec![curve("law", LAW, law), curve("rows", OURS, ours)]));
    }
    let panels: Vec<_> = panels.into_iter().map(|(name, curves)| (name, "s", curves)).collect();
    let title = "force along u of seven solids, N, 0.15 m/s, 0.5 N: rows at 5 kHz and the law";
    std::fs::write(folder.join("materials.svg"), svg(title, &panels))?;
    one_block(folder)?;
    readers(folder)
}

fn solid(material: SolidMaterial) -> Result<SolidNoise, Failed> {
    Ok(SolidNoise::new(material.parameters(), SEED)?)
}

/// Reports 60 times a second; after each, `read` is let at the ports.
fn stroke(
    surface: Surface,
    seconds: f64,
    ports: &[f64],
    sample: impl Fn(f64) -> ContactSample,
    mut read: impl FnMut(f64, &mut [ForcePort]),
) -> Result<(), Failed> {
    let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
    let id = scene.add_surface(surface)?;
    let open = |holds_s: &f64| scene.open_port(Force { rate_hz: ROWS_HZ, holds_s: *holds_s });
    let mut ports = ports.iter().map(open).collect::<Result<Vec<_>, _>>()?;
    let (mut haptic, mut audio) = ([0.0; 64], [0.0; 64]);
    for step in 0..(60.0 * seconds) as u32 {
        let t = f64::from(step) / 60.0;
        scene.report(
            t,
            match step {
                0 => ContactEvent::begin(ContactId(1), id, ChannelId(0), sample(t)),
                _ => ContactEvent::moved(ContactId(1), sample(t)),
            },
        )?;
        while (renderer.position() as f64) < (t + 1.0 / 60.0) * renderer.sample_rate_hz() {
            renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        }
        read(t, &mut ports);
    }
    Ok(())
}

fn rows(port: &mut ForcePort) -> impl Iterator<Item = ForceRow> {
    std::iter::from_fn(|| port.read()).filter(|row| matches!(row.of, Of::Contact(_)))
}

type Points = Vec<[f64; 2]>;

/// The rows of a stroke along u, the law at where it was, and how far they are apart, over the
/// law's rms.
fn rows_and_law(material: SolidMaterial) -> Result<(Points, Points, f64), Failed> {
    let noise = solid(material)?;
    let surface =
        Surface::new(solid(material)?, SIDE_M, SIDE_M)?.wraps(false).friction(0.0).micro_relief_m(0.0);
    let velocity = [0.15, 0.0];
    let at = |t: f64| [0.03 + velocity[0] * t, 0.08];
    let mut ours = Vec::new();
    let sample = |t: f64| ContactSample::new(at(t).map(|x| x / SIDE_M), 0.5).sliding(velocity);
    stroke(surface, 0.5, &[2.0], sample, |_, ports| {
        ours.extend(rows(&mut ports[0]).map(|row| [row.tick as f64 / ROWS_HZ, row.force_n[0]]));
    })?;
    // The path is smoothed, and lags by so much as fits best.
    let law_at = |t: f64, lag_s: f64| noise.force_n(at(t - lag_s), velocity, 0.5, 0.0, 0)[0];
    ours.retain(|[t, _]| (0.2..0.4).contains(t));
    let off = |lag_s: f64| {
        let sums = ours.iter().fold([0.0; 2], |[error, power], [t, force_n]| {
            let wanted_n = law_at(*t, lag_s);
            [error + (force_n - wanted_n).powi(2), power + wanted_n.powi(2)]
        });
        (sums[0] / sums[1]).sqrt()
    };
    let lags = (0..2000).map(|step| 1e-5 * f64::from(step));
    let lag_s = lags.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0.0);
    let law = ours.iter().map(|[t, _]| [*t, law_at(*t, lag_s)]).collect();
    let off = off(lag_s);
    Ok((ours, law, off))
}

/// The height under a contact that rests somewhere.
fn height_m(surface: Surface, sample: ContactSample) -> Result<f64, Failed> {
    struct Last(f64);
    impl asperity::Tap for Last {
        fn contact(&mut self, block: &asperity::ContactBlock<'_>) {
            self.0 = block.contact_samples.last().map_or(self.0, |row| row.height_m);
        }
    }
    let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
    let id = scene.add_surface(surface)?;
    scene.report(0.0, ContactEvent::begin(ContactId(1), id, ChannelId(0), sample))?;
    let mut last = Last(0.0);
    for _ in 0..40 {
        renderer.render_tapped(&mut [&mut [0.0; 64]], &mut [&mut [0.0; 64]], &mut last);
    }
    Ok(last.0)
}

/// A cube's face z = 0 and its face y = 0, which meet at the edge along x, and a sphere of 4 cm
/// about its corner: along the circle where it cuts both.
fn one_block(folder: &Path) -> Result<(), Failed> {
    let faces = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]];
    let (mut cube, mut sphere, mut worst_m) = (Vec::new(), Vec::new(), 0.0_f64);
    for step in -120..=120 {
        let angle = 0.01 * f64::from(step);
        let (across, along) = (0.04 * angle.abs().sin(), 0.04 * angle.cos());
        let (point, [u, v]) =
            if step >= 0 { ([along, across, 0.0], faces[0]) } else { ([along, 0.0, across], faces[1]) };
        let frame = SurfaceFrame::new([0.0; 3], u, v)?;
        let [u_axis, v_axis] = frame.axes();
        let cut =
            solid(SolidMaterial::Granite)?.with_cut(SolidCut::of_body(frame.origin_m(), u_axis, v_axis));
        let face = Surface::new(cut, SIDE_M, SIDE_M)?.wraps(false).frame(frame).micro_relief_m(0.0);
        let round = Surface::new(solid(SolidMaterial::Granite)?, SIDE_M, SIDE_M)?.micro_relief_m(0.0);
        let on_cube = height_m(face, ContactSample::new([0.0; 2], 0.5).placed(point))?;
        let on_sphere = height_m(round, ContactSample::new([0.3, 0.9], 0.5).placed(point))?;
        worst_m = worst_m.max((on_cube - on_sphere).abs());
        cube.push([40.0 * angle, 1e6 * on_cube]);
        sphere.push([40.0 * angle, 1e6 * on_sphere]);
    }
    println!("cube and sphere of one block: {worst_m:.1e} m apart");
    let curves = vec![
        Curve { name: "sphere".into(), colour: LAW, points: sphere },
        Curve { name: "cube".into(), colour: OURS, points: cube },
    ];
    let title = "granite: a cube's two faces left and right of their edge, and a sphere through both";
    std::fs::write(folder.join("one_block.svg"), svg(title, &[("height, µm", "mm", curves)]))?;
    Ok(())
}

/// One reader takes all, one looks after every report, one stalls for a second and finds the newest
/// tenth.
fn readers(folder: &Path) -> Result<(), Failed> {
    let surface = Surface::new(solid(SolidMaterial::Gravel)?, SIDE_M, SIDE_M)?.wraps(false);
    let sample = |t: f64| ContactSample::new([(0.02 + 0.07 * t) / SIDE_M, 0.5], 0.5).sliding([0.07, 0.0]);
    let mut read = [0.0; 3];
    let mut curves: [Points; 4] = Default::default();
    stroke(surface, 2.0, &[4.0, 0.1, 0.1], sample, |t, ports| {
        for (reader, port) in ports.iter_mut().enumerate() {
            let looks = match reader {
                0 => t > 1.9,
                1 => true,
                _ => !(0.5..1.5).contains(&t),
            };
            read[reader] += if looks { std::iter::from_fn(|| port.read()).count() as f64 } else { 0.0 };
            curves[reader].push([t, read[reader]]);
        }
        curves[3].push([t, ports[2].lost() as f64]);
    })?;
    let names = ["at the end", "each report", "stalls for a second", "lost by that one"];
    let colours = [LAW, OURS, "#d1495b", "#3a7d44"];
    let curves = names.into_iter().zip(colours).zip(curves);
    let curves = curves.map(|((name, colour), points)| Curve { name: name.into(), colour, points }).collect();
    println!("readers: {read:.0?} rows read");
    let title = "rows that three readers of the same forces have read";
    std::fs::write(folder.join("readers.svg"), svg(title, &[("rows", "s", curves)]))?;
    Ok(())
}
