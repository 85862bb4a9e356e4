//! Lays a figure out and draws it.

use super::axis::Ruler;
use super::decimate::{polylines, tallest};
use super::svg::{Svg, TextStyle};
use super::{Axis, Figure, Layer, Panel, Picture, Row, Series};
use crate::pixels::png_rgb;

const LEFT_PX: f64 = 72.0;
const RIGHT_PX: f64 = 22.0;
const RIGHT_WITH_BAR_PX: f64 = 74.0;
const HEAD_PX: f64 = 26.0;
const FOOT_PX: f64 = 40.0;
const INK: &str = "#222";
const FAINT: &str = "#667";
const GRID: &str = "#e8eaed";
const FRAME: &str = "#9aa0a6";
/// Mean width of a letter over the font size.
const LETTER: f64 = 0.56;

pub fn figure(figure: &Figure) -> String {
    let mut svg = Svg::default();
    let mut y = 34.0;
    svg.text(
        [16.0, y],
        TextStyle { size: 19.0, colour: INK, bold: true, ..Default::default() },
        &figure.title,
    );
    let small = TextStyle { size: 12.5, colour: FAINT, ..Default::default() };
    let most = ((figure.width_px - 32.0) / (LETTER * small.size)) as usize;
    for line in figure.subtitle.iter().flat_map(|line| wrapped(line, most)) {
        y += 19.0;
        svg.text([16.0, y], small, &line);
    }
    y += 12.0;
    let any_bar = figure.rows.iter().flat_map(|row| &row.panels).any(|panel| bar_of(panel).is_some());
    for row in &figure.rows {
        y = draw_row(&mut svg, row, y, figure.width_px, any_bar);
    }
    svg.finish(figure.width_px, y + 8.0, &figure.title)
}

