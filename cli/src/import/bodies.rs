//! Modal models → modes files.

use crate::error::CliError;
use asperity::ModeShapes;
use asperity_shape::gltf::Document;
use asperity_shape::vector::{add_scaled, cross, dot, length, sub, unit};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// A model as a modes file, scaled by the node's gain.
pub fn modes(document: &Document, model: &Value, at: &str, gain: f64) -> Result<String, CliError> {
    let column = |key: &str, kind: &str| document.accessor(&model[key], kind, &format!("{at}.{key}"));
    let frequencies = column("frequencies", "SCALAR")?.values;
    let decays = column("decayRates", "SCALAR")?.values;
    let points = column("positions", "VEC3")?.triples();
    let shapes = column("shapes", "VEC3")?.triples();
    let (modes, count) = (frequencies.len(), points.len());
    if decays.len() != modes || shapes.len() != modes * count {
        let what = format!(
            "holds {} decays and {} shapes for {modes} modes at {count} points",
            decays.len(),
            shapes.len()
        );
        return Err(document.wrong(at, what, "must hold a decay a mode and a shape a mode and point").into());
    }
    if let Some(bad) = frequencies.iter().zip(&decays).position(|(hz, decay)| *hz <= 0.0 || *decay < 0.0) {
        let what = format!("mode {bad} has {} Hz and decays by {} 1/s", frequencies[bad], decays[bad]);
        return Err(document.wrong(at, what, "must be positive, and not grow").into());
    }
    let triangles = triangles(document, model, at, count)?;
    let (normals, areas) = normals(&points, &triangles);
    let whole: f64 = areas.iter().sum();
    let along = |mode: usize, point: usize| dot(shapes[mode * count + point], normals[point]);
    // As `asperity modes` has it: a mode's gain is the root mean square, over the surface, of its
    // motion out of it.
    let square = |mode: usize| (0..count).map(|p| areas[p] * along(mode, p).powi(2)).sum::<f64>() / whole;
    let gains: Vec<f64> = (0..modes).map(|mode| gain * square(mode).sqrt()).collect();
    // Where a strike excites all modes most evenly.
    let lively = |point: usize| -> f64 {
        let power = |mode: usize| along(mode, point).powi(2) + 1e-4 * square(mode);
        (0..modes).map(|mode| power(mode).max(f64::MIN_POSITIVE).ln()).sum()
    };
    let scores: Vec<f64> = (0..count).map(lively).collect();
    let struck_point = (0..count).max_by(|&a, &b| scores[a].total_cmp(&scores[b])).unwrap_or(0);
    let list: Vec<Value> = (0..modes)
        .map(|mode| {
            json!({
                "frequency_hz": frequencies[mode], "decay_per_s": decays[mode],
                "amplitude": gains[mode] * along(mode, struck_point), "phase_rad": FRAC_PI_2,
            })
        })
        .collect();
    let source = model["name"].as_str().unwrap_or("glTF");
    let mut file = json!({
        "format": asperity::files::modes_file::FORMAT, "version": 1, "source": source, "impulse_n_s": 1.0, "modes": list,
    });
    if !triangles.is_empty() {
        let motion = |mode: usize| {
            shapes[mode * count..(mode + 1) * count].iter().map(|s| s.map(|x| x as f32)).collect()
        };
        let shapes = ModeShapes {
            points_m: points.clone(),
            triangles,
            gains,
            phi_per_sqrt_kg: (0..modes).map(motion).collect(),
            struck_point,
        };
        file["version"] = json!(2);
        file["unit"] = json!("relative");
        file["shapes"] =
            serde_json::to_value(shapes).map_err(|error| document.wrong(at, error, "please report it"))?;
    }
    let text = file.to_string();
    // What the engine would refuse is no body.
    asperity::ModalModel::parse(&text).map_err(|error| CliError::from_error(error).within(at))?;
    Ok(text)
}

fn triangles(document: &Document, model: &Value, at: &str, count: usize) -> Result<Vec<[u32; 3]>, CliError> {
    if model["indices"].is_null() {
        return Ok(Vec::new());
    }
    let at = format!("{at}.indices");
    let corners = document.accessor(&model["indices"], "SCALAR", &at)?.values;
    if corners.len() % 3 != 0 || corners.iter().any(|corner| *corner >= count as f64) {
        return Err(document
            .wrong(at, "are no triangles of the points", "must be threes, each below the number of points")
            .into());
    }
    Ok(corners.chunks_exact(3).map(|c| [c[0] as u32, c[1] as u32, c[2] as u32]).collect())
}

/// Out of the surface at every point, and its share of the area; without triangles away from the
/// middle, and all alike.
fn normals(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> (Vec<[f64; 3]>, Vec<f64>) {
    let middle: [f64; 3] =
        std::array::from_fn(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64);
    let mut normals = vec![[0.0; 3]; points.len()];
    let mut areas = vec![if triangles.is_empty() { 1.0 } else { 0.0 }; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        let (u, v) = (sub(b, a), sub(c, a));
        let area = cross(u, v);
        for corner in triangle {
            let normal = &mut normals[*corner as usize];
            *normal = add_scaled(*normal, 1.0, area);
            areas[*corner as usize] += length(area) / 3.0;
        }
    }
    let normals = normals
        .iter()
        .zip(points)
        .map(|(normal, point)| {
            let outwards = if dot(*normal, *normal) > 0.0 { *normal } else { sub(*point, middle) };
            if length(outwards) > 0.0 { unit(outwards) } else { [0.0, 0.0, 1.0] }
        })
        .collect();
    (normals, areas)
}
