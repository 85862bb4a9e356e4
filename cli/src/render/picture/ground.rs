//! A surface from above, and the way of what slides over it.

use super::{Ground, Take, drawn};
use asperity::Wrap;
use asperity_plot::{Axis, Layer, Panel, Picture, Series, colour};

/// The finger's way over the surface, seen from above; v grows downwards, as in the image.
pub(super) fn ground_panel(take: &Take<'_>, ground: &Ground) -> Panel {
    let [width_m, height_m] = ground.extent_m;
    let picture = Picture {
        x: [0.0, width_m],
        y: [height_m, 0.0],
        width: ground.heights.width,
        height: ground.heights.height,
        values: ground.heights.values.iter().map(|&height| height as f32).collect(),
        scale: colour::Scale::Earth,
        bar: None,
    };
    let across = Axis::new("u", "m").range(0.0, width_m);
    let down = Axis::new("v", "m").range(height_m, 0.0);
    let title = match take.grounds.len() {
        1 => ground.title.clone(),
        _ => ground.surface.trim_start_matches(" on ").to_owned(),
    };
    let mut panel = Panel::new(title, across, down).with(picture).true_scale();
    for (contact, colour) in drawn(take).filter(|(contact, _)| contact.label.ends_with(&ground.surface)) {
        panel = panel.with(Layer::Line {
            label: String::new(),
            colour: colour.to_owned(),
            width_px: 1.8,
            fill: None,
            dashed: false,
            data: Series::Points(on_one_tile(&contact.path_uv, ground)),
        });
    }
    panel
}

/// A path on the one tile of a surface that is drawn, m; where it goes on at the other edge the
/// line is broken.
fn on_one_tile(path_uv: &[[f64; 2]], ground: &Ground) -> Vec<[f64; 2]> {
    let fold = |x: f64| match ground.wrap {
        Wrap::Repeat => x.rem_euclid(1.0),
        Wrap::Mirror => 1.0 - (x.rem_euclid(2.0) - 1.0).abs(),
        Wrap::Clamp => x,
    };
    let place = |uv: [f64; 2]| [fold(uv[0]) * ground.extent_m[0], fold(uv[1]) * ground.extent_m[1]];
    let tile = |uv: [f64; 2]| uv.map(f64::floor);
    let mut points = Vec::with_capacity(path_uv.len());
    for (n, &uv) in path_uv.iter().enumerate() {
        if ground.wrap == Wrap::Repeat && n > 0 && tile(path_uv[n - 1]) != tile(uv) {
            points.push([f64::NAN; 2]);
        }
        points.push(place(uv));
    }
    points
}
