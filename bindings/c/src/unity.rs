//! Unity mixer effect: the same library, named `audioplugin…`, plays an engine's buses into the
//! mixer group that it is put on.
//!
//! | of the native plug-in interface 1.4, 64-bit | bytes |
//! |---|---|
//! | effect state: `flags` at 40, `effectdata` at 32, `currdsptick` at 8 | 80 |
//! | effect definition: `process` at 88 | 136 |
//! | parameter definition | 64 |
//!
//! The effect finds its engine by a parameter, a small whole number that `asp_unity_slot` gives; no
//! pointer ever travels as a float. Haptic channels leave by ports.

use crate::config::CHUNK_FRAMES;
use crate::entry::{enter, out};
use crate::handles::{RENDERERS, asp_renderer};
use crate::render::guarded;
use crate::status::{ASP_BAD_HANDLE, Failure};
use std::ffi::{c_char, c_int, c_void};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

const API_VERSION: u32 = 0x0001_0402;
const OK: c_int = 0;
const UNSUPPORTED: c_int = 1;
/// The state's flags: the game runs, and neither stands nor is muted.
const IS_PLAYING: u32 = 1;
const IS_PAUSED: u32 = 2;
const IS_MUTED: u32 = 4;
/// The one parameter: which engine, 0 = none.
const ENGINE: c_int = 0;

/// State that the mixer hands to an effect.
#[repr(C)]
pub struct UnityAudioEffectState {
    structsize: u32,
    samplerate: u32,
    currdsptick: u64,
    prevdsptick: u64,
    sidechainbuffer: *mut f32,
    effectdata: *mut c_void,
    flags: u32,
    internal: *mut c_void,
    spatializerdata: *mut c_void,
    dspbuffersize: u32,
    hostapiversion: u32,
    ambisonicdata: *mut c_void,
}

type OnState = unsafe extern "C" fn(*mut UnityAudioEffectState) -> c_int;
type Process =
    unsafe extern "C" fn(*mut UnityAudioEffectState, *const f32, *mut f32, u32, c_int, c_int) -> c_int;
type SetPosition = unsafe extern "C" fn(*mut UnityAudioEffectState, u32) -> c_int;
type SetFloat = unsafe extern "C" fn(*mut UnityAudioEffectState, c_int, f32) -> c_int;
type GetFloat = unsafe extern "C" fn(*mut UnityAudioEffectState, c_int, *mut f32, *mut c_char) -> c_int;
type GetBuffer = unsafe extern "C" fn(*mut UnityAudioEffectState, *const c_char, *mut f32, c_int) -> c_int;

/// A parameter, as the mixer shows it.
#[repr(C)]
pub struct UnityAudioParameterDefinition {
    name: [u8; 16],
    unit: [u8; 16],
    description: *const c_char,
    min: f32,
    max: f32,
    defaultval: f32,
    displayscale: f32,
    displayexponent: f32,
}

/// An effect, as the mixer finds it.
#[repr(C)]
pub struct UnityAudioEffectDefinition {
    structsize: u32,
    paramstructsize: u32,
    apiversion: u32,
    pluginversion: u32,
    channels: u32,
    numparameters: u32,
    flags: u64,
    name: [u8; 32],
    create: Option<OnState>,
    release: Option<OnState>,
    reset: Option<OnState>,
    process: Option<Process>,
    setposition: Option<SetPosition>,
    paramdefs: *const UnityAudioParameterDefinition,
    setfloatparameter: Option<SetFloat>,
    getfloatparameter: Option<GetFloat>,
    getfloatbuffer: Option<GetBuffer>,
}

const _: () = {
    #[cfg(target_pointer_width = "64")]
    assert!(
        size_of::<UnityAudioEffectState>() == 80
            && size_of::<UnityAudioEffectDefinition>() == 136
            && size_of::<UnityAudioParameterDefinition>() == 64
    );
};

/// One effect in a mixer.
struct Effect {
    /// Place of its engine, 0 = none.
    engine: AtomicU32,
}

