//! asperity's solver of shapes as WebAssembly, for a worker of the page: one mesh becomes one body.
//!
//! | call | inbox | outbox |
//! |---|---|---|
//! | [`shape_solve`] | name of the mesh's file, then its bytes | see [`shape_solve`]; all `f64` |
//! | [`shape_told`] | – | repairs and doubts of the last solve, a line each |
//!
//! A call that can fail answers 1 when it is done and 0 when it is not; then the outbox holds a
//! sentence that says what is wrong and what would be right. Numbers are little-endian. Exported
//! functions are safe whatever they are given.

// What is exported keeps its name.
#![allow(unsafe_code)]

use asperity_dsp::damping::Damping;
use asperity_shape::eigenmodes::Wanted;
use asperity_shape::ringing::ringing;
use asperity_shape::vector::longest_side;
use asperity_shape::{Elastic, Fineness, Making, SolvedBody, make_as_fine_as, parse};
use std::cell::RefCell;
use std::ops::RangeInclusive;
use std::path::Path;

/// Most modes of a body that a page plays beside four fingers; each has a shape of its own.
const MOST_MODES: usize = 64;
/// Longest sides that a body in metres is likely to have, m; one in other units gets [`USUAL_M`].
const LIKELY_M: RangeInclusive<f64> = 0.02..=2.0;
/// Size without one, m.
const USUAL_M: f64 = 0.15;
/// Highest audible mode, Hz.
const HEARD_HZ: f64 = 16_000.0;

thread_local! {
    static INBOX: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTBOX: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static TOLD: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Makes room for so many bytes and tells where.
#[unsafe(no_mangle)]
pub extern "C" fn shape_inbox(bytes: usize) -> *mut u8 {
    INBOX.with_borrow_mut(|inbox| {
        inbox.clear();
        inbox.resize(bytes, 0);
        inbox.as_mut_ptr()
    })
}

/// Address of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn shape_outbox() -> *const u8 {
    OUTBOX.with_borrow(|outbox| outbox.as_ptr())
}

/// Length of the last answer, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn shape_outbox_bytes() -> usize {
    OUTBOX.with_borrow(Vec::len)
}

/// Solves a mesh (`.obj`, `.stl`, `.msh`) for at most so many modes, as fine as a preview.
/// `name_bytes`: how long the name in the inbox is; then what it is made of (Pa, 1, kg/m³; 1/s, 1,
/// s) and its longest side, m, or 0: as the file says, where that is likely. Outbox: how many
/// modes, points and triangles, the struck point, unknowns, mass in kg; of every mode gain,
/// frequency, decay, amplitude, phase; of every point its place, m; of every triangle its points;
/// of every mode the motion of every point, kg^−½.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)] // Numbers are all that goes over without a generator of bindings.
pub extern "C" fn shape_solve(
    name_bytes: usize,
    young_pa: f64,
    poisson: f64,
    density_kg_m3: f64,
    alpha_per_s: f64,
    eta: f64,
    beta_s: f64,
    size_m: f64,
    most: usize,
) -> u32 {
    let making = Making {
        material: Elastic { young_pa, poisson, density_kg_m3 },
        size_m: (size_m > 0.0).then_some(size_m),
        unit_m: None,
        thickness_m: None,
        wanted: Wanted { most: most.clamp(1, MOST_MODES), up_to_hz: Some(HEARD_HZ) },
    };
    let damping = Damping { alpha_per_s, eta, beta_s };
    let solved = INBOX.with_borrow(|inbox| solved(inbox, name_bytes, &making, damping));
    let (is_done, bytes) = match solved {
        Ok(numbers) => (1, numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
        Err(sentence) => (0, sentence.into_bytes()),
    };
    OUTBOX.set(bytes);
    is_done
}

/// Remarks of the last solve.
#[unsafe(no_mangle)]
pub extern "C" fn shape_told() {
    OUTBOX.set(TOLD.take().into_bytes());
}

fn solved(inbox: &[u8], name_bytes: usize, making: &Making, damping: Damping) -> Result<Vec<f64>, String> {
    let parts = inbox.split_at_checked(name_bytes);
    let named = parts.and_then(|(name, mesh)| Some((str::from_utf8(name).ok()?, mesh)));
    let (name, mesh) = named.ok_or("inbox: has no name; must hold the file's name, then the file")?;
    let damping = damping.checked().map_err(|error| error.to_string())?;
    let mesh = parse(Path::new(name), mesh).map_err(|error| error.to_string())?;
    let side = longest_side(mesh.points());
    let mut making = *making;
    let is_odd = making.size_m.is_none() && !LIKELY_M.contains(&side);
    if is_odd {
        making.size_m = Some(USUAL_M);
    }
    let mut body = make_as_fine_as(mesh, &making, &Fineness::PREVIEW, &mut |_| {})
        .map_err(|error| error.within(name).to_string())?;
    if is_odd {
        body.remarks.insert(
            0,
            format!("it is {side:.3} long in the file, where a metre is 1; it is taken as {USUAL_M} m"),
        );
    }
    numbers(body, &damping)
}

fn numbers(mut body: SolvedBody, damping: &Damping) -> Result<Vec<f64>, String> {
    let struck_point = body.field.lively_point().unwrap_or(0);
    let gains = body.field.gains.clone();
    let modes = ringing(&mut body, damping, struck_point, |mode, _| (gains[mode], 0.0));
    if modes.is_empty() {
        return Err("no mode of it rings; must be stiffer, larger or less damped".to_owned());
    }
    TOLD.set(body.remarks.join("\n"));
    let field = &body.field;
    let counts =
        [modes.len(), field.points.len(), field.triangles.len(), struck_point, body.degrees_of_freedom];
    let mut numbers: Vec<f64> = counts.map(|count| count as f64).to_vec();
    numbers.push(body.mass_kg);
    numbers
        .extend(modes.iter().flat_map(|m| [m.gain, m.frequency_hz, m.decay_per_s, m.amplitude, m.phase_rad]));
    numbers.extend(field.points.iter().flatten());
    numbers.extend(field.triangles.iter().flatten().map(|&point| f64::from(point)));
    numbers.extend(modes.iter().flat_map(|m| field.shapes[m.mode].iter().flatten()));
    Ok(numbers)
}
