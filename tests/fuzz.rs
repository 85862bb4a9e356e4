//! Seeded mutations of valid files, for a few seconds: whatever is in a file, reading it gives a
//! result or a message. The same targets run under libFuzzer (`fuzz/`); what they found stays here
//! as a case.

use crate::mutation;
use crate::targets;

use asperity_dsp::rng::Rng;
use asperity_surface::image_io;
use asperity_surface::raster::Raster;
use mutation::drive;

#[test]
fn any_contact_log_is_read_or_refused() {
    let log = r#"{"t":0.0,"event":"begin","contact":1,"surface":"tiles","actuator":0,"uv":[0.1,0.5],"velocity_m_s":[0.08,0.0],"normal_force_n":0.6,"closing_m_s":0.05}
{"t":0.0167,"event":"move","contact":1,"uv":[0.11,0.5],"velocity_m_s":[0.08,0.0],"normal_force_n":0.62}
{"t":0.02,"event":"impact","body":"tile","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"steel","position":1}
{"t":0.03,"event":"impact","body":"tile","other":"tile","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":{"young_pa":1e9,"poisson":0.3,"density_kg_m3":1000.0},"restitution":0.4}
{"t":0.04,"event":"end","contact":1}
"#;
    let runs = drive(&[log.as_bytes().to_vec()], targets::log);
    assert!(runs > 50, "{runs}");
}

#[test]
fn any_modes_file_is_read_or_refused() {
    let modes = r#"{"format":"asperity.modes","version":1,"source":"tile.wav","impulse_n_s":0.01,"modes":[{"frequency_hz":812.4,"decay_per_s":14.2,"amplitude":0.31,"phase_rad":0.0},{"frequency_hz":21000.0,"decay_per_s":0.0,"amplitude":-2.0}],"positions":[[0.1,-0.4]]}"#;
    let runs = drive(&[modes.as_bytes().to_vec()], targets::modes);
    assert!(runs > 50, "{runs}");
}

#[test]
fn any_picture_is_read_or_refused() {
    let path = std::env::temp_dir().join(format!("asperity-fuzz-seed-{}.png", std::process::id()));
    let mut rng = Rng::new(4);
    let seeds: Vec<Vec<u8>> = [(1, 1), (16, 9), (64, 3)]
        .into_iter()
        .map(|(width, height)| {
            let values = (0..width * height).map(|_| rng.uniform()).collect();
            image_io::save_gray16(&path, &Raster { width, height, values }).unwrap();
            std::fs::read(&path).unwrap()
        })
        .collect();
    let _ = std::fs::remove_file(&path);
    let runs = drive(&seeds, targets::image);
    assert!(runs > 50, "{runs}");
}
