//! The live clock: a game's time on the audio's time line, whatever the game does with it.
//!
//! ```text
//! sample = origin + (t − t₀) · rate / pace        pace: game seconds a second of audio
//! ```
//!
//! | the game | is seen as | and answered by |
//! |---|---|---|
//! | jitters, drifts | leads that change a little | the mapping follows the smallest lead |
//! | sends ticks in bursts | leads of up to [`BREAK_S`] within a burst | nothing: stamps keep their distances |
//! | reports again and again while it stands | stamps that are the same | nothing |
//! | pauses, restarts at 0, skips, stamps one event wrongly | a stamp and the audio part by more than [`BREAK_S`] | tied anew, counted |
//! | hitches, and catches up in a burst | a stamp that comes more than [`LATE_S`] late | tied anew, counted: the burst keeps its distances |
//! | … by less, or by more, with strikes among it | two strikes that would sound on one sample | tied anew, counted: they keep their distance |
//! | goes on while the audio stands still | reports of more than [`BREAK_S`] at one position | tied anew each 0.1 s, counted; strikes from before a tie are dropped |
//! | runs ahead of the audio for good, as after a shorter gap | no stamp within a window comes close | its time runs faster by [`MAX_OVERSPEED`] until one does |
//! | runs in slow motion or fast | the smallest lead drifts by the same share in window after window | its pace is followed, counted |

/// A stamp that parts from the audio by more than this is no jitter and no burst, s: eight ticks at
/// 60 Hz are 117 ms apart.
pub(super) const BREAK_S: f64 = 0.25;
/// A stamp that comes later than this comes from a game that has hitched, s: three ticks at 50 Hz.
const LATE_S: f64 = 0.06;
/// Lateness that is the clocks' and not the network's or the frame's, s.
const SLIGHTLY_LATE_S: f64 = 0.002;
/// Share of a larger lateness that moves the mapping.
const FOLLOW: f64 = 0.05;
/// Step by which the mapping creeps back with each early stamp, samples: a drift of 200 ppm at 60
/// events/s.
const CREEP_SAMPLES: f64 = 0.2;
/// … and this share of the smallest lead of the last window, so that a latency nobody needs goes
/// within seconds.
const CREEP_SHARE: f64 = 0.01;
/// … or, while every stamp lies too far ahead, this share of the time that goes by: distances
/// shrink by as much, and nothing that waits is thrown onto what is reported now.
const MAX_OVERSPEED: f64 = 0.05;
/// Length of a window in which the smallest lead is looked for, s of audio.
const WINDOW_S: f64 = 0.3;
/// Events a window needs to say something.
const WINDOW_EVENTS: u32 = 4;
/// Drift of the smallest lead, seconds a second, that is another pace; and once another pace is
/// known, one that corrects it.
const OTHER_PACE: f64 = 0.1;
const CORRECTION: f64 = 0.03;
/// Slowest and fastest pace that is followed; slower is a pause.
const PACES: (f64, f64) = (1.0 / 16.0, 16.0);

/// Decision of the clock about a stamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Followed {
    /// Place of it, samples.
    pub sample: f64,
    /// Game time and audio were tied anew.
    pub jumped: bool,
    /// The game was found to run at another pace.
    pub repaced: bool,
}

/// The mapping's memory.
#[derive(Debug, Clone)]
pub(super) struct Live {
    sample_rate_hz: f64,
    max_lead: f64,
    pace: f64,
    tied: Option<Tie>,
}

#[derive(Debug, Clone)]
struct Tie {
    time_s: f64,
    sample: f64,
    latest: (f64, f64),
    /// Place of the latest stamp, samples.
    latest_sample: f64,
    window: Window,
    /// Smallest lead of the window before, and when that window began.
    before: Option<(f64, f64)>,
    drift: Option<f64>,
    least_lead: f64,
    /// No stamp of the last window came close to the audio.
    ahead: bool,
}

/// The smallest measure of how far the game is ahead, since `began`.
#[derive(Debug, Clone)]
struct Window {
    began: f64,
    events: u32,
    /// Game time at the game's pace less audio time: it does not know of ties.
    least: f64,
    /// Mapped less audio time.
    least_lead: f64,
}

impl Window {
    fn at(began: f64) -> Self {
        Self { began, events: 0, least: f64::INFINITY, least_lead: f64::INFINITY }
    }
}

