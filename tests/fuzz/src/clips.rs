//! Doors of haptic files: clips, waveforms, devices.

use crate::Door;
use crate::engine::one_line;
use asperity_ports::{Device, ahap, haptic_file, hjif};

pub const DOORS: &[Door] = &[("haptic", haptic), ("ahap", clip_of_ahap), ("hjif", waves), ("device", device)];

fn haptic(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match haptic_file::parse(text) {
        Ok(read) => {
            let written = haptic_file::write(&read.clip).expect("a clip that was read is written");
            haptic_file::parse(&written).expect("a clip survives its file");
            assert!(read.clip.sampled(1000.0).take(10_000).all(|(a, f)| a.is_finite() && f.is_finite()));
        }
        Err(refused) => one_line(&refused),
    }
}

fn clip_of_ahap(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match ahap::parse(text) {
        Ok(read) => {
            assert!(read.clip.sampled(1000.0).take(10_000).all(|(a, f)| a.is_finite() && f.is_finite()));
            let files = ahap::write(&read.clip, None).expect("a clip that was read is written");
            ahap::parse(&files.main).expect("a clip survives its file");
        }
        Err(refused) => one_line(&refused),
    }
}

fn waves(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match hjif::rendered(text, 0) {
        Ok(samples) => assert!(samples.iter().all(|x| x.is_finite())),
        Err(refused) => one_line(&refused),
    }
}

/// A profile in TOML, or an actuator configuration.
fn device(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match Device::parse(text) {
        Ok(device) => assert!((0..=10).all(|f| device.hz(f64::from(f) / 10.0).is_finite())),
        Err(refused) => one_line(&refused),
    }
}
