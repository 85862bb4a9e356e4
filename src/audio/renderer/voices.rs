//! The contacts of a stretch: each voice is rendered, then what it does is added up in the order of the voices.

use super::Renderer;
use super::outputs::HapticChannel;
use crate::audio::body_seat::BodySeat;
use crate::audio::seat::Seat;
use crate::audio::voice::{Phase, Scratch, Shared, Stretch, Voice, VoiceBlock};
use crate::link::stats::Counters;
use crate::link::tap::Tap;
use crate::model::strike_field::StrikePlace;
use crate::model::surface::Surface;
use crate::prepared::body_rub::RubAsked;
use crate::prepared::spot::Spot;
use asperity_dsp::actuator::ContactOutput;
use asperity_dsp::micro_contact::Probe;
use asperity_texture::height_field::MAX_BLOCK;

/// The samples at hand, for whoever renders voices.
#[derive(Clone, Copy)]
pub(super) struct At {
    /// Absolute index of the first sample.
    pub(super) position: u64,
    /// How many.
    pub(super) n: usize,
}

impl At {
    fn is_on_grid(self) -> bool {
        self.position.is_multiple_of(MAX_BLOCK as u64)
    }

    /// Renders a voice into `scratch.out`; what presses on the touched body, at the steps of the absolute grid.
    pub(super) fn render<T: Tap>(
        self,
        shared: &Shared,
        output: &ContactOutput,
        voice: &mut Voice,
        seat: &mut Seat,
        scratch: &mut Scratch,
        tap: &mut T,
    ) -> Option<Probe> {
        let stretch = Stretch { shared, output, position: self.position, n: self.n };
        // Before it is rendered: how it presses at the end of a stretch would depend on where the blocks are cut.
        let on_grid = self.is_on_grid();
        let pressing = seat.current().filter(|_| on_grid).and_then(|slot| voice.pressing(shared, slot));
        voice.render(stretch, seat, scratch, tap);
        pressing
    }
}

/// Where the voices' outputs go, and what was counted.
struct Gathering<'a> {
    at: At,
    channels: &'a mut [HapticChannel],
    bodies: &'a mut [BodySeat],
    placed: &'a [Option<StrikePlace>],
    collisions: u64,
    shortened: u64,
    resets: u64,
    blows: u64,
    crowded: u64,
}

impl Gathering<'_> {
    /// Adds one voice's stretch to its channel and sends the rest to the bodies.
    fn add(&mut self, index: usize, voice: &Voice, seat: &Seat, pressing: Option<Probe>, out: &VoiceBlock) {
        let n = self.at.n;
        self.collisions += out.collisions;
        self.shortened += out.shortened;
        self.resets += out.resets;
        self.blows += out.blows;
        if let Some(channel) = voice.role.actuator {
            for (sum, x) in self.channels[channel].sum[..n].iter_mut().zip(&out.haptic) {
                *sum += x;
            }
        }
        let owner = (index, voice.begun);
        let touched = seat.current().and_then(|slot| Some((slot.surface.body?, slot)));
        if let (Some((body, _)), Some(place), Some(probe)) = (touched, self.placed[index], pressing) {
            self.bodies[body.index()].press(body, owner, &place, &probe);
        }
        if let (true, Some((body, slot))) = (out.rub.rubs, touched)
            && let Some(friction) = slot.surface.rubs()
        {
            let asked = RubAsked {
                owner,
                spot: rubbed(&slot.surface, self.placed[index], out.rub.along),
                friction,
                sweep_m_s: &out.rub.sweep_m_s[..n],
                normal_force_n: &out.rub.normal_force_n[..n],
            };
            let left_out = !self.bodies[body.index()].rub(body, &asked);
            self.crowded += u64::from(left_out && self.at.is_on_grid());
        }
        if !out.excites {
            return;
        }
        if let Some(holder) = voice.role.holder {
            self.bodies[holder.index()].touch(holder, 0, out.sent(n), -1.0);
        }
        if let Some((body, slot)) = touched {
            let spot = Spot { place: self.placed[index], position: slot.surface.strike_position };
            self.bodies[body.index()].touch_at(body, owner, &spot, out.sent(n));
        }
    }

    fn count(&self, counters: &Counters) {
        Counters::add(&counters.micro_collisions, self.collisions);
        Counters::add(&counters.shortened_collisions, self.shortened);
        Counters::add(&counters.quarantined, self.resets);
        Counters::add(&counters.blows, self.blows);
        Counters::add(&counters.rubs_crowded_out, self.crowded);
    }
}

impl Renderer {
    pub(super) fn render_contacts<T: Tap>(&mut self, n: usize, tap: &mut T) {
        for channel in &mut self.channels {
            channel.sum[..n].fill(0.0);
        }
        let tap = &mut self.outlets.beside(tap);
        let at = At { position: self.position, n };
        // A tap is not shared: it is shown one contact after the other.
        if !tap.is_watching()
            && let Some(crew) = &mut self.crew
        {
            crew.render_contacts(
                at,
                &self.shared,
                (&mut self.voices, &self.voices_used),
                &mut self.seats,
                &self.channels,
                &mut self.scratch,
            );
        }
        let mut gathering = Gathering {
            at,
            channels: &mut self.channels,
            bodies: &mut self.bodies,
            placed: &self.placed,
            collisions: 0,
            shortened: 0,
            resets: 0,
            blows: 0,
            crowded: 0,
        };
        for index in self.voices_used.iter() {
            let done = self.crew.as_mut().and_then(|crew| crew.take_voice(index));
            let voice = &mut self.voices[index];
            let seat = &mut self.seats[voice.surface];
            if let Some(share) = done {
                gathering.add(index, voice, seat, share.pressing, &share.out);
                if let Some(crew) = &mut self.crew {
                    crew.put_back(share);
                }
                continue;
            }
            if voice.phase == Phase::Free {
                continue;
            }
            let channel = voice.role.actuator.map(|channel| &gathering.channels[channel]);
            let output = channel.map_or(&self.shared.idle_output, |channel| &channel.output);
            let pressing = at.render(&self.shared, output, voice, seat, &mut self.scratch, tap);
            gathering.add(index, voice, seat, pressing, &self.scratch.out);
        }
        gathering.count(&self.counters);
        let channels = &mut self.channels;
        self.blows.render(&self.shared, self.position, n, |channel, output, moves| {
            let HapticChannel { output: design, sum, .. } = &mut channels[channel];
            for (sum, [pad_m, pad_m_s]) in sum.iter_mut().zip(moves) {
                *sum += output.tick(design, *pad_m, *pad_m_s);
            }
        });
    }
}

/// Where a contact rubs, and along what of the body.
fn rubbed(surface: &Surface, place: Option<StrikePlace>, [u, v]: [f64; 2]) -> Spot {
    let place = place.zip(surface.frame).map(|(place, frame)| {
        let [along_u, along_v] = frame.axes();
        let direction = std::array::from_fn(|i| (u * along_u[i] + v * along_v[i]) as f32);
        StrikePlace { direction, ..place }
    });
    Spot { place, position: surface.strike_position }
}
