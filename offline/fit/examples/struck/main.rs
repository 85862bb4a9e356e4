//! Fitted bodies beside their recordings, as the engine plays them: `struck [--program ASPERITY]
//! [--out DIR] [--late] FILE…`
//!
//! Every file is fitted, the modes are struck once in the engine by an impulse of the model's own
//! size, and what the renderer gives is held against the recording from the onset on (time zero
//! within ±1 ms). With `--program` the fit is that of another build of `asperity` (its `--json` and
//! modes file are read), so that two builds can be compared. With `--out` recording, struck body
//! and modes of every file are written there, to be heard and looked at; with `--late` every late
//! partial is told, what is missing of it, and the modes near it.
//!
//! | column | what |
//! |---|---|
//! | `s` | processor time of the fit |
//! | `peak` | peak of the struck body over the recording's, dB |
//! | `err5`, `burst` | energy of the difference in the first 5 ms over the recording's there, dB; with a burst of 40 ms |
//! | `snr`, `told` | recording over difference from the onset on, dB; what the fit states |
//! | `late` | partials at 0.3–0.6 s within 25 dB of the loudest that are more than 20 dB too quiet, of all |
//! | `decay` | median error of the decays of partials within 25 dB of the loudest, %, by the slope of level and of energy to come |
//! | `split` | strong resonances of several modes of which fewer would do + those that beat, of all ([`resonances`]) |
//! | `ring` | longest T60 over the length of sound that was seen |
//! | `modes`, `limit` | how many; whether a warning names the mode limit |

mod engine;
mod fitting;
mod partials;
mod resonances;

use asperity_dsp::mode::Mode;
use asperity_evidence::score::snr_db;
use asperity_fit::{ChannelChoice, Recording, load};
use fitting::{Fitted, by_program, in_process};
use partials::{DecayError, decay_errors, late_partials};
use resonances::{Resonances, resonances};

/// Length of the burst that bodies carry, s.
const BURST_S: f64 = 0.04;
/// What counts as the attack, s.
const ATTACK_S: f64 = 0.005;
/// How far time zero may be moved, s, and what is aligned.
const SHIFT_S: f64 = 0.001;
const ALIGNED_S: f64 = 0.05;

fn main() {
    let mut args = std::env::args().skip(1).peekable();
    let program = args.next_if(|arg| arg == "--program").and_then(|_| args.next());
    let out = args.next_if(|arg| arg == "--out").and_then(|_| args.next());
    let listed = args.next_if(|arg| arg == "--late").is_some();
    println!("    s   peak   err5  burst    snr   told    late  decay  split     ring  modes limit  file");
    let mut rows = Vec::new();
    for path in args {
        let name = path.rsplit('/').next().unwrap_or_default().to_owned();
        let fitted = match &program {
            Some(program) => by_program(program, &path, BURST_S),
            None => in_process(&path, BURST_S),
        };
        let row = fitted.and_then(|fitted| {
            let recording = load(&path, ChannelChoice::Loudest).map_err(|error| error.to_string())?;
            Row::of(&recording, &fitted, out.as_deref().map(|out| format!("{out}/{name}")), listed)
        });
        match row {
            Ok(row) => {
                println!("{}  {name}", row.text());
                rows.push(row);
            }
            Err(error) => println!("error: {name}: {error}"),
        }
    }
    summary(&rows);
}

/// The figures of one file.
struct Row {
    cpu_s: f64,
    peak_db: f64,
    err5_db: f64,
    burst_db: f64,
    snr_db: f64,
    told_db: f64,
    late: (usize, usize),
    decays: Vec<DecayError>,
    resonances: Resonances,
    ring: f64,
    modes: usize,
    limit: bool,
}

impl Row {
    fn of(recording: &Recording, fitted: &Fitted, out: Option<String>, listed: bool) -> Result<Self, String> {
        let rate = recording.sample_rate_hz;
        let tail = &recording.samples[recording.samples.len() * 3 / 4..];
        let mean = tail.iter().sum::<f64>() / tail.len() as f64;
        let at = |s: f64| ((s - recording.starts_at_s).max(0.0) * rate).round() as usize;
        let (from, to) = (at(fitted.onset_s), at(fitted.end_s).min(recording.samples.len()));
        let sound: Vec<f64> = recording.samples[from..to].iter().map(|x| x - mean).collect();
        let alone = aligned(&sound, &engine::struck(&fitted.modes, None, rate, sound.len(), SHIFT_S), rate);
        let whole = engine::struck(&fitted.modes, Some(&fitted.burst), rate, sound.len(), SHIFT_S);
        let whole = aligned(&sound, &whole, rate);
        let left: Vec<f64> = sound.iter().zip(&alone).map(|(x, y)| x - y).collect();
        let attack = ((ATTACK_S * rate) as usize).min(sound.len());
        if let Some(out) = out {
            written(&out, fitted, &sound, &alone, rate).map_err(|error| error.to_string())?;
        }
        let late = late_partials(&sound, &alone, rate);
        if listed {
            late.iter().for_each(|late| println!("{}", late.text(&fitted.modes)));
        }
        let strongest = fitted.modes.iter().map(|m| m.t60_s()).fold(0.0, f64::max);
        Ok(Self {
            cpu_s: fitted.cpu_s,
            peak_db: 20.0 * (peak(&alone) / peak(&sound)).max(1e-9).log10(),
            err5_db: -snr_db(&sound[..attack], &alone[..attack]),
            burst_db: -snr_db(&sound[..attack], &whole[..attack]),
            snr_db: snr_db(&sound, &alone),
            told_db: fitted.told_snr_db,
            late: (late.iter().filter(|l| l.absent()).count(), late.len()),
            decays: decay_errors(&sound, &alone, rate),
            resonances: resonances(&fitted.modes, &sound, &left, rate),
            ring: strongest * rate / sound.len() as f64,
            modes: fitted.modes.len(),
            limit: fitted.warnings.iter().any(|w| w.starts_with("mode limit")),
        })
    }