impl Live {
    pub fn new(max_lead_s: f64, sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, max_lead: max_lead_s * sample_rate_hz, pace: 1.0, tied: None }
    }

    /// Window at another rate, to be tied anew.
    pub fn at_rate(&mut self, sample_rate_hz: f64) {
        let max_lead_s = self.max_lead / self.sample_rate_hz;
        *self = Self { pace: self.pace, ..Self::new(max_lead_s, sample_rate_hz) };
    }

    /// Clears the tie; the next stamp holds at the next sample.
    pub fn untie(&mut self) {
        self.tied = None;
        self.pace = 1.0;
    }

    /// Game seconds a second of audio.
    pub fn pace(&self) -> f64 {
        self.pace
    }

    /// Place of game time `time_s` when the audio is at `position`.
    pub fn follow(&mut self, time_s: f64, position: f64) -> Followed {
        let break_samples = BREAK_S * self.sample_rate_hz;
        let Some(mut tie) = self.tied.take() else {
            self.tie_anew(time_s, position);
            return Followed { sample: position, jumped: false, repaced: false };
        };
        if time_s == tie.latest.0 {
            // No game time has gone by: another event of the same tick, or a game that stands.
            let sample = tie.latest_sample;
            self.tied = Some(tie);
            return Followed { sample, jumped: false, repaced: false };
        }
        let passed = (time_s - tie.latest.0) * self.samples_per_s();
        let step = passed - (position - tie.latest.1);
        if step.abs() > break_samples {
            self.tie_anew(time_s, position);
            return Followed { sample: position, jumped: true, repaced: false };
        }
        tie.latest = (time_s, position);
        let lead = tie.sample + (time_s - tie.time_s) * self.samples_per_s() - position;
        tie.window.events += 1;
        tie.window.least = tie.window.least.min(time_s * self.samples_per_s() - position);
        tie.window.least_lead = tie.window.least_lead.min(lead);
        let mut jumped = false;
        let mut sample = lead + position;
        if lead > break_samples || -lead > LATE_S * self.sample_rate_hz {
            (tie.time_s, tie.sample, sample, jumped) = (time_s, position, position, true);
            tie.window.least_lead = 0.0;
        } else if lead >= 0.0 {
            let hurries = if tie.ahead { MAX_OVERSPEED * passed.max(0.0) } else { 0.0 };
            tie.sample -= lead.min(hurries.max(CREEP_SAMPLES + CREEP_SHARE * tie.least_lead));
        } else if -lead <= SLIGHTLY_LATE_S * self.sample_rate_hz {
            (tie.sample, sample) = (tie.sample - lead, position);
        } else {
            tie.sample -= FOLLOW * lead;
        }
        let mut repaced = false;
        if position - tie.window.began >= WINDOW_S * self.sample_rate_hz {
            self.look_back(&mut tie);
            repaced = self.weigh_pace(&mut tie, time_s, sample);
        }
        tie.latest_sample = sample;
        self.tied = Some(tie);
        Followed { sample, jumped, repaced }
    }

    /// Sample of a game time; none before the first.
    pub fn sample_at(&self, time_s: f64) -> Option<f64> {
        self.tied.as_ref().map(|tie| tie.sample + (time_s - tie.time_s) * self.samples_per_s())
    }

    fn samples_per_s(&self) -> f64 {
        self.sample_rate_hz / self.pace
    }

    /// Tests whether the next stamp holds at the next sample.
    pub fn is_untied(&self) -> bool {
        self.tied.is_none()
    }

    /// Ties game time `time_s` to a sample; what is known of the game's pace is forgotten, or not.
    pub fn tie(&mut self, time_s: f64, sample: f64, forget: bool) {
        match &mut self.tied {
            Some(tie) if !forget => {
                (tie.time_s, tie.sample, tie.latest_sample) = (time_s, sample, sample);
            }
            _ => self.tie_anew(time_s, sample),
        }
    }

    fn tie_anew(&mut self, time_s: f64, sample: f64) {
        self.tied = Some(Tie {
            time_s,
            sample,
            latest: (time_s, sample),
            latest_sample: sample,
            window: Window::at(sample),
            before: None,
            drift: None,
            least_lead: 0.0,
            ahead: false,
        });
    }

    /// At the end of a window: notes by how much a game is ahead.
    fn look_back(&self, tie: &mut Tie) {
        tie.least_lead = tie.window.least_lead.max(0.0);
        tie.ahead = tie.least_lead > self.max_lead;
    }

    /// At the end of a window: follows another pace, if two windows in a row agree about
    /// it. Whether they do.
    fn weigh_pace(&mut self, tie: &mut Tie, time_s: f64, sample: f64) -> bool {
        let now = tie.latest.1;
        let window = std::mem::replace(&mut tie.window, Window::at(now));
        if window.events < WINDOW_EVENTS {
            (tie.before, tie.drift) = (None, None);
            return false;
        }
        let this = (window.least, window.began);
        let Some((least, began)) = tie.before.replace(this) else { return false };
        let drift = (this.0 - least) / (this.1 - began);
        let Some(before) = tie.drift.replace(drift) else { return false };
        let enough = if self.pace == 1.0 { OTHER_PACE } else { CORRECTION };
        let agree = drift.abs() > enough && before.abs() > enough && drift * before > 0.0;
        // In units of the present pace the game runs at 1 + drift.
        let pace = self.pace * (1.0 + drift);
        if !agree || !(PACES.0..=PACES.1).contains(&pace) {
            return false;
        }
        self.pace = if (pace - 1.0).abs() < CORRECTION { 1.0 } else { pace };
        (tie.time_s, tie.sample) = (time_s, sample);
        (tie.before, tie.drift) = (None, None);
        true
    }
}
