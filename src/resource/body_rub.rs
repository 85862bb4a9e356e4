//! A rubbed body: one contact that sticks and slips on it, coupled with its modal bank in every
//! sample (`dsp::stick_slip`).
//!
//! The body's own bank gives, at the beginning of a cell of the absolute sample grid, how the
//! rubbed place will move by itself; a second bank of the same modes, which sounds as the speed of
//! that place, gives what strikes the body within the cell beside, and sleeps when nothing does.
//! From both follow the forces, which the body's bank then takes as it takes any other contact.
//! Speeds are designed for the place a few groups a cell, so that no cell has much to do: a contact
//! that begins rubs after [`SETTLE_CELLS`] cells at most, and one that slides is followed as fast.

use crate::model::strike_field::StrikePlace;
use crate::resource::bank::{Bank, ContactKey};
use crate::resource::body_field::BodyField;
use crate::resource::holding::HeldModes;
use crate::resource::slider::{self, Slider};
use crate::resource::strike_point::StrikePoint;
use asperity_dsp::DesignError;
use asperity_dsp::modal_bank::{
    FreeResponse, GroupOptions, GroupState, Input, Inputs, LANES, LaneGains, ModalBank, ModeGroup,
    design_group,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::Level;
use asperity_dsp::stick_slip::{Answer, CELL, Coupled, Friction, Sweep, place_speed};
use asperity_surface::height_field::MAX_BLOCK;

const _: () = assert!(CELL == MAX_BLOCK, "a stretch lies within one cell");

/// Cells within which all groups are designed for another place.
const SETTLE_CELLS: usize = 8;
/// A gain nearer than this to the one that a group was designed for is the same.
const SAME: f32 = 1e-4;
/// The speed's modes hear the taps of a force and undo them themselves.
const SPEED: GroupOptions =
    GroupOptions { impulse_kernel_compensation: false, true_t60: true, derivative: 0 };
/// Nothing rubs.
const STILL: Sweep = Sweep { sweep_m_s: 0.0, normal_force_n: 0.0, other_n_s: 0.0 };

/// Rubbing of a contact during a stretch.
pub(crate) struct FrictionInput<'a> {
    pub(crate) owner: ContactKey,
    /// Place, and direction along the body.
    pub(crate) spot: StrikePoint,
    pub(crate) friction: Friction,
    pub(crate) sweep_m_s: &'a [f64],
    pub(crate) normal_force_n: &'a [f64],
}

/// Progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Empty: nothing rubs.
    Idle,
    /// The speeds are being designed.
    Settling,
    Rubs,
}

/// The rubbed place of a body.
pub(crate) struct BodyRub {
    /// As they are at present, group by group.
    modes: Box<[HeldModes]>,
    /// Motion of each mode where its gain is 1, kg^−½.
    unit_per_sqrt_kg: Box<[f64]>,
    /// Gains at the strike positions of a body without shapes.
    positions: Box<[Box<[LaneGains]>]>,
    /// The speed of the rubbed place: of the body by itself, and because of what strikes it within
    /// a cell.
    ahead: Box<[FreeResponse]>,
    struck: Bank,
    /// The gains that each group of it was designed for, and whether its modes have changed since.
    designed: Box<[LaneGains]>,
    stale: Box<[bool]>,
    answers: Box<[Answer]>,
    /// Gains of the groups that are driven, and how many those are.
    answer: (Answer, usize),
    coupled: Coupled,
    slider: Slider,
    glide: f32,
    stage: Stage,
    owner: Option<ContactKey>,
    friction: Friction,
    sweep: [Sweep; CELL],
    /// True where it was asked during the present stretch; cells since it was asked last.
    asked: bool,
    silent_cells: u32,
    /// The group that is looked at next.
    next: usize,
    sample_rate_hz: f64,
}

