//! Quiet: gains, mute, pause, slow motion, and an end to everything.

use super::Scene;
use crate::files::contact_log::LogEdit;
use crate::link::message::Message;
use crate::model::bad_value::within;
use crate::model::bus::BusId;
use crate::model::error::AddError;
use crate::model::event::ChannelId;
use crate::model::id::BodyId;
use asperity_dsp::limits;

impl Scene {
    /// Sets the user's gain of one haptic channel, 0 = mute; it is reached within a few
    /// milliseconds.
    ///
    /// # Errors
    /// When there is no such channel, the gain is not in 0–10, or the queue is full.
    pub fn set_haptic_gain(&mut self, actuator: ChannelId, gain: f64) -> Result<(), AddError> {
        let channel = usize::from(actuator.0);
        if channel >= self.config.actuators.len() {
            return Err(AddError::Unknown("actuator"));
        }
        let gain = within("gain", gain, limits::output::HAPTIC_GAIN)?;
        self.send(Message::SetHapticGain { channel, gain })?;
        self.note(|_| LogEdit::HapticGain { actuator: actuator.0, gain });
        Ok(())
    }

    /// Sets the gain of one audio bus, linear; it is reached within a few milliseconds.
    ///
    /// # Errors
    /// When there is no such bus, the gain is not in 0–1e6, or the queue is full.
    pub fn set_audio_gain(&mut self, bus: BusId, gain: f64) -> Result<(), AddError> {
        let bus = self.checked_bus(bus.0)?;
        let gain = within("gain", gain, limits::output::AUDIO_GAIN)?;
        self.send(Message::SetAudioGain { bus, gain })?;
        self.config.audio[bus].gain = gain;
        // How loud it is decides which modes are left out first.
        self.rested.clear();
        self.note(|_| LogEdit::AudioGain { bus, gain });
        Ok(())
    }

    /// A body is louder or softer from now on, linear, without a step.
    ///
    /// # Errors
    /// When the body is not in this scene, the gain is not in 0–1000, or the queue is full.
    pub fn set_body_gain(&mut self, id: BodyId, gain: f64) -> Result<(), AddError> {
        self.known_body(id)?;
        let gain = within("gain", gain, limits::impact::GAIN)?;
        self.send(Message::SetBodyGain { slot: id.index(), gain })?;
        if let Some(given) = self.given.get_mut(&id) {
            given.gain = gain;
        }
        self.note(|names| LogEdit::BodyGain { body: names.body(id), gain });
        Ok(())
    }

    /// All that is felt and heard fades within 20 ms, or comes back; everything goes on meanwhile.
    ///
    /// # Errors
    /// When the queue is full.
    pub fn set_muted(&mut self, muted: bool) -> Result<(), AddError> {
        self.send(Message::Mute(muted))?;
        self.note(|_| LogEdit::Mute { muted });
        Ok(())
    }

    /// The game stands still: all that is felt and heard fades within 20 ms, bodies ring out
    /// unheard, and contacts wait, however long, without lapsing. Impacts that wait for their time
    /// are dropped.
    ///
    /// # Errors
    /// When the queue is full.
    pub fn pause(&mut self) -> Result<(), AddError> {
        self.set_paused(true)
    }

    /// The game goes on: a contact comes back where its next report says. With an exact clock the
    /// next report holds at the sample that is rendered next, as after a [`reset`](Self::reset).
    ///
    /// # Errors
    /// When the queue is full.
    pub fn resume(&mut self) -> Result<(), AddError> {
        self.set_paused(false)?;
        self.reset()
    }

    /// Every contact ends, and whatever rings is damped within a tenth of a second: for a cut, a
    /// menu, the end of a level. What is reported afterwards begins anew; moves of contacts that
    /// have ended so are counted as orphaned, and impacts that wait for their time are dropped.
    ///
    /// # Errors
    /// When the queue is full.
    pub fn fade_all(&mut self) -> Result<(), AddError> {
        self.held.clear();
        self.send(Message::FadeAll)?;
        self.drop_strikes();
        self.note(|_| LogEdit::FadeAll);
        Ok(())
    }

    /// Stands still or goes on; the clock stays as it is.
    pub(crate) fn set_paused(&mut self, paused: bool) -> Result<(), AddError> {
        self.send(Message::Pause(paused))?;
        if paused {
            self.drop_strikes();
        }
        self.note(|_| LogEdit::Pause { paused });
        Ok(())
    }

    /// Slow motion or fast: so many game seconds a second of audio, from the last report on. It is
    /// for the exact clock; a live one finds the pace by itself. Contacts move slower by as much;
    /// forces and blows stay what they are.
    ///
    /// With `bend_pitch` all that leaves is a tape that runs at that speed: a bell that rings at
    /// 800 Hz rings at 400 Hz, twice as long, at scale 0.5, and so does what is felt. Ports go on
    /// in the game's time. It is for both clocks.
    ///
    /// # Errors
    /// When the scale is not in 0.01–100, with `bend_pitch` not in 0.1–2, or the queue is full.
    pub fn set_time_scale(&mut self, scale: f64, bend_pitch: bool) -> Result<(), AddError> {
        self.scale_time(self.last_time_s.max(0.0), scale, bend_pitch)
    }

    /// [`set_time_scale`](Self::set_time_scale) from a game time on.
    pub(crate) fn scale_time(&mut self, since_s: f64, scale: f64, bend_pitch: bool) -> Result<(), AddError> {
        let range = if bend_pitch { limits::BENT_TIME_SCALE } else { limits::TIME_SCALE };
        let scale = within("time_scale", scale, range)?;
        let (pace, pitch) = if bend_pitch { (1.0, scale) } else { (scale, 1.0) };
        if pitch != self.pitch {
            self.set_pitch(pitch)?;
        }
        self.clock.set_pace(pace, since_s);
        Ok(())
    }

    /// Speed and pitch of all that leaves.
    pub(crate) fn set_pitch(&mut self, pitch: f64) -> Result<(), AddError> {
        let pitch = within("pitch", pitch, limits::BENT_TIME_SCALE)?;
        self.send(Message::SetPitch(pitch))?;
        self.pitch = pitch;
        self.note(|_| LogEdit::Pitch { pitch });
        Ok(())
    }
}
