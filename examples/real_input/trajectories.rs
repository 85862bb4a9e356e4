//! Recorded pen movements and tosses as contact logs.
//!
//! What the recordings do not hold is assumed, and says so: the size of a screen pixel, what force
//! full pen pressure means, and how fast a pen lands.

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine, Striker};

/// Full pressure of a pen, N. Assumed: tablets saturate at 3–5 N, recordings of writing peak near
/// half.
pub const FULL_PRESSURE_N: f64 = 2.0;
/// Size of a canvas pixel of the painting session, m. Assumed: a canvas of 800 px on a small
/// tablet.
pub const PIXEL_M: f64 = 0.15e-3;
/// How fast a pen lands, m/s. Assumed: the recordings hold no height above the paper.
pub const LANDING_M_S: f64 = 0.02;
/// Longer without a sample, the pen counts as lifted, s.
pub const LONGEST_GAP_S: f64 = 0.1;
/// Faster than this between two samples, the pen was set down elsewhere, m/s.
pub const FASTEST_M_S: f64 = 2.0;
/// Most the pen may move between two samples whatever the time, m: rounding of positions and times.
const JUMP_MARGIN_M: f64 = 1e-3;

/// One sample of a pen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PenSample {
    /// Time, s.
    pub t: f64,
    /// Position, m; y downwards.
    pub position_m: [f64; 2],
    /// 0–1; 0 = lifted.
    pub pressure: f64,
}

/// A handwriting recording: a count, then x mm, y mm, t s, pen down, azimuth, tilt, pressure.
pub fn handwriting(text: &str) -> Result<Vec<PenSample>, String> {
    let rows = text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty());
    rows.map(|(index, line)| match numbers(line, index)?[..] {
        [x_mm, y_mm, t, down, _, _, pressure] => Ok(PenSample {
            t,
            position_m: [x_mm * 1e-3, y_mm * 1e-3],
            // The first sample of a stroke may be down without pressure yet.
            pressure: if down > 0.0 { f64::max(pressure, 1e-3) } else { 0.0 },
        }),
        _ => Err(format!("line {}: not seven numbers", index + 1)),
    })
    .collect()
}

/// A painting session: t s, x px, y px, pressure.
pub fn painting(text: &str) -> Result<Vec<PenSample>, String> {
    let rows = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    rows.map(|(index, line)| match numbers(line, index)?[..] {
        [t, x_px, y_px, pressure] => {
            Ok(PenSample { t, position_m: [x_px * PIXEL_M, y_px * PIXEL_M], pressure })
        }
        _ => Err(format!("line {}: not four numbers", index + 1)),
    })
    .collect()
}

fn numbers(line: &str, index: usize) -> Result<Vec<f64>, String> {
    line.split_whitespace()
        .map(|word| word.parse().map_err(|_| format!("line {}: \"{word}\" is no number", index + 1)))
        .collect()
}

/// Strokes of a pen over a surface of this size. A lifted pen, a gap in time and a jump end the
/// contact; what comes after is a new one. With `velocity`, moves carry the speed since the sample
/// before, as a game's physics would report it; without, the engine has to estimate.
pub fn strokes(samples: &[PenSample], surface: &str, size_m: [f64; 2], velocity: bool) -> ContactLog {
    let mut lines: Vec<LogLine> = Vec::new();
    let mut contact = 0;
    let mut last: Option<PenSample> = None;
    for now in samples {
        if let Some(before) = last.filter(|before| now.pressure <= 0.0 || !goes_on(before, now)) {
            // A gap: nothing is known after the last sample. A lift: it ends where it was noticed.
            let t = if now.t - before.t > LONGEST_GAP_S { before.t } else { now.t };
            lines.push(LogLine { t, event: LogEvent::End { contact } });
            last = None;
        }
        if now.pressure <= 0.0 {
            continue;
        }
        let mut sample = ContactSample {
            uv: [now.position_m[0] / size_m[0], now.position_m[1] / size_m[1]],
            velocity_m_s: last.filter(|_| velocity).map(|before| speed(&before, now)),
            normal_force_n: now.pressure * FULL_PRESSURE_N,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if last.is_some() {
            LogEvent::moved(contact, sample)
        } else {
            contact += 1;
            sample.closing_m_s = LANDING_M_S;
            LogEvent::begin(contact, surface, 0, sample)
        };
        lines.push(LogLine { t: now.t, event });
        last = Some(*now);
    }
    if let Some(before) = last {
        lines.push(LogLine { t: before.t, event: LogEvent::End { contact } });
    }
    ContactLog { lines }
}

fn goes_on(before: &PenSample, now: &PenSample) -> bool {
    let dt = now.t - before.t;
    let [dx, dy] = [0, 1].map(|axis| now.position_m[axis] - before.position_m[axis]);
    dt > 0.0 && dt <= LONGEST_GAP_S && dx.hypot(dy) <= FASTEST_M_S * dt + JUMP_MARGIN_M
}

fn speed(before: &PenSample, now: &PenSample) -> [f64; 2] {
    [0, 1].map(|axis| (now.position_m[axis] - before.position_m[axis]) / (now.t - before.t))
}

/// Mass of the tossed cube, kg; from the recording's own description.
const CUBE_KG: f64 = 0.37;
/// Restitution of the tossed cube; as above.
const CUBE_RESTITUTION: f64 = 0.125;
/// Radius of its corners, m. Assumed.
const CORNER_M: f64 = 2e-3;
const GRAVITY_M_S2: f64 = 9.81;
/// Smaller changes of speed between two samples are noise of the tracker, m/s.
const LEAST_CHANGE_M_S: f64 = 0.25;

/// Tosses of a cube (`toss,t_s,x_m,…,vx_mps,vy_mps,vz_mps,…`) as impacts on `body`, one toss after
/// the other. An impact is where the cube gains upward speed that gravity cannot give; its impulse
/// m Δv = m v (1 + e) says how fast the cube struck.
pub fn tosses(csv: &str, body: &str) -> Result<ContactLog, String> {
    let mut lines = Vec::new();
    let mut before: Option<[f64; 3]> = None;
    let mut start_s = 0.0;
    let mut falling = true;
    for (index, row) in csv.lines().enumerate().skip(1) {
        let row: Vec<f64> = row
            .split(',')
            .map(|word| word.parse().map_err(|_| format!("line {}: \"{word}\" is no number", index + 1)))
            .collect::<Result<_, _>>()?;
        let [toss, t, .., vz, _, _, _] = row[..] else {
            return Err(format!("line {}: too short", index + 1));
        };
        if let Some([last_toss, last_t, last_vz]) = before {
            if toss != last_toss {
                start_s += last_t + 0.5;
                falling = true;
            } else {
                let gained = vz - last_vz + GRAVITY_M_S2 * (t - last_t);
                // One impact is smeared over a few samples by the tracker's smoothing.
                if gained >= LEAST_CHANGE_M_S && falling {
                    lines.push(LogLine { t: start_s + t, event: impact(body, gained) });
                }
                falling = gained < LEAST_CHANGE_M_S;
            }
        }
        before = Some([toss, t, vz]);
    }
    Ok(ContactLog { lines })
}

fn impact(body: &str, gained_m_s: f64) -> LogEvent {
    LogEvent::Impact {
        body: body.into(),
        other: None,
        speed_m_s: gained_m_s / (1.0 + CUBE_RESTITUTION),
        mass_kg: CUBE_KG,
        radius_m: CORNER_M,
        striker: Striker::Preset("plastic".into()),
        restitution: CUBE_RESTITUTION,
        position: 0,
        at_m: None,
        direction: None,
        hand: Default::default(),
    }
}