/// The words of `line` in lines of at most `most` letters.
fn wrapped(line: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in line.split(' ') {
        match lines.last_mut() {
            Some(last) if last.chars().count() + word.chars().count() < most => *last += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Draws one row and returns where the next begins.
fn draw_row(svg: &mut Svg, row: &Row, top: f64, width_px: f64, any_bar: bool) -> f64 {
    let total: f64 = row.panels.iter().map(|panel| panel.weight).sum();
    let mut x = 0.0;
    for (index, panel) in row.panels.iter().enumerate() {
        let cell = width_px * panel.weight / total;
        let last = index + 1 == row.panels.len();
        let right = if bar_of(panel).is_some() || (last && any_bar) { RIGHT_WITH_BAR_PX } else { RIGHT_PX };
        let plot = [x + LEFT_PX, top + HEAD_PX, (cell - LEFT_PX - right).max(40.0), row.height_px];
        draw_panel(svg, panel, if panel.true_scale { to_scale(panel, plot) } else { plot });
        x += cell;
    }
    top + HEAD_PX + row.height_px + FOOT_PX
}

/// The largest part of the place in which a unit is as long across as down.
fn to_scale(panel: &Panel, [left, top, width_px, height_px]: [f64; 4]) -> [f64; 4] {
    let (Some(x), Some(y)) = (panel.x.range, panel.y.range) else { return [left, top, width_px, height_px] };
    let (across, down) = ((x[1] - x[0]).abs(), (y[1] - y[0]).abs());
    let px_per_unit = (width_px / across).min(height_px / down);
    if !(px_per_unit.is_finite() && px_per_unit > 0.0) {
        return [left, top, width_px, height_px];
    }
    [left, top, (across * px_per_unit).max(20.0), (down * px_per_unit).max(20.0)]
}

fn bar_of(panel: &Panel) -> Option<&Picture> {
    panel.layers.iter().find_map(|layer| match layer {
        Layer::Picture(picture) if picture.bar.is_some() => Some(picture),
        _ => None,
    })
}

/// Place of a panel's values in the picture.
struct Place {
    x: Ruler,
    y: Ruler,
    plot: [f64; 4],
}

impl Place {
    fn x(&self, value: f64) -> f64 {
        self.plot[0] + self.x.place(value) * self.plot[2]
    }

    fn y(&self, value: f64) -> f64 {
        self.plot[1] + (1.0 - self.y.place(value)) * self.plot[3]
    }

    fn columns(&self) -> std::ops::Range<f64> {
        self.plot[0]..self.plot[0] + self.plot[2]
    }

    fn bottom(&self) -> f64 {
        self.plot[1] + self.plot[3]
    }
}

fn draw_panel(svg: &mut Svg, panel: &Panel, plot: [f64; 4]) {
    let (x, y) = extents(panel);
    let place = Place {
        x: Ruler::new(&x.fit(&panel.x), x.low, x.high, ((plot[2] / 80.0) as usize).max(2)),
        y: Ruler::new(&y.fit(&panel.y), y.low, y.high, ((plot[3] / 32.0) as usize).max(2)),
        plot,
    };
    draw_grid(svg, &place);
    svg.clip(plot);
    for layer in &panel.layers {
        draw_layer(svg, layer, &place);
    }
    svg.end_clip();
    svg.rect(plot, "", FRAME);
    draw_numbers(svg, &place);
    draw_head(svg, panel, plot);
    if let Some(picture) = bar_of(panel) {
        draw_bar(svg, picture, plot);
    }
}

/// The ends of the data along both axes; on a logarithmic axis only what is above zero counts.
fn extents(panel: &Panel) -> (Extent, Extent) {
    let mut x = Extent::new(&panel.x);
    let mut y = Extent::new(&panel.y);
    for layer in &panel.layers {
        match layer {
            Layer::Line { data: Series::Uniform { start, step, y: values }, .. } => {
                x.exact(*start);
                x.exact(start + step * values.len().saturating_sub(1) as f64);
                values.iter().for_each(|&value| y.take(value));
            }
            Layer::Line { data: Series::Points(points), .. } | Layer::Dots { points, .. } => {
                for point in points {
                    x.take(point[0]);
                    y.take(point[1]);
                }
            }
            Layer::Stems { points, .. } => {
                for point in points {
                    x.take(point[0]);
                    y.take(point[1]);
                }
                if !panel.y.log {
                    y.take(0.0);
                }
            }
            Layer::Rules { x: at, .. } => at.iter().for_each(|&value| x.take(value)),
            Layer::Picture(picture) => {
                picture.x.iter().for_each(|&value| x.exact(value));
                picture.y.iter().for_each(|&value| y.exact(value));
            }
        }
    }
    (x, y)
}

/// The ends of the data; signals and pictures reach to the panel's edges, dots and lines get room.
struct Extent {
    log: bool,
    low: f64,
    high: f64,
    tight: bool,
}

impl Extent {
    fn new(axis: &Axis) -> Self {
        Self { log: axis.log, low: f64::INFINITY, high: f64::NEG_INFINITY, tight: false }
    }

    fn take(&mut self, value: f64) {
        if value.is_finite() && (!self.log || value > 0.0) {
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        }
    }

    fn exact(&mut self, value: f64) {
        self.tight = true;
        self.take(value);
    }

    /// The axis with its range fixed where the data want it so.
    fn fit(&self, axis: &Axis) -> Axis {
        let fixed = axis.range.or((self.tight && self.high > self.low).then_some([self.low, self.high]));
        Axis { range: fixed, ..axis.clone() }
    }
}

fn draw_grid(svg: &mut Svg, place: &Place) {
    let [left, top, width, height] = place.plot;
    svg.rect(place.plot, "#fcfcfd", "");
    for tick in &place.x.ticks {
        let x = place.x(tick.at);
        let colour = if tick.text.is_empty() { "#f2f3f5" } else { GRID };
        svg.line([x, top], [x, top + height], colour, 1.0);
    }
    for tick in &place.y.ticks {
        let y = place.y(tick.at);
        let colour = if tick.text.is_empty() { "#f2f3f5" } else { GRID };
        svg.line([left, y], [left + width, y], colour, 1.0);
    }
}

fn draw_numbers(svg: &mut Svg, place: &Place) {
    let [left, top, width, height] = place.plot;
    let small = TextStyle { size: 10.5, colour: FAINT, ..Default::default() };
    for tick in &place.x.ticks {
        let x = place.x(tick.at);
        let long = if tick.text.is_empty() { 2.5 } else { 4.5 };
        svg.line([x, top + height], [x, top + height + long], FRAME, 1.0);
        svg.text([x, top + height + 16.0], TextStyle { anchor: "middle", ..small }, &tick.text);
    }
    for tick in &place.y.ticks {
        let y = place.y(tick.at);
        let long = if tick.text.is_empty() { 2.5 } else { 4.5 };
        svg.line([left - long, y], [left, y], FRAME, 1.0);
        svg.text([left - 7.0, y + 3.6], TextStyle { anchor: "end", ..small }, &tick.text);
    }
    let axis = TextStyle { anchor: "middle", size: 11.0, colour: INK, ..Default::default() };
    svg.text([left + width / 2.0, top + height + 31.0], axis, &place.x.caption);
    let at = [left - 54.0, top + height / 2.0];
    svg.text(at, TextStyle { upwards: true, ..axis }, &place.y.caption);
}

/// Title on the left, legend on the right.
fn draw_head(svg: &mut Svg, panel: &Panel, [left, top, width, _]: [f64; 4]) {
    let style = TextStyle { size: 12.5, colour: INK, bold: true, ..Default::default() };
    svg.text([left, top - 8.0], style, &panel.title);
    let mut x = left + width;
    for layer in panel.layers.iter().rev() {
        let (label, colour, dot) = match layer {
            Layer::Line { label, colour, fill, .. } => {
                (label, if colour.is_empty() { fill.as_deref().unwrap_or("") } else { colour }, false)
            }
            Layer::Stems { label, colour, .. } | Layer::Rules { label, colour, .. } => {
                (label, colour.as_str(), false)
            }
            Layer::Dots { label, colour, .. } => (label, colour.as_str(), true),
            Layer::Picture(_) => continue,
        };
        if label.is_empty() {
            continue;
        }
        let words = TextStyle { anchor: "end", size: 11.0, colour: INK, ..Default::default() };
        svg.text([x, top - 8.0], words, label);
        x -= label.chars().count() as f64 * 11.0 * LETTER + 7.0;
        if dot {
            svg.circle([x - 5.0, top - 12.0], 4.0, colour);
        } else {
            svg.rect([x - 14.0, top - 13.5, 14.0, 3.5], colour, "");
        }
        x -= 30.0;
    }
}

fn draw_bar(svg: &mut Svg, picture: &Picture, [left, top, width, height]: [f64; 4]) {
    let Some(bar) = &picture.bar else { return };
    let x = left + width + 10.0;
    let steps: Vec<u8> = (0..64).rev().flat_map(|row| picture.scale.at(row as f32 / 63.0)).collect();
    svg.png([x, top, 9.0, height], &png_rgb(1, 64, &steps), true);
    svg.rect([x, top, 9.0, height], "", FRAME);
    let small = TextStyle { size: 10.0, colour: FAINT, ..Default::default() };
    let ruler = Ruler::new(
        &Axis::new("", "dB").range(bar.range[0], bar.range[1]),
        0.0,
        0.0,
        ((height / 34.0) as usize).max(2),
    );
    for tick in &ruler.ticks {
        let y = top + (1.0 - ruler.place(tick.at)) * height;
        svg.text([x + 13.0, y + 3.5], small, &tick.text);
    }
    svg.text([x - 2.0, top - 8.0], small, &bar.unit);
}

fn draw_layer(svg: &mut Svg, layer: &Layer, place: &Place) {
    match layer {
        Layer::Line { colour, width_px, fill, dashed, data, .. } => {
            for line in polylines(data, |x| place.x(x), |y| place.y(y), place.columns()) {
                if let Some(fill) = fill {
                    svg.area(&line, place.bottom(), fill);
                }
                if !colour.is_empty() {
                    svg.polyline(&line, colour, *width_px, *dashed);
                }
            }
        }
        Layer::Stems { colour, points, .. } => {
            let stems: Vec<(f64, f64, f64)> = tallest(points, |x| place.x(x), place.columns())
                .into_iter()
                .map(|[x, value]| (x, place.bottom(), place.y(value)))
                .collect();
            // Dense stems become a field whose upper edge is what counts.
            let (width, opacity) = if stems.len() > 600 {
                (0.6, 0.6)
            } else if stems.len() > 200 {
                (0.8, 0.85)
            } else {
                (1.6, 0.9)
            };
            svg.verticals(&stems, colour, width, opacity);
        }
        Layer::Rules { colour, x, .. } => {
            let points: Vec<[f64; 2]> = x.iter().map(|&x| [x, 1.0]).collect();
            let rules: Vec<(f64, f64, f64)> = tallest(&points, |x| place.x(x), place.columns())
                .into_iter()
                .map(|[x, _]| (x, place.bottom(), place.plot[1]))
                .collect();
            svg.verticals(&rules, colour, 1.0, if rules.len() > 60 { 0.2 } else { 0.55 });
        }
        Layer::Dots { colour, points, radius_px, names, .. } => {
            let only = radius_px.first().copied().unwrap_or(4.0);
            for (index, point) in points.iter().enumerate() {
                let at = [place.x(point[0]), place.y(point[1])];
                if at.iter().all(|value| value.is_finite()) {
                    svg.circle(at, radius_px.get(index).copied().unwrap_or(only), colour);
                }
            }
            draw_names(svg, points, names, place);
        }
        Layer::Picture(picture) => draw_picture(svg, picture, place),
    }
}

/// Names beside dots, each at the first of eight places where it covers neither a dot nor a name.
fn draw_names(svg: &mut Svg, points: &[[f64; 2]], names: &[String], place: &Place) {
    const SIZE: f64 = 10.5;
    let dots: Vec<[f64; 2]> = points.iter().map(|point| [place.x(point[0]), place.y(point[1])]).collect();
    let mut taken: Vec<[f64; 4]> = dots.iter().map(|[x, y]| [x - 4.0, y - 4.0, 8.0, 8.0]).collect();
    for ([x, y], name) in dots.iter().zip(names) {
        if name.is_empty() || !(x.is_finite() && y.is_finite()) {
            continue;
        }
        let width = name.chars().count() as f64 * SIZE * LETTER;
        let candidates: Vec<[f64; 4]> = [3.5, -9.0, 16.0, -21.0, 28.0, -33.0]
            .iter()
            .flat_map(|down| {
                [x + 7.0, x - 7.0 - width].map(|left| [left, y + down - SIZE + 1.0, width, SIZE + 1.0])
            })
            .collect();
        let cost = |[left, top, width, height]: &[f64; 4]| {
            let [panel_x, panel_y, panel_w, panel_h] = place.plot;
            let outside = *left < panel_x
                || left + width > panel_x + panel_w
                || *top < panel_y
                || top + height > panel_y + panel_h;
            let hits = taken
                .iter()
                .filter(|[l, t, w, h]| {
                    left < &(l + w) && &(left + width) > l && top < &(t + h) && &(top + height) > t
                })
                .count();
            hits + if outside { 10 } else { 0 }
        };
        let best = candidates.iter().min_by_key(|candidate| cost(candidate)).copied();
        if let Some(best) = best {
            let style = TextStyle { size: SIZE, colour: INK, halo: true, ..Default::default() };
            svg.text([best[0], best[1] + SIZE - 1.0], style, name);
            taken.push(best);
        }
    }
}

fn draw_picture(svg: &mut Svg, picture: &Picture, place: &Place) {
    let colours: Vec<u8> = picture.values.iter().flat_map(|&value| picture.scale.at(value)).collect();
    let (left, right) = (place.x(picture.x[0]), place.x(picture.x[1]));
    let (bottom, top) = (place.y(picture.y[0]), place.y(picture.y[1]));
    let rect = [left.min(right), top.min(bottom), (right - left).abs(), (bottom - top).abs()];
    svg.png(rect, &png_rgb(picture.width, picture.height, &colours), true);
}
