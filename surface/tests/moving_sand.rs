//! The moving picture of sand: what is shown are the simulation's own heights, only where they
//! change, for next to nothing.

use asperity_surface::moving_picture::PictureReader;
use asperity_surface::sand::simulation::Pose;
use asperity_surface::sand::{SandDesign, SandSimulation};
use std::time::Instant;

const SIDE: usize = 512;

fn bed() -> SandSimulation {
    SandSimulation::new(&SandDesign::default()).unwrap()
}

/// A finger that writes loops at about 0.3 m/s for `frame` / 60 s.
fn write(sand: &mut SandSimulation, frame: u32) {
    let t = f64::from(frame) / 60.0;
    let position_m = [0.125 + 0.07 * (3.1 * t).sin(), 0.125 + 0.06 * (4.3 * t).cos()];
    let velocity_m_s = [0.217 * (3.1 * t).cos(), -0.258 * (4.3 * t).sin()];
    sand.set_pose(Pose { contact: 0, position_m, velocity_m_s, normal_force_n: 3.0, landed: false });
    sand.frame();
}

/// What a game draws.
fn draw(reader: &mut PictureReader, drawn: &mut [f32]) -> usize {
    reader.changed(|tile| {
        for (y, row) in tile.height_m.chunks(tile.size[0]).enumerate() {
            drawn[(tile.at[1] + y) * SIDE + tile.at[0]..][..tile.size[0]].copy_from_slice(row);
        }
    })
}

fn is_drawn(sand: &SandSimulation, drawn: &[f32]) -> bool {
    drawn.iter().enumerate().all(|(i, height_m)| *height_m == sand.grid().height_m(i % SIDE, i / SIDE) as f32)
}

#[test]
fn a_game_drawing_only_changed_tiles_shows_the_sand_as_it_is() {
    let mut sand = bed();
    let mut reader = sand.moving_picture().reader();
    let mut drawn = vec![0.0; SIDE * SIDE];
    let (mut most, mut tiles) = (0, 0);
    for frame in 0..300 {
        write(&mut sand, frame);
        let shown = draw(&mut reader, &mut drawn);
        if frame == 0 {
            assert_eq!(shown, 256);
        } else {
            (most, tiles) = (most.max(shown), tiles + shown);
        }
        assert!(is_drawn(&sand, &drawn), "frame {frame}");
    }
    println!("{:.1} of 256 tiles a frame, at most {most}", f64::from(tiles as u32) / 299.0);
    assert!(most < 40 && reader.missed() == 0);
    // The finger has left: what slides is shown, and then nothing is.
    let mut quiet = 0;
    for _ in 0..600 {
        sand.frame();
        let shown = draw(&mut reader, &mut drawn);
        quiet = if shown == 0 { quiet + 1 } else { 0 };
        assert!(is_drawn(&sand, &drawn));
    }
    assert!(sand.is_at_rest() && quiet > 60, "{quiet} frames without a change");
    // Other sand, drawn anew.
    sand.shape(|x, y| 0.02 + 1e-5 * ((x * 31 + y * 17) % 97) as f64);
    sand.frame();
    assert_eq!(draw(&mut reader, &mut drawn), 256);
    assert!(is_drawn(&sand, &drawn));
}

#[test]
fn two_games_draw_the_same_sand_at_their_own_pace() {
    let mut sand = bed();
    let (mut quick, mut slow) = (sand.moving_picture().reader(), sand.moving_picture().reader());
    let mut drawn = [vec![0.0; SIDE * SIDE], vec![0.0; SIDE * SIDE]];
    for frame in 0..120 {
        write(&mut sand, frame);
        draw(&mut quick, &mut drawn[0]);
        if frame % 7 == 6 || frame == 119 {
            draw(&mut slow, &mut drawn[1]);
            assert!(drawn[0] == drawn[1]);
        }
    }
    assert!(quick.missed() == 0 && slow.missed() > 0);
}

/// Frames with and without a game that draws, in turn, on the same sand.
#[test]
fn drawing_moving_sand_costs_at_most_2_percent_of_a_frame() {
    let (mut shown, mut hidden) = (bed(), bed());
    let mut reader = shown.moving_picture().reader();
    let mut drawn = vec![0.0; SIDE * SIDE];
    let mut costs = Vec::new();
    for frame in 0..600 {
        let begun = Instant::now();
        write(&mut hidden, frame);
        let alone_s = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        write(&mut shown, frame);
        draw(&mut reader, &mut drawn);
        costs.push((begun.elapsed().as_secs_f64() - alone_s, alone_s));
    }
    let middle = |of: fn(&(f64, f64)) -> f64| {
        let mut all: Vec<f64> = costs.iter().skip(10).map(of).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let (drawing_s, alone_s) = (middle(|cost| cost.0), middle(|cost| cost.1));
    println!(
        "drawing {:.1} us a frame, {:.2} % of 1/60 s; the frame itself {:.1} us",
        1e6 * drawing_s,
        6e3 * drawing_s,
        1e6 * alone_s
    );
    assert!(60.0 * drawing_s < 0.02, "{drawing_s} s");
}