impl BodyRub {
    /// For the modes of a bank in their order, the motion of each where its gain is 1, and the
    /// gains at each strike position.
    pub(crate) fn new(
        modes: &[Mode],
        unit_per_sqrt_kg: Box<[f64]>,
        positions: Box<[Box<[LaneGains]>]>,
        kernel: Level,
        sample_rate_hz: f64,
    ) -> Result<Self, DesignError> {
        let groups = modes.len().div_ceil(LANES);
        let held = modes.chunks(LANES).map(HeldModes::of).collect();
        // A design that passes on the game half is never refused on the audio half.
        for mode in modes {
            place_speed(mode, 1.0, sample_rate_hz)?;
        }
        let silent: Box<[ModeGroup]> = vec![ModeGroup::SILENT; groups].into();
        let states: Box<[GroupState]> = vec![GroupState::REST; groups].into();
        Ok(Self {
            modes: held,
            unit_per_sqrt_kg,
            positions,
            ahead: vec![FreeResponse::SILENT; groups].into(),
            struck: ModalBank::new(kernel, silent, states).sleeping_below(0.0),
            designed: vec![LaneGains([0.0; LANES]); groups].into(),
            stale: vec![true; groups].into(),
            answers: vec![Answer::RIGID; groups].into(),
            answer: (Answer::RIGID, 0),
            coupled: Coupled::begin(kernel),
            slider: Slider::new(groups),
            glide: slider::glide(sample_rate_hz),
            stage: Stage::Idle,
            owner: None,
            friction: Friction { mu_static: 0.0, mu_kinetic: 0.0, slip_speed_m_s: 1.0 },
            sweep: [STILL; CELL],
            asked: false,
            silent_cells: 0,
            next: 0,
            sample_rate_hz,
        })
    }

    /// A contact rubs during the present stretch; false where another one does.
    pub(crate) fn ask(&mut self, asked: &FrictionInput<'_>, field: Option<&BodyField>) -> bool {
        if self.owner.is_some_and(|owner| owner != asked.owner) {
            return false;
        }
        let place = asked.spot.place.unwrap_or(StrikePlace::NOWHERE);
        let positions = &self.positions;
        self.slider.be_at(asked.owner, &place, |gains| {
            if let Some(field) = field {
                field.fill(&place, gains);
            } else if let Some(at) = positions.get(asked.spot.position).or(positions.last()) {
                gains.copy_from_slice(at);
            }
        });
        if self.owner.is_none() {
            self.owner = Some(asked.owner);
            self.stage = Stage::Settling;
        }
        self.friction = asked.friction;
        self.asked = true;
        let now = asked.sweep_m_s.iter().zip(asked.normal_force_n);
        for (to, (sweep_m_s, normal_force_n)) in self.sweep.iter_mut().zip(now) {
            *to = Sweep { sweep_m_s: *sweep_m_s, normal_force_n: *normal_force_n, other_n_s: 0.0 };
        }
        true
    }

    /// Tests whether it has to be run.
    pub(crate) fn rubs(&self) -> bool {
        self.stage == Stage::Rubs
    }

    /// Tests whether there is a contact, if only one that begins.
    pub(crate) fn is_idle(&self) -> bool {
        self.stage == Stage::Idle
    }

    /// Drops the contact.
    pub(crate) fn silence(&mut self) {
        self.slider.silence();
        self.slider.owner = None;
        (self.owner, self.stage, self.asked) = (None, Stage::Idle, false);
    }

