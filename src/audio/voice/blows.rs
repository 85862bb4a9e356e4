//! Blows: a probe that is heavy or stiff leaves the ground at its crests and comes down with v √(k
//! m), whatever presses it.
//!
//! They are rendered as physics has them, and counted, because who reports a light touch does not
//! expect them.

use super::PadSample;

/// A contact force so many times what presses is a blow. Fingertips reach 13 on ordinary ribs.
const BLOW: f64 = 30.0;
/// Less than this is nobody's touch, N: it stands for a contact that fades.
const LIGHTEST_N: f64 = 0.01;

/// The blows of one contact.
#[derive(Default)]
pub(super) struct Blows {
    /// True where one was under way at the last row.
    strikes: bool,
}

impl Blows {
    /// Number of blows that begin in these rows.
    pub(super) fn count(&mut self, rows: &[PadSample]) -> u64 {
        let mut begun = 0;
        for row in rows {
            let strikes = row.contact_force_n > BLOW * row.normal_force_n.max(LIGHTEST_N);
            begun += u64::from(strikes && !self.strikes);
            self.strikes = strikes;
        }
        begun
    }
}
