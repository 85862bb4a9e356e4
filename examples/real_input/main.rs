//! Real input: recorded pen strokes and tosses over published height maps, with published modes.
//!
//! ```text
//! cargo run --release --example real_input -- CORPUS FOLDER
//! for scene in FOLDER/*.toml; do asperity render $scene -o ${scene%.toml} --plot; done
//! ```
//! `CORPUS` holds `haptics/`, `textures/` and `modal/`. Scenes name its maps by path; nothing is
//! copied.

mod modal_tables;
mod profile;
mod scenes;
mod trajectories;

use asperity::files::contact_log::ContactLog;
use std::error::Error;
use std::fs;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [corpus, folder] = &arguments[..] else {
        return Err("usage: real_input CORPUS FOLDER".into());
    };
    let (corpus, folder) = (fs::canonicalize(corpus)?, Path::new(folder));
    fs::create_dir_all(folder)?;
    let bodies = write_modes(&corpus, folder)?;
    println!("{bodies} modes files");
    let read = |name: &str| fs::read_to_string(corpus.join("haptics").join(name));
    let pens = [
        ("handwriting", trajectories::handwriting(&read("stylus_handwriting_signal.svc")?)?, true),
        ("painting", trajectories::painting(&read("stylus_painting30sec_first_half.dat")?)?, false),
    ];
    let wood = profile::read_npy(&fs::read(corpus.join("textures/profile_bass_wood.npy"))?)?;
    let (raster, wood_relief_m) = profile::raster(&wood);
    asperity_surface::image_io::save_gray16(folder.join("bass_wood.png"), &raster)?;
    for ground in scenes::grounds(wood_relief_m) {
        for (pen, samples, velocity) in &pens {
            let stem = format!("{}_{pen}", ground.name);
            let log = trajectories::strokes(samples, "ground", ground.size_m, *velocity);
            write_log(&log, &folder.join(format!("{stem}.jsonl")))?;
            fs::write(folder.join(format!("{stem}.toml")), ground.scene(&corpus, &stem))?;
            println!("{stem}: {} events", log.lines.len());
        }
    }
    let tosses = trajectories::tosses(&read("cube_tosses_148hz.csv")?, "table")?;
    write_log(&tosses, &folder.join("tosses.jsonl"))?;
    fs::write(folder.join("tosses.toml"), scenes::TOSSES)?;
    println!("tosses: {} impacts", tosses.lines.len());
    Ok(())
}

fn write_log(log: &ContactLog, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut text = String::new();
    for line in &log.lines {
        text += &serde_json::to_string(line)?;
        text.push('\n');
    }
    Ok(fs::write(path, text)?)
}

fn write_modes(corpus: &Path, folder: &Path) -> Result<usize, Box<dyn Error>> {
    let read = |name: &str| fs::read_to_string(corpus.join("modal").join(name));
    let mut models = Vec::new();
    for name in ["tdw_ceramic_0_mm", "tdw_wood_medium_0_mm", "tdw_stone_1_mm"] {
        models.push(modal_tables::fitted(name, &read(&format!("{name}.json"))?)?);
    }
    for name in ["faust_bells_bars", "faust_measured_bodies", "stk_modalbar", "csound_modal_ratios"] {
        for (body, model) in modal_tables::bodies(&read(&format!("{name}.json"))?)? {
            let body: String = body.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
            models.push((format!("{}_{body}", name.split('_').next().unwrap_or(name)), model));
        }
    }
    for (name, model) in &models {
        fs::write(folder.join(format!("{name}.modes.json")), model.to_json())?;
    }
    Ok(models.len())
}
