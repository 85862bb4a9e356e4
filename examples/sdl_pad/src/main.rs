//! A pad's two motors through SDL3: a hum that rises, for three seconds, on the first pad there is.
//! The test feels it on a pad that SDL pretends to have.
//!
//! `cargo run --manifest-path examples/sdl_pad/Cargo.toml`

use asperity::live::ports::{Feed, Levels};
use asperity::{ChannelId, Clip, Config, Engine};
use sdl3_sys::gamepad::{SDL_Gamepad, SDL_GetGamepads, SDL_OpenGamepad, SDL_RumbleGamepad};
use sdl3_sys::init::{SDL_INIT_GAMEPAD, SDL_Init};
use std::f32::consts::TAU;

/// Levels a second, and samples of a level.
const RATE_HZ: f64 = 60.0;
const BLOCK: usize = 800;

/// Plays the hum; what each call said, heavy and light. The thread is the one that started SDL.
fn play(pad: *mut SDL_Gamepad, wait: impl Fn()) -> Result<Vec<[u16; 2]>, Box<dyn std::error::Error>> {
    let Engine { mut scene, mut renderer, .. } =
        Config { sample_rate_hz: RATE_HZ * BLOCK as f64, ..Config::default() }.build()?;
    let hum = |n: u16| {
        let t = f32::from(n) / 8000.0;
        0.5 * (TAU * (40.0 + 30.0 * t) * t).sin()
    };
    scene.play_clip(0.0, ChannelId(0), &Clip::new((0..24_000).map(hum).collect(), 8000.0))?;
    let from = Feed::Haptic(ChannelId(0));
    let mut port = scene.open_port(Levels { from, rate_hz: RATE_HZ, holds_s: 0.25 })?;
    let mut said = Vec::new();
    for _ in 0..180 {
        renderer.render(&mut [&mut [0.0; BLOCK]], &mut [&mut [0.0; BLOCK]]);
        let [heavy, light] = port.newest().map(|level| (level.clamp(0.0, 1.0) * 65_535.0).round() as u16);
        // SAFETY: the pad was opened and is not closed before this returns.
        // 50 ms: what stalls stops by itself.
        if !unsafe { SDL_RumbleGamepad(pad, heavy, light, 50) } {
            return Err("the pad does not rumble, or is gone".into());
        }
        said.push([heavy, light]);
        wait();
    }
    Ok(said)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut count = 0;
    // SAFETY: SDL is started first; the list holds as many names as it says.
    let pad = unsafe {
        if !SDL_Init(SDL_INIT_GAMEPAD) {
            return Err("SDL does not start".into());
        }
        let pads = SDL_GetGamepads(&mut count);
        if pads.is_null() || count == 0 {
            return Err("no pad is there".into());
        }
        SDL_OpenGamepad(*pads)
    };
    play(pad, || std::thread::sleep(std::time::Duration::from_secs_f64(1.0 / RATE_HZ)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sdl3_sys::joystick::{
        SDL_AttachVirtualJoystick, SDL_DetachVirtualJoystick, SDL_JOYSTICK_TYPE_GAMEPAD,
        SDL_VirtualJoystickDesc,
    };
    use std::sync::Mutex;

    static FELT: Mutex<Vec<[u16; 2]>> = Mutex::new(Vec::new());

    unsafe extern "C" fn felt(_: *mut std::ffi::c_void, heavy: u16, light: u16) -> bool {
        FELT.lock().unwrap().push([heavy, light]);
        true
    }

    #[test]
    fn a_pad_turns_as_the_port_says_and_unplugging_is_reported() {
        // SAFETY: SDL is started first, and the description outlives the call that reads it.
        let (id, pad) = unsafe {
            assert!(SDL_Init(SDL_INIT_GAMEPAD));
            let mut pad = SDL_VirtualJoystickDesc::default();
            pad.r#type = SDL_JOYSTICK_TYPE_GAMEPAD.0 as u16;
            (pad.naxes, pad.nbuttons) = (6, 15);
            pad.Rumble = Some(felt);
            let id = SDL_AttachVirtualJoystick(&pad);
            (id, SDL_OpenGamepad(id))
        };
        let mut said = play(pad, || ()).unwrap();
        let heard = FELT.lock().unwrap().clone();
        // SDL does not tell a pad again what it does already, nor to be still at first.
        said.insert(0, [0; 2]);
        said.dedup();
        said.remove(0);
        assert_eq!(heard, said);
        assert!(
            said[20][0] > 3 * said[20][1] && said[said.len() - 10][1] > 3 * said[said.len() - 10][0],
            "{said:?}"
        );
        // SAFETY: the pad was attached above.
        assert!(unsafe { SDL_DetachVirtualJoystick(id) });
        assert!(play(pad, || ()).is_err());
    }
}
