//! The tables of the hollow box and the door, solved again from their meshes.

use crate::support;

use asperity::{Material, Stock};
use serde_json::Value;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use support::{asperity, message};

type Point = [f64; 3];

/// Corners and tetrahedra.
#[derive(Default)]
struct Mesh {
    corners: Vec<Point>,
    known: HashMap<[i64; 3], usize>,
    tetrahedra: Vec<[usize; 4]>,
}

impl Mesh {
    fn corner(&mut self, at: Point) -> usize {
        let key = at.map(|x| (x * 1e9).round() as i64);
        *self.known.entry(key).or_insert_with(|| {
            self.corners.push(at);
            self.corners.len() - 1
        })
    }

    /// Six tetrahedra of a cell of a grid whose corners lie where `place` says; none of those that
    /// have no volume.
    fn cell(&mut self, cell: [usize; 3], place: &dyn Fn([usize; 3]) -> Point) {
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let mut at = cell;
            let mut corners = vec![self.corner(place(at))];
            for axis in order {
                at[axis] += 1;
                corners.push(self.corner(place(at)));
            }
            let mut four: [usize; 4] = corners.try_into().unwrap();
            let [a, b, c, d] = four.map(|i| self.corners[i]);
            let from = |p: Point| [0, 1, 2].map(|k| p[k] - a[k]);
            let (u, v, w) = (from(b), from(c), from(d));
            let volume = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
                + u[2] * (v[0] * w[1] - v[1] * w[0]);
            if volume.abs() < 1e-15 {
                continue;
            }
            if volume < 0.0 {
                four.swap(2, 3);
            }
            self.tetrahedra.push(four);
        }
    }

    fn msh(&self) -> String {
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", self.corners.len());
        for (index, [x, y, z]) in self.corners.iter().enumerate() {
            let _ = writeln!(text, "{} {x} {y} {z}", index + 1);
        }
        let _ = write!(text, "$EndNodes\n$Elements\n{}\n", self.tetrahedra.len());
        for (index, [a, b, c, d]) in self.tetrahedra.iter().map(|four| four.map(|i| i + 1)).enumerate() {
            let _ = writeln!(text, "{} 4 2 1 1 {a} {b} {c} {d}", index + 1);
        }
        text + "$EndElements\n"
    }
}

/// Walls of a closed box, one cell thick.
fn hollow_box(sides: [f64; 3], wall: f64, cells: [usize; 3]) -> Mesh {
    let line = |axis: usize| -> Vec<f64> {
        let (side, count) = (sides[axis], cells[axis]);
        let inner = (0..=count).map(|i| wall + (side - 2.0 * wall) * i as f64 / count as f64);
        std::iter::once(0.0).chain(inner).chain([side]).map(|x| x - 0.5 * side).collect()
    };
    let lines = [0, 1, 2].map(line);
    let last = [0, 1, 2].map(|axis| lines[axis].len() - 2);
    let mut mesh = Mesh::default();
    for i in 0..=last[0] {
        for j in 0..=last[1] {
            for k in 0..=last[2] {
                let cell = [i, j, k];
                if (0..3).any(|axis| cell[axis] == 0 || cell[axis] == last[axis]) {
                    mesh.cell(cell, &|at| [lines[0][at[0]], lines[1][at[1]], lines[2][at[2]]]);
                }
            }
        }
    }
    mesh
}

fn slab(sides: [f64; 3], cells: [usize; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    let place = |at: [usize; 3]| [0, 1, 2].map(|k| sides[k] * (at[k] as f64 / cells[k] as f64 - 0.5));
    for i in 0..cells[0] {
        for j in 0..cells[1] {
            (0..cells[2]).for_each(|k| mesh.cell([i, j, k], &place));
        }
    }
    mesh
}

fn mesh_of(shape: Stock) -> Mesh {
    match shape {
        Stock::Box => hollow_box([1.0, 0.75, 0.5], 1.0 / 40.0, [20, 16, 10]),
        _ => slab([1.0, 0.4, 0.02], [16, 8, 1]),
    }
}

/// Undamped frequencies of a mesh, Hz.
fn solved_hz(folder: &Path, name: &str, mesh: &Mesh) -> Vec<f64> {
    fs::write(folder.join(format!("{name}.msh")), mesh.msh()).unwrap();
    let (input, output) = (format!("{name}.msh"), format!("{name}.modes.json"));
    let arguments =
        ["modes", &input, "-o", &output, "--max-modes", "16", "--young-pa", "1e9", "--poisson", "0.3"];
    let run = asperity(folder, &[&arguments[..], &["--density-kg-m3", "1000", "--json"]].concat());
    let (status, _, err) = message(&run);
    assert_eq!(status, 0, "{err}");
    let file: Value = serde_json::from_slice(&fs::read(folder.join(&output)).unwrap()).unwrap();
    let hz = |mode: &Value| {
        let [hz, decay] = ["frequency_hz", "decay_per_s"].map(|key| mode[key].as_f64().unwrap());
        hz.hypot(decay / TAU)
    };
    file["modes"].as_array().unwrap().iter().map(hz).collect()
}

#[test]
fn the_tables_of_box_and_door_are_their_meshes_solutions() {
    let folder = tempfile::tempdir().unwrap();
    // Undamped, so that a frequency is the table's.
    let material = Material { alpha_per_s: 0.0, eta: 0.0, beta_s: 0.0, ..Material::new(1e9, 0.3, 1000.0) };
    for name in ["box", "door"] {
        let shape = Stock::by_name(name).unwrap();
        let solved = solved_hz(folder.path(), name, &mesh_of(shape));
        let table = shape.modes(&material, 1.0).unwrap();
        let mut hz: Vec<f64> = table.modes.iter().map(|mode| mode.frequency_hz).collect();
        hz.sort_by(f64::total_cmp);
        for (ours, solved) in hz.iter().zip(&solved).take(8) {
            assert!((ours / solved - 1.0).abs() < 1e-3, "{name}: {ours} Hz in the table, {solved} Hz solved");
        }
    }
}
