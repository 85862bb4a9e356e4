//! Blocks: what the audio thread calls. Nothing here fails or makes a sentence; where no scene is
//! open it is silent.

use crate::session::{self, Session};
use asperity::{ContactBlock, Tap};
use std::cell::RefCell;

/// Most frames of a call; browsers ask for 128.
pub const MOST_FRAMES: usize = 1024;
/// Most audio buses, and most haptic channels, that leave the instance.
pub const MOST_CHANNELS: usize = 16;
/// Numbers that a block shows of its contacts.
pub const SCOPE_NUMBERS: usize = 16;

/// State of the first contact of a block, as numbers in this order: how many contacts touch;
/// lowest and highest ground under the finger, m; lowest and highest skin, m; place along u and v,
/// m; velocity along u and v, m/s; force that presses, N; momentum sent to the body, N·s; its name.
#[derive(Clone, Copy)]
struct Scope([f32; SCOPE_NUMBERS]);

struct Channels {
    audio: [Vec<f32>; MOST_CHANNELS],
    haptic: [Vec<f32>; MOST_CHANNELS],
    scope: Scope,
}

thread_local! {
    static CHANNELS: RefCell<Channels> = const { RefCell::new(Channels {
        audio: [const { Vec::new() }; MOST_CHANNELS],
        haptic: [const { Vec::new() }; MOST_CHANNELS],
        scope: Scope([0.0; SCOPE_NUMBERS]),
    }) };
}

impl Scope {
    const EMPTY: Self = {
        let mut numbers = [0.0; SCOPE_NUMBERS];
        (numbers[1], numbers[2]) = (f32::INFINITY, f32::NEG_INFINITY);
        (numbers[3], numbers[4]) = (f32::INFINITY, f32::NEG_INFINITY);
        Self(numbers)
    };
}

impl Tap for Scope {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        let Self(numbers) = self;
        let name = block.contact.0 as f32;
        if numbers[0] == 0.0 {
            numbers[11] = name;
        }
        if name != numbers[11] {
            numbers[0] = 2.0;
            return;
        }
        numbers[0] = numbers[0].max(1.0);
        for sample in block.contact_samples {
            let (ground_m, skin_m) = (sample.height_m as f32, sample.pad_m as f32);
            (numbers[1], numbers[2]) = (numbers[1].min(ground_m), numbers[2].max(ground_m));
            (numbers[3], numbers[4]) = (numbers[3].min(skin_m), numbers[4].max(skin_m));
            numbers[9] = sample.normal_force_n as f32;
        }
        if let (Some([u_m, v_m]), Some([u_m_s, v_m_s])) = (block.position_m.last(), block.velocity_m_s.last())
        {
            (numbers[5], numbers[6]) = (*u_m as f32, *v_m as f32);
            (numbers[7], numbers[8]) = (*u_m_s as f32, *v_m_s as f32);
        }
        numbers[10] += block.impulse_n_s.iter().sum::<f64>() as f32;
    }
}

impl Channels {
    fn render(&mut self, session: &mut Session, frames: usize) {
        let renderer = &mut session.renderer;
        let counts = [renderer.audio_buses(), renderer.haptic_channels()].map(|n| n.min(MOST_CHANNELS));
        for (signals, count) in [&mut self.audio, &mut self.haptic].into_iter().zip(counts) {
            signals[..count].iter_mut().for_each(|signal| signal.resize(MOST_FRAMES, 0.0));
        }
        let mut audio = self.audio.each_mut().map(|signal| &mut signal[..]);
        let mut haptic = self.haptic.each_mut().map(|signal| &mut signal[..]);
        let audio = &mut audio[..counts[0]];
        let haptic = &mut haptic[..counts[1]];
        for signal in audio.iter_mut().chain(haptic.iter_mut()) {
            let whole = std::mem::take(signal);
            *signal = &mut whole[..frames];
        }
        self.scope = Scope::EMPTY;
        renderer.render_tapped(haptic, audio, &mut self.scope);
    }
}

/// Renders the next `frames`, at most 1024, and tells how many it rendered.
#[unsafe(no_mangle)]
pub extern "C" fn asp_render(frames: usize) -> usize {
    let frames = frames.min(MOST_FRAMES);
    let mut rendered = 0;
    session::if_open(|session| {
        CHANNELS.with_borrow_mut(|channels| channels.render(session, frames));
        rendered = frames;
    });
    rendered
}

/// Address of bus `index` of the last block; null where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn asp_audio(index: usize) -> *const f32 {
    CHANNELS.with_borrow(|channels| start(channels.audio.get(index)))
}

/// Address of haptic channel `index` of the last block; null where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn asp_haptic(index: usize) -> *const f32 {
    CHANNELS.with_borrow(|channels| start(channels.haptic.get(index)))
}

fn start(signal: Option<&Vec<f32>>) -> *const f32 {
    signal.filter(|signal| !signal.is_empty()).map_or(std::ptr::null(), |signal| signal.as_ptr())
}

/// Address of the numbers of the last block, 16 of them: contacts that touch (0, 1, 2 = several),
/// then of the first one the lowest and highest ground, m, lowest and highest skin, m, place along
/// u and v, m, velocity along u and v, m/s, force, N, momentum sent, N·s, name.
#[unsafe(no_mangle)]
pub extern "C" fn asp_scope() -> *const f32 {
    CHANNELS.with_borrow(|channels| channels.scope.0.as_ptr())
}

/// The next sample, counted from the opening of the scene.
#[unsafe(no_mangle)]
pub extern "C" fn asp_position() -> f64 {
    let mut position = 0;
    session::if_open(|session| position = session.renderer.position());
    position as f64
}

/// Reports which share of its time the last block took; above all of it the least audible
/// work is left out.
#[unsafe(no_mangle)]
pub extern "C" fn asp_report_load(load: f32) {
    session::if_open(|session| session.renderer.report_load(load));
}