    fn decay(&self) -> f64 {
        quantile(&self.decays.iter().map(|d| d.both).collect::<Vec<_>>(), 0.5)
    }

    fn text(&self) -> String {
        format!(
            "{:5.2} {:6.1} {:6.1} {:6.1} {:6.1} {:6.1} {:3}/{:<3} {:6.1} {:3}+{:2}/{:<3} {:5.1} {:5}  {:4}",
            self.cpu_s,
            self.peak_db,
            self.err5_db,
            self.burst_db,
            self.snr_db,
            self.told_db,
            self.late.0,
            self.late.1,
            100.0 * self.decay(),
            self.resonances.split,
            self.resonances.beating,
            self.resonances.all,
            self.ring,
            self.modes,
            if self.limit { "yes" } else { "no" }
        )
    }
}

/// `OUT.recorded.wav`, `OUT.struck.wav` and the modes, `OUT.csv`.
fn written(
    out: &str,
    fitted: &Fitted,
    sound: &[f64],
    struck: &[f64],
    rate: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: rate as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    for (kind, samples) in [("recorded", sound), ("struck", struck)] {
        let mut file = hound::WavWriter::create(format!("{out}.{kind}.wav"), spec)?;
        samples.iter().try_for_each(|&x| file.write_sample(x as f32))?;
        file.finalize()?;
    }
    let row = |m: &Mode| format!("{},{},{},{}\n", m.frequency_hz, m.decay_per_s, m.amplitude, m.phase_rad);
    let rows: String = fitted.modes.iter().map(row).collect();
    Ok(std::fs::write(format!("{out}.csv"), format!("frequency_hz,decay_per_s,amplitude,phase_rad\n{rows}"))?)
}

/// Medians, extremes and sums over all files.
fn summary(rows: &[Row]) {
    if rows.is_empty() {
        return;
    }
    let column = |value: fn(&Row) -> f64| rows.iter().map(value).collect::<Vec<f64>>();
    let line = |name: &str, values: Vec<f64>| {
        println!(
            "{name:14} median {:6.2}   90 % {:6.2}   least {:6.2}   most {:6.2}",
            quantile(&values, 0.5),
            quantile(&values, 0.9),
            quantile(&values, 0.0),
            quantile(&values, 1.0)
        );
    };
    println!("{} files", rows.len());
    line("processor s", column(|r| r.cpu_s));
    line("peak dB", column(|r| r.peak_db));
    line("err5 dB", column(|r| r.err5_db));
    line("with burst dB", column(|r| r.burst_db));
    line("snr dB", column(|r| r.snr_db));
    line("told - snr dB", column(|r| r.told_db - r.snr_db));
    line("ring", column(|r| r.ring));
    let with_decays = rows.iter().filter(|r| !r.decays.is_empty());
    line("decay %", with_decays.map(|r| 100.0 * r.decay()).collect());
    let errors =
        |of: fn(&DecayError) -> f64| rows.iter().flat_map(|r| &r.decays).map(|d| 100.0 * of(d)).collect();
    line("of all", errors(|d| d.both));
    line("  by level", errors(|d| d.level));
    line("  by energy", errors(|d| d.energy));
    let sum = |part: fn(&Row) -> (usize, usize)| {
        rows.iter().map(part).fold((0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
    };
    let late = sum(|r| r.late);
    let of_all = |part: fn(&Resonances) -> usize| rows.iter().map(|r| part(&r.resonances)).sum::<usize>();
    let (split, beating, all) = (of_all(|r| r.split), of_all(|r| r.beating), of_all(|r| r.all));
    println!(
        "late partials absent: {} of {}; of {all} strong resonances {split} split, {beating} beating",
        late.0, late.1
    );
    println!("mode limit named: {} of {}", rows.iter().filter(|r| r.limit).count(), rows.len());
}

/// The value below which a share of `values` lies; 0 of none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(rank).copied().unwrap_or(0.0)
}

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |peak, x| peak.max(x.abs()))
}

/// `struck`, which begins `SHIFT_S` before its strike, moved to where the first `ALIGNED_S` agree
/// best.
fn aligned(sound: &[f64], struck: &[f64], rate: f64) -> Vec<f64> {
    let shift = (SHIFT_S * rate).round() as usize;
    let count = ((ALIGNED_S * rate) as usize).min(sound.len());
    let error =
        |lag: usize| sound[..count].iter().zip(&struck[lag..]).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
    let lag = (0..=2 * shift).min_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap_or(shift);
    struck[lag..lag + sound.len()].to_vec()
}
