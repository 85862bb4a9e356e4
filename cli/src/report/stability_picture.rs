//! The stability of the contact model as a picture and as a sentence.

use super::stability::{Cell, RATES_HZ, STIFFNESS_N_M};
use asperity::Integrator;
use asperity_dsp::micro_contact::CONTACT_STIFFNESS_N_M;
use asperity_plot::{Svg, TextStyle, quantity};

const CELL_PX: [f64; 2] = [62.0, 40.0];
const LEFT_PX: f64 = 96.0;
const TOP_PX: f64 = 150.0;
const BLOCK_GAP_PX: f64 = 60.0;
/// Pale, so that text reads on them; in the order of [`Integrator::ALL`].
const FILLS: [&str; 4] = ["#cfe3f7", "#e4d7f5", "#d3eddd", "#fde3c4"];
const CHAOTIC: &str = "#b71c1c";

/// Schemes that run when a scheme is asked for, a block of cells for each scheme: stiffness
/// upwards, rate to the right.
#[must_use]
pub fn svg(cells: &[Cell]) -> String {
    let mut svg = Svg::default();
    let block = [CELL_PX[0] * RATES_HZ.len() as f64, CELL_PX[1] * STIFFNESS_N_M.len() as f64];
    let width = 2.0 * (LEFT_PX + block[0]) + BLOCK_GAP_PX;
    let height = TOP_PX + 2.0 * (block[1] + 76.0);
    heading(&mut svg);
    for (index, wanted) in Integrator::ALL.into_iter().enumerate() {
        let x = LEFT_PX + (index % 2) as f64 * (block[0] + LEFT_PX + BLOCK_GAP_PX);
        let y = TOP_PX + (index / 2) as f64 * (block[1] + 76.0);
        let members = cells.iter().filter(|cell| cell.wanted == wanted.name());
        axes(&mut svg, [x, y], wanted);
        members.for_each(|cell| draw(&mut svg, [x, y], cell));
    }
    svg.finish(width, height, "Where the contact model is safe")
}

fn heading(svg: &mut Svg) {
    let plain = TextStyle { size: 12.0, ..TextStyle::default() };
    svg.text([20.0, 30.0], TextStyle { size: 18.0, bold: true, ..plain }, "Where the contact model is safe");
    let fingertip = quantity(CONTACT_STIFFNESS_N_M, "N/m");
    let key = format!(
        "Upper line: steps a sample. Lower line: energy an undamped bounce gains in a second. The fingertip is {fingertip}."
    );
    svg.text([20.0, 50.0], plain, &key);
    svg.text([20.0, 68.0], plain, "A red corner: chaotic, two rough strokes a picometre apart end more than −80 dB apart: compare levels there, not waveforms.");
    svg.text([20.0, 94.0], TextStyle { bold: true, ..plain }, "What runs:");
    let mut x = 96.0;
    for (scheme, fill) in Integrator::ALL.into_iter().zip(FILLS) {
        svg.rect([x, 82.0, 16.0, 16.0], fill, "#888888");
        svg.text([x + 22.0, 94.0], plain, scheme.name());
        x += 34.0 + 7.2 * scheme.name().len() as f64;
    }
}

fn axes(svg: &mut Svg, [x, y]: [f64; 2], wanted: Integrator) {
    let bottom = y + CELL_PX[1] * STIFFNESS_N_M.len() as f64;
    let style = TextStyle { size: 11.0, ..TextStyle::default() };
    let title = format!("asked for: {}", wanted.name());
    svg.text([x, y - 8.0], TextStyle { size: 13.0, bold: true, ..style }, &title);
    for (column, rate_hz) in RATES_HZ.into_iter().enumerate() {
        let middle = x + CELL_PX[0] * (column as f64 + 0.5);
        let label = format!("{} kHz", rate_hz / 1e3);
        svg.text([middle, bottom + 15.0], TextStyle { anchor: "middle", ..style }, &label);
    }
    let middle = |of: f64, cells: usize| 0.5 * of * cells as f64;
    let across = [x + middle(CELL_PX[0], RATES_HZ.len()), bottom + 32.0];
    svg.text(across, TextStyle { anchor: "middle", ..style }, "sample rate");
    let up = [x - 78.0, bottom - middle(CELL_PX[1], STIFFNESS_N_M.len())];
    svg.text(up, TextStyle { anchor: "middle", upwards: true, ..style }, "stiffness of the contact");
    for (row, stiffness_n_m) in STIFFNESS_N_M.into_iter().enumerate() {
        let middle = bottom - CELL_PX[1] * (row as f64 + 0.5) + 4.0;
        let bold = stiffness_n_m == CONTACT_STIFFNESS_N_M;
        let label = quantity(stiffness_n_m, "N/m");
        svg.text([x - 6.0, middle], TextStyle { anchor: "end", bold, ..style }, &label);
    }
}

