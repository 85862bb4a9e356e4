//! The picture of a solved body: its first shapes on the mesh, its frequencies, its damping.

use asperity_dsp::damping::Damping;
use asperity_plot::colour::Scale;
use asperity_plot::{Axis, Figure, Layer, Panel, Picture, Series, palette};
use asperity_shape::SolvedBody;
use asperity_shape::modes_file::ModesFile;
use asperity_shape::vector::{Vec3, add_scaled, bounds, dot, unit};

/// Shapes drawn, in rows of four.
const SHAPES: usize = 8;
/// Pixels a picture of a shape is wide.
const WIDTH: usize = 300;
/// A shape's greatest motion in the picture, of the longest side.
const SWING: f64 = 0.06;

/// The picture as SVG.
pub fn svg(name: &str, body: &SolvedBody, damping: &Damping, file: &ModesFile) -> String {
    let mut figure = Figure::new(format!("{name}: {} modes", file.modes.len())).subtitle(format!(
        "{:.1} cm³, {:.1} g, {} elements, {} unknowns; motion along the normal, blue inwards, red outwards",
        1e6 * body.volume_m3,
        1e3 * body.mass_kg,
        body.elements,
        body.degrees_of_freedom
    ));
    for remark in &body.remarks {
        figure = figure.subtitle(format!("warning: {remark}"));
    }
    let shown = body.frequency_hz.len().min(SHAPES);
    for row in (0..shown).collect::<Vec<_>>().chunks(4) {
        figure.row(210.0, row.iter().map(|&m| shape(body, m)));
    }
    let points: Vec<[f64; 2]> = file.modes.iter().map(|m| [m.frequency_hz, 6.908 / m.decay_per_s]).collect();
    let (low, high) = points.iter().fold((f64::MAX, 0.0_f64), |(l, h), p| (l.min(p[0]), h.max(p[0])));
    let law = (0..=100).map(|i| low * (high / low).powf(f64::from(i) / 100.0));
    let law: Vec<[f64; 2]> = law.map(|hz| [hz, damping.t60_s(hz)]).collect();
    let panel = Panel::new(
        "how long each mode rings (60 dB), on the damping of its material",
        Axis::log("frequency", "Hz"),
        Axis::log("T60", "s"),
    )
    .with(Layer::line("", palette::GROUND_EDGE, Series::Points(law)))
    .with(Layer::Dots {
        label: String::new(),
        colour: palette::AUDIO.to_owned(),
        points,
        radius_px: vec![3.0],
        names: Vec::new(),
    });
    figure.row(180.0, [panel]);
    figure.svg()
}

/// One shape from above and the side, moved by itself, in the colours of its motion along the
/// normal.
fn shape(body: &SolvedBody, mode: usize) -> Panel {
    let field = &body.field;
    // From the front, the right and above.
    let (right, up) = ([0.82, -0.57, 0.0], unit([-0.33, -0.47, 0.82]));
    let towards = unit([0.47, 0.67, 0.57]);
    let (low, high) = bounds(&field.points).unwrap_or_default();
    let side = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    let size = |v: &Vec3| dot(*v, *v).sqrt();
    let most = field.shapes[mode].iter().map(size).fold(f64::MIN_POSITIVE, f64::max);
    let normal = (0..field.points.len()).map(|p| field.along_normal(mode, p)).collect::<Vec<_>>();
    let most_normal = normal.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    let placed: Vec<Vec3> = field
        .points
        .iter()
        .zip(&field.shapes[mode])
        .map(|(p, s)| {
            let p = add_scaled(*p, SWING * side / most, *s);
            [dot(p, right), dot(p, up), dot(p, towards)]
        })
        .collect();
    let (low, high) = bounds(&placed).unwrap_or_default();
    let extent = (high[0] - low[0]).max((high[1] - low[1]) * 1.3) * 1.08;
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let height = (WIDTH as f64 / 1.3) as usize;
    let x = [middle[0] - 0.5 * extent, middle[0] + 0.5 * extent];
    let y = [middle[1] - 0.5 * extent / 1.3, middle[1] + 0.5 * extent / 1.3];
    let per_m = WIDTH as f64 / extent;
    let mut values = vec![0.0_f32; WIDTH * height];
    let mut depth = vec![f64::MIN; WIDTH * height];
    for triangle in &field.triangles {
        let corners = triangle.map(|i| {
            let p = placed[i as usize];
            [(p[0] - x[0]) * per_m, (y[1] - p[1]) * per_m, p[2]]
        });
        let colours = triangle.map(|i| normal[i as usize] / most_normal);
        fill(&corners, colours, [WIDTH, height], &mut values, &mut depth);
    }
    let axis = |name: &str, range: [f64; 2]| Axis::new(name, "m").range(range[0], range[1]);
    let title = format!("{:.1} Hz", body.frequency_hz[mode]);
    Panel::new(title, axis("across the view", x), axis("up the view", y)).true_scale().with(Picture {
        x,
        y,
        width: WIDTH,
        height,
        values,
        scale: Scale::Swing,
        bar: None,
    })
}

/// Fills a triangle where it lies in front of what is there.
fn fill(corners: &[[f64; 3]; 3], colours: [f64; 3], size: [usize; 2], values: &mut [f32], depth: &mut [f64]) {
    let [a, b, c] = corners;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area == 0.0 {
        return;
    }
    let range = |axis: usize| {
        let (low, high) =
            corners.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[axis]), h.max(p[axis])));
        (low.floor().max(0.0) as usize)..((high.ceil().max(0.0) as usize).min(size[axis]))
    };
    for row in range(1) {
        for column in range(0) {
            let (px, py) = (column as f64 + 0.5, row as f64 + 0.5);
            let v = ((px - a[0]) * (c[1] - a[1]) - (py - a[1]) * (c[0] - a[0])) / area;
            let w = ((b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0])) / area;
            let u = 1.0 - v - w;
            if u.min(v).min(w) < -1e-6 {
                continue;
            }
            let z = u * a[2] + v * b[2] + w * c[2];
            let at = row * size[0] + column;
            if z > depth[at] {
                depth[at] = z;
                let colour = u * colours[0] + v * colours[1] + w * colours[2];
                values[at] = (0.55 + 0.45 * colour) as f32;
            }
        }
    }
}
