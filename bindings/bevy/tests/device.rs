//! The sound card's output, on a device that ALSA only pretends to have:
//! `ALSA_CONFIG_PATH=tests/nobody.conf`.

mod common;

use bevy::prelude::*;
use bevy_asperity::*;
use common::*;
use std::time::Duration;

#[test]
fn a_stroke_is_rendered_by_the_sound_cards_own_thread() {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins).add_plugins(AsperityPlugin::to(Output::Device(Default::default())));
    let plate = plate(&mut app);
    let finger = app.world_mut().spawn(TouchProbe::felt_by(0)).id();
    for frame in 0..30 {
        let sample = sliding(f64::from(frame) * 0.02);
        let event = match frame {
            0 => TouchEvent::Begin { toucher: finger, surface: plate, sample },
            _ => TouchEvent::Move { toucher: finger, sample },
        };
        app.world_mut().write_message(event);
        app.update();
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(errors(&mut app), [""; 0]);
    let stats = touch(&mut app).stats();
    assert!(stats.position > 4800, "the device's thread has rendered {} samples", stats.position);
    assert_eq!(stats.refused, 0);
    println!("{} samples, load {:.2}", stats.position, stats.load);
    drop(app);
}

/// A process of its own, because a machine's sound cards are read from its environment.
#[cfg(target_os = "linux")]
#[test]
fn an_app_without_a_sound_card_is_told_that_nothing_plays() {
    if std::env::var_os("NO_CARDS").is_none() {
        let own = std::env::current_exe().unwrap();
        let name = "an_app_without_a_sound_card_is_told_that_nothing_plays";
        let without = std::process::Command::new(own)
            .args(["--exact", name, "--nocapture"])
            .env("NO_CARDS", "1")
            .env("ALSA_CONFIG_PATH", "/dev/null")
            .output()
            .unwrap();
        return assert!(without.status.success(), "{}", String::from_utf8_lossy(&without.stderr));
    }
    let mut app = App::new();
    app.add_plugins(MinimalPlugins).add_plugins(AsperityPlugin::to(Output::Device(Default::default())));
    app.update();
    let told = errors(&mut app);
    assert!(told.len() == 1 && told[0].starts_with("asperity plays nothing: "), "{told:?}");
}
