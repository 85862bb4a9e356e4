//! `STUDY.toml`: what is asked, how often, and of which stimuli.

use crate::error::CliError;
use asperity::files::FileError;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Most trials of one thing.
const MOST_TRIALS: u32 = 1000;

/// Procedure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// One stimulus, one of several names.
    Identification,
    /// A, B, and X, which is one of them.
    Abx,
    /// Sliders from 0 to 100.
    Rating,
    /// Two intervals, three down and one up over levels.
    Staircase,
}

/// Channels that are played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Senses {
    /// Sound alone.
    #[default]
    Sound,
    /// The haptic channel alone.
    Touch,
    /// The two together.
    Both,
}

/// Part of a stimulus in a rating or a staircase.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Standard of the others; rated among them without its name.
    Reference,
    /// The one meant to be worst.
    Anchor,
}

/// A study.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Heading of the page.
    pub title: String,
    /// Procedure.
    pub protocol: Protocol,
    /// Times each stimulus, pair or set is asked; most trials of a staircase.
    pub trials: u32,
    /// Seed of the order.
    pub seed: u64,
    /// Channels that are played.
    #[serde(default)]
    pub senses: Senses,
    /// A screen on which every stimulus may be played before.
    #[serde(default = "yes")]
    pub training: bool,
    /// Checks of attention among the trials.
    #[serde(default)]
    pub attention: u32,
    /// Reversals that end a staircase.
    #[serde(default = "reversals")]
    pub reversals: u32,
    /// Text above the consent; paragraphs are parted by an empty line.
    #[serde(default)]
    pub consent: String,
    /// Text above the training.
    #[serde(default)]
    pub instructions: String,
    /// Question of a trial.
    #[serde(default)]
    pub question: String,
    /// Names to choose from; missing: those of the stimuli.
    #[serde(default)]
    pub labels: Vec<String>,
    /// Scales of a rating, a slider each.
    #[serde(default)]
    pub scales: Vec<String>,
    /// Stimuli; several of one name are takes of it.
    pub stimulus: Vec<Stimulus>,
}

/// A stimulus.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stimulus {
    /// Name in the answers.
    pub name: String,
    /// Scene to render.
    pub scene: Option<PathBuf>,
    /// Sound (or, where the study is of touch alone, haptic channel) as it is.
    pub wav: Option<PathBuf>,
    /// Haptic channel beside `wav`.
    pub haptic_wav: Option<PathBuf>,
    /// Picture beside it, or on the button of its label.
    pub picture: Option<PathBuf>,
    /// Right answer; missing: the name.
    pub label: Option<String>,
    /// Set whose stimuli are compared with each other.
    pub set: Option<String>,
    /// Part in its set.
    pub role: Option<Role>,
    /// Level of a staircase, in any unit.
    pub level: Option<f64>,
}

fn yes() -> bool {
    true
}

fn reversals() -> u32 {
    12
}

impl Study {
    /// Reads and checks a study; paths in it become relative to the working folder.
    ///
    /// # Errors
    /// When it cannot be read, or what it asks cannot be asked.
    pub fn load(path: &Path) -> Result<Self, CliError> {
        let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
        let right = "write title, protocol, trials, seed and [[stimulus]] tables";
        let mut study: Self = toml::from_str(&text)
            .map_err(|error| CliError::from(FileError::toml(&text, &error, right)).within(path.display()))?;
        study.check().map_err(|error| error.within(path.display()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        for stimulus in &mut study.stimulus {
            let files =
                [&mut stimulus.scene, &mut stimulus.wav, &mut stimulus.haptic_wav, &mut stimulus.picture];
            files.into_iter().flatten().for_each(|file| *file = folder.join(&*file));
        }
        study.complete();
        Ok(study)
    }

    /// Names in order, each once.
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for stimulus in &self.stimulus {
            if !names.contains(&&*stimulus.name) {
                names.push(&stimulus.name);
            }
        }
        names
    }

    fn check(&self) -> Result<(), CliError> {
        let refuse = |at: &str, what: &str, right: &str| Err(CliError::new(at, what, right));
        if !(1..=MOST_TRIALS).contains(&self.trials) {
            return refuse("trials", &format!("is {}", self.trials), "must be 1 to 1000");
        }
        if self.names().len() < 2 && self.protocol != Protocol::Rating {
            return refuse("stimulus", "is one thing only", "write [[stimulus]] tables of two names or more");
        }
        for stimulus in &self.stimulus {
            let at = format!("stimulus {:?}", stimulus.name);
            if stimulus.name.is_empty() || stimulus.scene.is_some() == stimulus.wav.is_some() {
                return refuse(
                    &at,
                    "has no sound of its own, or two",
                    "must have a name, and a scene or a wav",
                );
            }
            if stimulus.haptic_wav.is_some() && stimulus.scene.is_some() {
                return refuse(&format!("{at}: haptic_wav"), "stands beside a scene", "goes with wav alone");
            }
            let label = stimulus.label.as_ref().unwrap_or(&stimulus.name);
            if self.protocol == Protocol::Identification
                && !self.labels.is_empty()
                && !self.labels.contains(label)
            {
                return refuse(
                    &at,
                    &format!("{label:?} is none of the labels"),
                    "add it to labels, or write label",
                );
            }
        }
        match self.protocol {
            Protocol::Rating if self.scales.is_empty() => {
                refuse("scales", "is missing", "write scales = [\"realism\"], a slider each")
            }
            Protocol::Staircase => self.check_levels(),
            _ => Ok(()),
        }
    }

    fn check_levels(&self) -> Result<(), CliError> {
        for set in self.sets() {
            let of_set = self.stimulus.iter().filter(|stimulus| stimulus.set == set);
            let (reference, rest): (Vec<_>, Vec<_>) =
                of_set.partition(|one| one.role == Some(Role::Reference));
            let is_level = |one: &&Stimulus| one.level.is_some_and(f64::is_finite);
            if reference.len() != 1 || rest.len() < 3 || !rest.iter().all(is_level) {
                let right = "must have one stimulus of role \"reference\" and three or more with a level";
                let what = "is no ladder of levels";
                return Err(CliError::new(
                    format!("stimulus set {:?}", set.unwrap_or_default()),
                    what,
                    right,
                ));
            }
        }
        Ok(())
    }

    fn sets(&self) -> Vec<Option<String>> {
        let mut sets: Vec<Option<String>> =
            self.stimulus.iter().map(|stimulus| stimulus.set.clone()).collect();
        sets.sort();
        sets.dedup();
        sets
    }

    /// Fills in the texts that are missing.
    fn complete(&mut self) {
        let question = match self.protocol {
            Protocol::Identification => "Which was it?",
            Protocol::Abx => "Which of the two is X?",
            Protocol::Rating => "How much, from 0 to 100?",
            Protocol::Staircase => "Which of the two is stronger?",
        };
        let consent =
            "This is a test of sounds and vibrations. Nothing is saved but your answers and their times.";
        let instructions = "Listen with headphones; rest whenever you like.";
        for (text, default) in [
            (&mut self.question, question),
            (&mut self.consent, consent),
            (&mut self.instructions, instructions),
        ] {
            if text.is_empty() {
                default.clone_into(text);
            }
        }
    }
}
