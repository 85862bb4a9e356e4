//! The contacts of a stretch: each voice is rendered, then what it does is added up in the order of
//! the voices.

use super::Renderer;
use super::outputs::HapticChannel;
use super::render_pool::RenderPool;
use crate::audio::body_seat::BodySeat;
use crate::audio::index_set::IndexSet;
use crate::audio::seat::Seat;
use crate::audio::shared::{SampleRange, Segment, Shared};
use crate::audio::voice::{Scratch, Voice, VoiceBlock, VoiceState};
use crate::link::stats::{Counters, Counts};
use crate::link::tap::Tap;
use crate::model::strike_field::StrikePlace;
use crate::model::surface::Surface;
use crate::resource::body::RenderArgs;
use crate::resource::body_rub::FrictionInput;
use crate::resource::strike_point::StrikePoint;
use asperity_dsp::actuator::ContactOutput;
use asperity_dsp::micro_contact::Probe;

/// Destination of the voices' outputs, and the counts.
struct Gathering<'a> {
    at: SampleRange,
    channels: &'a mut [HapticChannel],
    bodies: &'a mut [BodySeat],
    placed: &'a [Option<StrikePlace>],
    counts: Counts,
    crowded: u64,
}

impl Gathering<'_> {
    /// Adds one voice's stretch to its channel and sends the rest to the bodies.
    fn add(&mut self, index: usize, voice: &Voice, seat: &Seat, pressing: Option<Probe>, out: &VoiceBlock) {
        let n = self.at.n;
        self.counts += out.counts;
        if let Some(channel) = voice.role.actuator {
            self.channels[channel].add(&out.haptic[..n]);
        }
        let owner = (index, voice.begun);
        let touched = seat.current().and_then(|slot| Some((slot.surface.body?, slot)));
        if let (Some((body, _)), Some(place), Some(probe)) = (touched, self.placed[index], pressing) {
            self.bodies[body.index()].press(body, owner, &place, &probe);
        }
        if let (true, Some((body, slot))) = (out.rub.rubs, touched)
            && let Some(friction) = slot.surface.rubs()
        {
            let asked = FrictionInput {
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
            self.bodies[holder.index()].touch(holder, 0, &out.impulse_n_s[..n], -1.0);
        }
        if let Some((body, slot)) = touched {
            let spot = StrikePoint::new(self.placed[index], slot.surface.strike_position);
            self.bodies[body.index()].touch_at(body, owner, &spot, &out.impulse_n_s[..n]);
        }
    }

    /// Adds what a pool has rendered. By itself, as what follows: what one contact alone does not
    /// need costs it nothing.
    #[inline(never)]
    fn gather(
        &mut self,
        pool: &mut RenderPool,
        args: RenderArgs,
        (voices, used): (&mut [Box<Voice>], &IndexSet),
        seats: &mut [Seat],
        scratch: &mut Box<Scratch>,
    ) {
        let n = self.at.n;
        for index in used.iter() {
            let Some(share) = pool.take_voice(index, voices, seats, scratch) else { continue };
            let voice = &voices[index];
            let seat = &seats[voice.surface];
            self.add(index, voice, seat, share.pressing, &share.out);
            pool.leave_bodies(index, (voice, seat), (args, n), self.bodies);
            pool.put_back(share);
        }
    }

    fn count(&self, counters: &Counters) {
        counters.count(self.counts);
        Counters::add(&counters.rubs_crowded_out, self.crowded);
    }
}

impl Renderer {
    pub(super) fn render_contacts(&mut self, n: usize, tap: &mut dyn Tap) {
        let args = self.body_args(self.position);
        let tap = &mut self.outlets.beside(tap);
        let at = SampleRange { position: self.position, n };
        let watched = tap.is_watching();
        // A tap is not shared: it is shown one contact after the other.
        let pool = self.pool.as_mut().filter(|_| !watched).and_then(|pool| {
            let voices = (&mut self.voices[..], &self.voices_used);
            let shared_out = pool.send_contacts(at, &self.shared, voices, &mut self.seats, &self.channels);
            shared_out.then_some(pool)
        });
        let mut gathering = Gathering {
            at,
            channels: &mut self.channels,
            bodies: &mut self.bodies,
            placed: &self.placed,
            counts: Counts::default(),
            crowded: 0,
        };
        let shared = &*self.shared;
        if let Some(pool) = pool {
            pool.send_bodies(args, n, gathering.bodies, &self.bodies_used);
            let voices = (&mut self.voices[..], &self.voices_used);
            gathering.gather(pool, args, voices, &mut self.seats, &mut self.scratch);
        } else {
            for index in self.voices_used.iter() {
                let voice = &mut self.voices[index];
                if voice.phase == VoiceState::Free {
                    continue;
                }
                let seat = &mut self.seats[voice.surface];
                let output = output(voice, gathering.channels, shared);
                let stretch = Segment { shared, output, position: at.position, n };
                let pressing = voice.render(stretch, seat, &mut self.scratch, tap);
                gathering.add(index, voice, seat, pressing, &self.scratch.out);
            }
        }
        gathering.count(&self.counters);
        let channels = &mut self.channels;
        self.blows.render(&self.shared, self.position, n, |channel, output, moves| {
            let (sum, design) = channels[channel].begun(n);
            for (sum, blow) in sum.iter_mut().zip(moves) {
                *sum += blow.felt(design, output);
            }
        });
    }
}

/// Output of the contact's actuator.
fn output<'a>(voice: &Voice, channels: &'a [HapticChannel], shared: &'a Shared) -> &'a ContactOutput {
    voice.role.actuator.map_or(&shared.idle_output, |channel| &channels[channel].output)
}

/// Place at which a contact rubs, and the direction along the body.
fn rubbed(surface: &Surface, place: Option<StrikePlace>, [u, v]: [f64; 2]) -> StrikePoint {
    let place = place.zip(surface.frame).map(|(place, frame)| {
        let [along_u, along_v] = frame.axes();
        let direction = std::array::from_fn(|i| (u * along_u[i] + v * along_v[i]) as f32);
        StrikePlace { direction, ..place }
    });
    StrikePoint::new(place, surface.strike_position)
}