    /// The forces of the next `n` samples from what strikes the body beside them, while its first
    /// `driven` groups hear anything.
    pub(crate) fn run(&mut self, position: u64, n: usize, driven: usize, sound: &Bank, others: &[Input<'_>]) {
        let first = position as usize % CELL;
        if first == 0 {
            if self.answer.1 != driven {
                self.sum_answers(driven);
            }
            let mut free_m_s = [0.0; CELL];
            sound.ahead(&self.ahead, &mut free_m_s);
            self.coupled.next_cell(&self.answer.0, &free_m_s);
            if self.struck.active_groups() > 0 {
                self.struck.silence();
            }
        }
        let mut struck_m_s = [0.0; CELL];
        self.struck.render_leading(driven, position, Inputs::Placed(others), &mut struck_m_s[..n]);
        self.coupled.run(&self.friction, first, &self.sweep[..n], &struck_m_s[..n]);
        let mut impulse_n_s = [0.0; CELL];
        self.coupled.impulses(first, self.sample_rate_hz, &mut impulse_n_s[..n]);
        self.slider.add(&impulse_n_s[..n]);
        self.slider.gather(first, n);
    }

    /// Hands over the forces.
    pub(crate) fn inputs<'a>(&'a self, n: usize, mut add: impl FnMut(Input<'a>)) {
        self.slider.inputs(n, &mut add);
    }

    /// A group of the body has other modes from now on.
    pub(crate) fn retune(&mut self, group: usize, modes: HeldModes) {
        self.modes[group] = modes;
        self.stale[group] = true;
    }

    /// The stretch up to `position` has been rendered: at the end of a cell some groups are
    /// designed for where it is by now.
    pub(crate) fn end_stretch(&mut self, position: u64) {
        self.slider.end_stretch(position, self.glide);
        self.sweep = [STILL; CELL];
        if std::mem::take(&mut self.asked) {
            self.silent_cells = 0;
        }
        if !position.is_multiple_of(CELL as u64) || self.stage == Stage::Idle {
            return;
        }
        self.silent_cells += 1;
        // One cell more after the last, so that all of its force is heard.
        if self.silent_cells > 2 {
            return self.silence();
        }
        let settled = self.design_some();
        if self.stage == Stage::Settling && settled {
            (self.stage, self.coupled) = (Stage::Rubs, Coupled::begin(self.struck.level()));
        }
    }

    /// Designs the next groups that need it; whether none is left.
    fn design_some(&mut self) -> bool {
        let groups = self.answers.len();
        let most = groups.div_ceil(SETTLE_CELLS);
        let mut designed = 0;
        for _ in 0..groups {
            let group = self.next;
            if !self.is_designed(group) {
                if designed == most {
                    break;
                }
                self.design(group);
                designed += 1;
            }
            self.next = (group + 1) % groups;
        }
        if designed > 0 {
            self.sum_answers(self.answer.1.max(1));
        }
        (0..groups).all(|group| self.is_designed(group))
    }

    fn is_designed(&self, group: usize) -> bool {
        let now = &self.slider.gains()[group].0;
        let same = now.iter().zip(&self.designed[group].0).all(|(a, b)| (a - b).abs() <= SAME);
        same && !self.stale[group]
    }

    fn design(&mut self, group: usize) {
        let gains = self.slider.gains()[group];
        let HeldModes { modes, count } = self.modes[group];
        let units = self.unit_per_sqrt_kg.get(group * LANES..).unwrap_or_default();
        let (mut speeds, mut moves) = (modes, modes.map(|mode| (mode, 0.0)));
        for (lane, (mode, unit)) in modes[..count].iter().zip(units).enumerate() {
            let share = f64::from(gains.0[lane]);
            moves[lane].1 = share * share * unit * unit;
            // The input has the gain of its place already.
            let speed = place_speed(mode, share * unit * unit, self.sample_rate_hz);
            // Modes that could be designed once always can.
            let Ok(speed) = speed else { return };
            speeds[lane] = speed;
        }
        let (rate_hz, level, mut answer) = (self.sample_rate_hz, self.struck.level(), Answer::RIGID);
        let answers = answer.add_modes(level, &moves[..count], rate_hz);
        let struck = design_group(&speeds[..count], rate_hz, &SPEED);
        let ahead = FreeResponse::design(&speeds[..count], rate_hz);
        let (Ok(()), Ok(struck), Ok(ahead)) = (answers, struck, ahead) else { return };
        self.struck.retune(group, &struck);
        self.ahead[group] = ahead;
        self.answers[group] = answer;
        (self.designed[group], self.stale[group]) = (gains, false);
    }

    fn sum_answers(&mut self, driven: usize) {
        let mut sum = Answer::RIGID;
        self.answers.iter().take(driven).for_each(|answer| sum.add(answer));
        self.answer = (sum, driven);
    }
}
