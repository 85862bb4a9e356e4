//! Curves in an SVG: panels, one over the other.

use std::fmt::Write;

/// One curve: its name, its colour, its points.
pub struct Curve {
    pub name: String,
    pub colour: &'static str,
    pub points: Vec<[f64; 2]>,
}

const SIZE: [f64; 2] = [860.0, 250.0];
const LEFT: f64 = 70.0;

/// The whole picture: a title, then panels with what stands on their axis, and the unit along.
pub fn svg(title: &str, panels: &[(&str, &str, Vec<Curve>)]) -> String {
    let height = 60.0 + (SIZE[1] + 50.0) * panels.len() as f64;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1080\" height=\"{height}\" font-family=\"sans-serif\" \
         font-size=\"13\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\
         <text x=\"{LEFT}\" y=\"28\" font-size=\"17\">{title}</text>"
    );
    for (index, (axis, unit, curves)) in panels.iter().enumerate() {
        let top = 50.0 + (SIZE[1] + 50.0) * index as f64;
        panel(&mut out, top, [axis, unit], curves).expect("a string takes everything");
    }
    out + "</svg>\n"
}

fn panel(out: &mut String, top: f64, [axis, unit]: [&str; 2], curves: &[Curve]) -> std::fmt::Result {
    let range = |a: usize| {
        let all = curves.iter().flat_map(|curve| &curve.points).map(|point| point[a]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        (low, (high - low).max(1e-9))
    };
    let ((x0, width), (y0, height)) = (range(0), range(1));
    let at =
        |[x, y]: [f64; 2]| [LEFT + (x - x0) / width * SIZE[0], top + SIZE[1] - (y - y0) / height * SIZE[1]];
    write!(
        out,
        "<rect x=\"{LEFT}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#999\"/>\
         <text x=\"{LEFT}\" y=\"{}\">{axis}</text>",
        SIZE[0],
        SIZE[1],
        top + SIZE[1] + 34.0
    )?;
    for part in 0..=4 {
        let t = f64::from(part) / 4.0;
        let [x, y] = at([x0 + t * width, y0 + t * height]);
        write!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.2}</text><text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{:.2} {unit}</text>",
            LEFT - 6.0,
            y + 4.0,
            y0 + t * height,
            top + SIZE[1] + 17.0,
            x0 + t * width
        )?;
    }
    for (row, curve) in curves.iter().enumerate() {
        let points: Vec<String> =
            curve.points.iter().map(|point| at(*point)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let [x, y] = [LEFT + SIZE[0] + 12.0, top + 16.0 + 18.0 * row as f64];
        write!(
            out,
            "<polyline fill=\"none\" stroke=\"{0}\" stroke-width=\"1.3\" points=\"{1}\"/>\
             <text x=\"{x}\" y=\"{y}\" fill=\"{0}\">{2}</text>",
            curve.colour,
            points.join(" "),
            curve.name
        )?;
    }
    Ok(())
}
