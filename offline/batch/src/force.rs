//! Force: the rows of `STEM.force.csv` of one stroke, with the path at the same instants.
//!
//! | column | content |
//! |---|---|
//! | `time_s` | time of the row |
//! | `x_n`, `y_n`, `z_n` | force on the finger along u, along v and out of the surface, band-limited to the rate, as `render --force` has it |
//! | `u`, `v` | where the finger is, of the sample nearest to the row, as `render --trace` has it |
//! | `sliding_m_s` | how fast it slides |
//! | `normal_force_n` | how hard it is pressed |

use asperity::live::ports::{ForceRows, Of};
use asperity::{ContactBlock, Tap};

/// Columns, in order.
pub const COLUMNS: [&str; 8] = ["time_s", "x_n", "y_n", "z_n", "u", "v", "sliding_m_s", "normal_force_n"];
/// Contacts that are watched at once: a record has one.
const CONTACTS: usize = 1;

/// Rows, a column each.
pub type ForceTable = [Vec<f64>; COLUMNS.len()];

/// Watches the contact of a stroke.
#[derive(Debug)]
pub struct ForceWatch {
    rate_hz: f64,
    samples_a_row: f64,
    rows: ForceRows,
    /// Number of the next row whose path is noted.
    next: u64,
    /// Number of a row, and where the finger is.
    path: Vec<(u64, [f64; 4])>,
    forces: Vec<(u64, [f64; 3])>,
}

impl ForceWatch {
    /// Rows at a rate.
    #[must_use]
    pub fn new(rate_hz: f64, sample_rate_hz: f64) -> Self {
        Self {
            rate_hz,
            samples_a_row: sample_rate_hz / rate_hz,
            rows: ForceRows::new(rate_hz, sample_rate_hz, CONTACTS),
            next: 0,
            path: Vec::new(),
            forces: Vec::new(),
        }
    }

    /// The rows of the whole stroke.
    #[must_use]
    pub fn finish(mut self) -> ForceTable {
        self.close(u64::MAX);
        let mut table = ForceTable::default();
        let mut path = self.path.iter().peekable();
        for (row, force_n) in &self.forces {
            while path.peek().is_some_and(|(at, _)| at < row) {
                path.next();
            }
            let Some((_, here)) = path.peek().filter(|(at, _)| at == row) else { continue };
            let values = [*row as f64 / self.rate_hz].into_iter().chain(*force_n).chain(*here);
            table.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
        table
    }

    fn close(&mut self, before: u64) {
        let Self { rows, forces, .. } = self;
        rows.close(before, |row| {
            if matches!(row.of, Of::Contact(_)) {
                forces.push((row.tick, row.force_n));
            }
        });
    }
}

impl Tap for ForceWatch {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.close(block.first_sample);
        self.rows.add(block);
        let samples = block.contact_samples.len();
        loop {
            let sample = (self.next as f64 * self.samples_a_row).round() as u64;
            if sample >= block.first_sample + samples as u64 {
                return;
            }
            if sample >= block.first_sample {
                let index = (sample - block.first_sample) as usize;
                let [u, v] = block.uv[index];
                let [along, across] = block.velocity_m_s[index];
                let pressed_n = block.contact_samples[index].normal_force_n;
                self.path.push((self.next, [u, v, along.hypot(across), pressed_n]));
            }
            self.next += 1;
        }
    }
}