/// Effect of a state; none before `create` and after `release`.
unsafe fn effect<'a>(state: *mut UnityAudioEffectState) -> Option<&'a Effect> {
    if state.is_null() || !state.is_aligned() {
        return None;
    }
    // SAFETY: the mixer's own state, whose `effectdata` only `create` and `release` write.
    unsafe { (*state).effectdata.cast::<Effect>().as_ref() }
}

unsafe extern "C" fn create(state: *mut UnityAudioEffectState) -> c_int {
    if state.is_null() || !state.is_aligned() {
        return UNSUPPORTED;
    }
    let effect = Box::new(Effect { engine: AtomicU32::new(0) });
    // SAFETY: the mixer's own state, not yet used by anybody else.
    unsafe { (*state).effectdata = Box::into_raw(effect).cast() };
    OK
}

unsafe extern "C" fn release(state: *mut UnityAudioEffectState) -> c_int {
    if state.is_null() || !state.is_aligned() {
        return UNSUPPORTED;
    }
    // SAFETY: what `create` has put there, taken away before it is freed; the mixer does not
    // process any more.
    unsafe {
        let data = std::mem::replace(&mut (*state).effectdata, std::ptr::null_mut());
        if !data.is_null() {
            drop(Box::from_raw(data.cast::<Effect>()));
        }
    }
    OK
}

unsafe extern "C" fn reset(_state: *mut UnityAudioEffectState) -> c_int {
    OK
}

unsafe extern "C" fn set_float(state: *mut UnityAudioEffectState, index: c_int, value: f32) -> c_int {
    // SAFETY: the mixer's own state.
    match unsafe { effect(state) } {
        Some(effect) if index == ENGINE => {
            // Whatever is no engine is none: a float to integer conversion saturates, and NaN is 0.
            effect.engine.store(value.round() as u32, Relaxed);
            OK
        }
        _ => UNSUPPORTED,
    }
}

unsafe extern "C" fn get_float(
    state: *mut UnityAudioEffectState,
    index: c_int,
    value: *mut f32,
    text: *mut c_char,
) -> c_int {
    // SAFETY: the mixer's own state.
    let Some(effect) = (unsafe { effect(state) }).filter(|_| index == ENGINE) else { return UNSUPPORTED };
    if !value.is_null() && value.is_aligned() {
        // SAFETY: not null and aligned; the mixer's own variable.
        unsafe { *value = effect.engine.load(Relaxed) as f32 };
    }
    if !text.is_null() {
        // SAFETY: not null; the mixer gives room for a text.
        unsafe { *text = 0 };
    }
    OK
}

unsafe extern "C" fn get_buffer(
    _state: *mut UnityAudioEffectState,
    _name: *const c_char,
    _buffer: *mut f32,
    _count: c_int,
) -> c_int {
    UNSUPPORTED
}

unsafe extern "C" fn process(
    state: *mut UnityAudioEffectState,
    input: *const f32,
    output: *mut f32,
    frames: u32,
    in_channels: c_int,
    out_channels: c_int,
) -> c_int {
    let (wide_in, wide) = (in_channels.max(0) as usize, out_channels.max(0) as usize);
    let frames = frames as usize;
    if state.is_null()
        || output.is_null()
        || !output.is_aligned()
        || wide == 0
        || frames > 1 << 20
        || wide > 64
    {
        return UNSUPPORTED;
    }
    // SAFETY: the mixer's buffer of so many frames and channels.
    let out = unsafe { std::slice::from_raw_parts_mut(output, frames * wide) };
    for frame in 0..frames {
        for channel in 0..wide {
            let through = if channel < wide_in && !input.is_null() {
                // SAFETY: the mixer's other buffer, within its frames and channels.
                unsafe { input.add(frame * wide_in + channel).read_unaligned() }
            } else {
                0.0
            };
            out[frame * wide + channel] = through;
        }
    }
    // SAFETY: the mixer's own state.
    let (flags, tick) = unsafe { ((*state).flags, (*state).currdsptick) };
    // SAFETY: as above.
    let engine = unsafe { effect(state) }.map_or(0, |effect| effect.engine.load(Relaxed)) as usize;
    if flags & IS_PLAYING == 0 || flags & (IS_PAUSED | IS_MUTED) != 0 || engine == 0 {
        return OK;
    }
    guarded(|| {
        let Some(mut half) = RENDERERS.hold_at(engine - 1) else { return };
        if half.tick == Some(tick) {
            return;
        }
        half.tick = Some(tick);
        // Buses only: what is felt has no place in a mix.
        for chunk in out.chunks_mut(CHUNK_FRAMES * wide) {
            half.render(chunk.len() / wide);
            half.mix(chunk, wide);
        }
    });
    OK
}

