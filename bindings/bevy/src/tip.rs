//! Tracked tips: the place of a fingertip that a tracker knows becomes touch.

use crate::event::TouchEvent;
use crate::touch::Touch;
use asperity::{Tip, TipCoupling, TipStep};
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time};

/// The entity is a tracked fingertip, one a finger. Once a fixed step it presses and strokes the
/// surfaces that it is over: a proxy stays on them, on a spring ([`Tip`]). A
/// [`TouchProbe`](crate::TouchProbe) beside it says with what it touches and who feels it.
#[derive(Component, Debug, Clone)]
pub struct TouchTip {
    /// Position in the axes of the surfaces' frames, m; none = it is not tracked, and lifts.
    pub position_m: Option<[f64; 3]>,
    surfaces: Vec<Entity>,
    coupling: TipCoupling,
    tip: Option<Tip>,
    /// Sentence that was told last.
    refused: String,
}

impl TouchTip {
    /// A tip over the surfaces of these entities, each with a frame
    /// ([`Surface::frame`](asperity::Surface::frame)), all in the same axes.
    #[must_use]
    pub fn over(surfaces: impl IntoIterator<Item = Entity>) -> Self {
        Self {
            position_m: None,
            surfaces: surfaces.into_iter().collect(),
            coupling: TipCoupling::default(),
            tip: None,
            refused: String::new(),
        }
    }

    /// With another spring, mass or bound of force.
    #[must_use]
    pub fn coupled(mut self, coupling: TipCoupling) -> Self {
        self.coupling = coupling;
        self
    }

    fn step(&mut self, dt_s: f64, toucher: Entity, touch: &mut Touch) -> Result<Option<TouchEvent>, String> {
        let Some(position_m) = self.position_m else {
            let step = self.tip.as_mut().map(Tip::lift);
            return Ok(step.filter(|step| *step != TipStep::Free).map(|_| TouchEvent::End { toucher }));
        };
        let known = self.surfaces.iter().filter_map(|entity| Some((*entity, touch.surface(*entity)?)));
        let (entities, ids): (Vec<_>, Vec<_>) = known.unzip();
        let rectangles = touch.scene().tip_surfaces(&ids).map_err(|error| error.to_string())?;
        // Surfaces that came, went or moved: what was touched ends.
        if self.tip.as_ref().is_none_or(|tip| tip.surfaces() != rectangles) {
            let made = Tip::new(rectangles, self.coupling).map_err(|error| error.to_string())?;
            if self.tip.replace(made).is_some() {
                return Ok(Some(TouchEvent::End { toucher }));
            }
        }
        let step = self.tip.as_mut().map(|tip| tip.step(dt_s, position_m)).transpose();
        Ok(match step.map_err(|error| error.to_string())? {
            Some(TipStep::Begin(at, sample)) => {
                Some(TouchEvent::Begin { toucher, surface: entities[at], sample })
            }
            Some(TipStep::Move(_, sample)) => Some(TouchEvent::Move { toucher, sample }),
            Some(TipStep::End(_)) => Some(TouchEvent::End { toucher }),
            Some(TipStep::Free) | None => None,
        })
    }
}

/// Before the step's messages are reported.
pub(crate) fn follow(
    mut tips: Query<(Entity, &mut TouchTip)>,
    time: Res<Time<Fixed>>,
    touch: Option<ResMut<Touch>>,
    mut out: MessageWriter<TouchEvent>,
) {
    let Some(mut touch) = touch else { return };
    for (toucher, mut tip) in &mut tips {
        match tip.step(time.delta_secs_f64(), toucher, &mut touch) {
            Ok(event) => {
                out.write_batch(event);
            }
            Err(why) if why != tip.refused => {
                touch.refused(toucher, &why);
                tip.refused = why;
            }
            Err(_) => {}
        }
    }
}