fn draw(svg: &mut Svg, [x, y]: [f64; 2], cell: &Cell) {
    let column = RATES_HZ.iter().position(|rate| *rate == cell.sample_rate_hz).unwrap_or(0);
    let row = STIFFNESS_N_M.iter().rposition(|k| *k == cell.contact_stiffness_n_m).unwrap_or(0);
    let left = x + CELL_PX[0] * column as f64;
    let top = y + CELL_PX[1] * (STIFFNESS_N_M.len() - 1 - row) as f64;
    let fill = Integrator::ALL.into_iter().zip(FILLS).find(|(scheme, _)| scheme.name() == cell.used);
    svg.rect([left, top, CELL_PX[0], CELL_PX[1]], fill.map_or("#ffffff", |(_, fill)| fill), "#ffffff");
    if !cell.contractive {
        svg.rect([left + CELL_PX[0] - 9.0, top + 1.0, 8.0, 8.0], CHAOTIC, "");
    }
    let style = TextStyle { anchor: "middle", size: 10.5, ..TextStyle::default() };
    let middle = left + 0.5 * CELL_PX[0];
    let steps = if cell.substeps == 1 { "1".to_owned() } else { format!("× {}", cell.substeps) };
    svg.text([middle, top + 16.0], style, &steps);
    let gains = cell.energy_gain > 1e-3;
    let colour = if gains { CHAOTIC } else { style.colour };
    svg.text([middle, top + 31.0], TextStyle { bold: gains, colour, ..style }, &gain(cell.energy_gain));
}

/// A gain as a person reads it.
fn gain(gain: f64) -> String {
    match gain {
        g if g < 1e-9 => "none".to_owned(),
        g if g < 1e-4 => format!("{g:.0e}"),
        g if g < 1.0 => format!("+{:.2} %", 100.0 * g),
        g => format!("× {:.1}", 1.0 + g),
    }
}

/// The rate of the sentence, Hz.
const RATE_HZ: f64 = 44_100.0;

/// The fingertip under each scheme in a sentence; the picture has all cells.
#[must_use]
pub fn markdown(cells: &[Cell]) -> String {
    let here = cells
        .iter()
        .filter(|cell| cell.contact_stiffness_n_m == CONTACT_STIFFNESS_N_M && cell.sample_rate_hz == RATE_HZ);
    let each: Vec<String> = here.map(|cell| format!("`{}`: {}", cell.wanted, entry(cell))).collect();
    format!(
        "\n## stability of the contact\n\nThe fingertip ({}) at {} kHz, what runs if it is not what is asked for, sub-steps, and the energy \
         that an undamped bounce gains in a second: {}. `stability.svg` has all stiffnesses and rates.\n",
        quantity(CONTACT_STIFFNESS_N_M, "N/m"),
        RATE_HZ / 1e3,
        each.join("; ")
    )
}

fn entry(cell: &Cell) -> String {
    let mut words = Vec::new();
    if cell.used != cell.wanted {
        words.push(cell.used.to_owned());
    }
    if cell.substeps > 1 {
        words.push(format!("× {}", cell.substeps));
    }
    words.push(gain(cell.energy_gain));
    if !cell.contractive {
        words.push("*chaotic*".to_owned());
    }
    words.join(", ")
}
