//! A minute of randomised events, swaps and removals, rendered inside a function that the real-time
//! sanitizer watches: any allocation, lock or blocking system call in it ends the program with a
//! trace.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../common/random_game.rs"]
mod random_game;

use asperity::Renderer;
use random_game::RandomGame;
use rtsan_standalone::nonblocking;

#[nonblocking]
fn watched(renderer: &mut Renderer, haptic: &mut [f32], audio: &mut [f32]) {
    renderer.render(&mut [haptic], &mut [audio]);
}

#[nonblocking]
fn broken() -> usize {
    std::hint::black_box(vec![0u8; 1000]).len()
}

fn main() {
    rtsan_standalone::ensure_initialized();
    if std::env::args().any(|argument| argument == "--broken") {
        println!("{} bytes allocated unnoticed: the sanitizer is off", broken());
        return;
    }
    let (mut game, mut renderer) = RandomGame::new(11);
    let (mut haptic, mut audio) = ([0.0f32; 256], [0.0f32; 256]);
    while game.time_s < 60.0 {
        game.step();
        while (renderer.position() as f64) < game.time_s * renderer.sample_rate_hz() {
            watched(&mut renderer, &mut haptic, &mut audio);
        }
        game.scene.collect();
    }
    println!("no blocking call: {:?}", game.scene.stats());
}
