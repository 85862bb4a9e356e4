//! The last moments before a contact: on its way through the air a pad is not felt yet.

use super::{PadSample, Voice};

impl Voice {
    /// Until it touches, a pad that comes down is as far as the surface: nothing is felt of its way through the air.
    pub(super) fn feel_no_air(&mut self, rows: &mut [PadSample]) {
        for row in rows {
            if row.onset.is_some() || row.pad_m < row.height_m {
                self.landing_m_s = 0.0;
                return;
            }
            row.finger_m -= row.pad_m - row.height_m;
            (row.pad_m, row.pad_velocity_m_s) = (row.height_m, -self.landing_m_s);
        }
    }
}