impl crate::handles::AudioHalf {
    /// Adds all buses to the first two channels.
    fn mix(&self, chunk: &mut [f32], wide: usize) {
        for bus in &self.audio {
            for (frame, x) in chunk.chunks_exact_mut(wide).zip(bus) {
                frame.iter_mut().take(2).for_each(|channel| *channel += *x);
            }
        }
    }
}

/// A text in a field of fixed length.
const fn field<const N: usize>(text: &[u8]) -> [u8; N] {
    let mut field = [0; N];
    let mut at = 0;
    while at < text.len() && at + 1 < N {
        field[at] = text[at];
        at += 1;
    }
    field
}

/// Definitions for the mixer, for as long as the program runs.
struct Definitions {
    list: [*const UnityAudioEffectDefinition; 1],
    effect: UnityAudioEffectDefinition,
    parameter: UnityAudioParameterDefinition,
}

// SAFETY: nobody writes to them once they are made.
unsafe impl Send for Definitions {}
// SAFETY: as above.
unsafe impl Sync for Definitions {}

fn definitions() -> &'static Definitions {
    static MADE: OnceLock<&'static Definitions> = OnceLock::new();
    MADE.get_or_init(|| {
        let parameter = UnityAudioParameterDefinition {
            name: field(b"Engine"),
            unit: field(b""),
            description: c"Which engine plays here: the number that asp_unity_slot gives; 0 = none".as_ptr(),
            min: 0.0,
            max: crate::handle::PLACES as f32,
            defaultval: 0.0,
            displayscale: 1.0,
            displayexponent: 1.0,
        };
        let effect = UnityAudioEffectDefinition {
            structsize: size_of::<UnityAudioEffectDefinition>() as u32,
            paramstructsize: size_of::<UnityAudioParameterDefinition>() as u32,
            apiversion: API_VERSION,
            pluginversion: crate::version::asp_version(),
            channels: 0,
            numparameters: 1,
            flags: 0,
            name: field(b"Asperity"),
            create: Some(create),
            release: Some(release),
            reset: Some(reset),
            process: Some(process),
            setposition: None,
            paramdefs: std::ptr::null(),
            setfloatparameter: Some(set_float),
            getfloatparameter: Some(get_float),
            getfloatbuffer: Some(get_buffer),
        };
        let made = Box::leak(Box::new(Definitions { list: [std::ptr::null()], effect, parameter }));
        made.effect.paramdefs = &raw const made.parameter;
        made.list = [&raw const made.effect];
        made
    })
}

/// Entry point that Unity calls when it loads the library: one effect, "Asperity".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn UnityGetAudioEffectDefinitions(
    definitions: *mut *const *const UnityAudioEffectDefinition,
) -> c_int {
    if definitions.is_null() || !definitions.is_aligned() {
        return 0;
    }
    let made = self::definitions();
    // SAFETY: not null and aligned; Unity's own variable.
    unsafe { *definitions = made.list.as_ptr() };
    made.list.len() as c_int
}

/// The number by which the mixer effect "Asperity" finds a renderer: the value of its parameter
/// "Engine".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_unity_slot(renderer: *mut asp_renderer, slot: *mut u32) -> i32 {
    enter(|| {
        let slot = out(slot, "slot")?;
        *slot = 0;
        drop(RENDERERS.hold(renderer as usize)?);
        let index = RENDERERS.index(renderer as usize).ok_or_else(|| {
            Failure::new(ASP_BAD_HANDLE, "renderer: is no handle; give one that asp_build made")
        })?;
        *slot = index as u32 + 1;
        Ok(())
    })
}
