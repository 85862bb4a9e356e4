//! Options of `asperity fit`.

use asperity_fit::FitOptions;
use clap::Args;
use std::path::PathBuf;

/// Turn one recorded impact into modes
#[derive(Debug, Args)]
pub struct Options {
    /// Recording of a strike: WAV, AIFF, FLAC, Ogg Vorbis, MP3 or M4A, 1 kHz – 1 MHz; or a modal
    /// table (.csv, .tsv, .txt, .json), or a modes file
    #[arg(value_name = "RECORDING.wav")]
    pub recording: PathBuf,
    /// With --family: further takes, hits of the same object
    #[arg(value_name = "TAKE.wav", requires = "family")]
    pub further: Vec<PathBuf>,
    /// Make one body of all the recordings: poles in common, and each take's own excitation as one
    /// of the body's strike positions
    #[arg(long, requires = "further")]
    pub family: bool,
    /// Modes file to write
    #[arg(short, long = "output", value_name = "OUT.modes.json")]
    pub output: PathBuf,
    /// Impulse that the recorded strike delivered, N·s
    #[arg(long, value_name = "N_S", default_value_t = 0.01)]
    pub impulse: f64,
    /// Most modes
    #[arg(long, value_name = "N", default_value_t = FitOptions::default().max_modes)]
    pub max_modes: usize,
    /// Lowest frequency, Hz
    #[arg(long, value_name = "HZ", default_value_t = 20.0)]
    pub from_hz: f64,
    /// Highest frequency, Hz
    #[arg(long, value_name = "HZ")]
    pub to_hz: Option<f64>,
    /// Drop modes this far below the strongest in energy, dB
    #[arg(long, value_name = "DB", default_value_t = -90.0, allow_negative_numbers = true)]
    pub min_level: f64,
    /// Channel: loudest, mix, or its number from 0
    #[arg(long, value_name = "CHANNEL", default_value = "loudest")]
    pub channel: String,
    /// Which strike of the recording, from 1, instead of the best
    #[arg(long, value_name = "N")]
    pub strike: Option<usize>,
    /// Fit from this long after the onset instead of finding out, ms
    #[arg(long, value_name = "MS")]
    pub start_ms: Option<f64>,
    /// Make the body this many times as large
    #[arg(long, value_name = "FACTOR")]
    pub scale_size: Option<f64>,
    /// Give the body the damping of another: its modes file, or ALPHA,BETA of d = α + β ω²
    #[arg(long, value_name = "MODES.json|ALPHA,BETA")]
    pub material: Option<String>,
    /// More strikes of the same object: they become the body's further strike positions; each is
    /// also written as OUT.strikeN.modes.json with the common frequencies
    #[arg(long, value_name = "STRIKE.wav", num_args = 1..)]
    pub merge: Vec<PathBuf>,
    /// With --merge: the struck body with its mode shapes (a modes file of version 2); says at
    /// which place each strike was made and how much of their difference that explains. Nothing
    /// else changes
    #[arg(long, value_name = "BODY.modes.json", requires = "merge")]
    pub mesh: Option<PathBuf>,
    /// Write what the modes do not explain
    #[arg(long, value_name = "OUT.wav")]
    pub residual: Option<PathBuf>,
    /// Write what the engine plays when it strikes the modes, in the recording's place
    #[arg(long, value_name = "OUT.wav")]
    pub resynthesis: Option<PathBuf>,
    /// Draw recording, struck body and what is left, waves and spectrograms on one scale
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,
    /// Write the modes as a table
    #[arg(long, value_name = "OUT.csv")]
    pub csv: Option<PathBuf>,
    /// Put this much of what the modes do not explain into the modes file; impacts will play it, ms
    #[arg(long, value_name = "MS")]
    pub burst_ms: Option<f64>,
    /// Write bands of noise for what the modes do not explain; impacts and strokes will play them
    #[arg(long)]
    pub bands: bool,
    /// Body to import of a table with several
    #[arg(long, value_name = "NAME")]
    pub entry: Option<String>,
    /// Frequency of a ratio of 1 in a table of ratios, Hz
    #[arg(long, value_name = "HZ")]
    pub base_hz: Option<f64>,
    /// Ringing time (60 dB) of the modes of a table without decays, s
    #[arg(long, value_name = "S")]
    pub t60: Option<f64>,
    /// Sample rate of a table's pole radii, Hz
    #[arg(long, value_name = "HZ", default_value_t = 44_100.0)]
    pub table_rate: f64,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

impl Options {
    /// The further recordings of the same object: of `--family`, and of `--merge`.
    pub(super) fn others(&self) -> impl Iterator<Item = &PathBuf> {
        self.further.iter().chain(&self.merge)
    }

    pub(super) fn fit_options(&self) -> FitOptions {
        FitOptions {
            max_modes: self.max_modes,
            band_hz: (self.from_hz, self.to_hz.unwrap_or(f64::INFINITY)),
            least_level_db: self.min_level,
            start_offset_s: self.start_ms.map(|ms| 1e-3 * ms),
            strike: self.strike,
            ..FitOptions::default()
        }
    }
}
