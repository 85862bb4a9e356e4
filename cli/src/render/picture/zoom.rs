//! The busiest instant, enlarged.

use super::ground::ground_panel;
use super::outputs::levels_panel;
use super::{Take, drawn};
use asperity_plot::{Axis, Layer, Panel, Series, palette};

/// Length of the enlarged instant, s.
const ZOOM_S: f64 = 0.03;
/// A curve that moves by less within it is flat, m.
const FLAT_M: f64 = 1e-8;

/// The window with the most collisions, or else the most momentum, on the contact it belongs to.
fn busiest(take: &Take<'_>) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    // Only what is drawn was kept in full.
    for (index, contact) in take.contacts.iter().enumerate().filter(|(_, c)| !c.height_m.is_empty()) {
        let collides = !contact.collisions.is_empty();
        let events = if collides { &contact.collisions } else { &contact.impulses };
        let strength = |at: usize| if collides { 1.0 } else { events[at][1].abs() };
        let (mut first, mut sum) = (0, 0.0);
        for last in 0..events.len() {
            sum += strength(last);
            while events[last][0] - events[first][0] > ZOOM_S {
                sum -= strength(first);
                first += 1;
            }
            // The landing itself is an event of its own kind; the stroke is what is to be seen.
            let settled = events[first][0] > contact.start_s + 0.08;
            if settled && best.is_none_or(|(most, _, _)| sum > most) {
                best = Some((sum, index, (events[first][0] + events[last][0]) / 2.0));
            }
        }
    }
    best.map(|(_, index, middle)| (index, middle)).or_else(|| {
        let index = take.contacts.iter().position(|contact| !contact.height_m.is_empty())?;
        let contact = &take.contacts[index];
        Some((index, contact.start_s + contact.height_m.len() as f64 / take.sample_rate_hz / 2.0))
    })
}

pub(super) fn zoom_panels(take: &Take<'_>) -> Vec<Panel> {
    let Some((index, middle)) = busiest(take) else { return Vec::new() };
    let contact = &take.contacts[index];
    let rate_hz = take.sample_rate_hz;
    let end_s = contact.start_s + contact.height_m.len() as f64 / rate_hz;
    let from_s = (middle - ZOOM_S / 2.0).min(end_s - ZOOM_S).max(contact.start_s);
    let first = ((from_s - contact.start_s) * rate_hz) as usize;
    let last = (first + (ZOOM_S * rate_hz) as usize).min(contact.height_m.len());
    let part = |values: &[f64]| {
        let cut = values.get(first..last).unwrap_or(&[]);
        Series::signal(cut.iter().copied(), rate_hz, contact.start_s + first as f64 / rate_hz)
    };
    let inside = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().filter(|[t, _]| (from_s..from_s + ZOOM_S).contains(t)).copied().collect()
    };
    let collisions = inside(&contact.collisions);
    let label = if collisions.is_empty() { "" } else { "collision" };
    let axis = Axis::new("time", "s").range(from_s, from_s + ZOOM_S);
    let (of, colour) = match take.contacts.len() {
        1 => ("it", palette::PAD),
        _ => (&*contact.label, drawn(take).nth(index).map_or(palette::PAD, |(_, colour)| colour)),
    };
    let title = format!("{:.0} ms of {of}, enlarged", ZOOM_S * 1e3);
    let zoom = Panel::new(title, axis, Axis::new("height", "m"))
        .weight(2.0)
        .with(Layer::ground("surface", part(&contact.height_m)))
        .with(Layer::Line {
            label: "pad".to_owned(),
            colour: colour.to_owned(),
            width_px: 1.8,
            fill: None,
            dashed: false,
            data: part(&contact.pad_m),
        })
        .with(Layer::Dots {
            label: label.to_owned(),
            colour: palette::IMPACT.to_owned(),
            points: collisions,
            radius_px: vec![3.5],
            names: Vec::new(),
        });
    // On flat ground there is nothing to enlarge.
    let swing_m = [&contact.height_m, &contact.pad_m].map(|curve| {
        let cut = curve.get(first..last).unwrap_or(&[]);
        cut.iter().copied().fold(f64::MIN, f64::max) - cut.iter().copied().fold(f64::MAX, f64::min)
    });
    let moves = swing_m.iter().any(|swing_m| *swing_m > FLAT_M);
    let mut panels: Vec<Panel> = moves.then_some(zoom).into_iter().chain([levels_panel(take)]).collect();
    // Several surfaces have rows of their own.
    if let [ground] = &take.grounds[..] {
        panels.push(ground_panel(take, ground));
    }
    panels
}
