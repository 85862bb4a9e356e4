//! Watches every contact of a render: trace and force tables, and the curves of the picture.

use super::picture::{ContactCurve, DRAWN_CONTACTS};
use crate::csv::CsvWriter;
use crate::progress::Progress;
use asperity::live::ports::{ForceRows, Of};
use asperity::{ContactBlock, ContactId, Tap};
use std::fs::File;
use std::io::{self, BufWriter};
use std::time::{Duration, Instant};

/// Columns of `STEM.trace.csv`.
const TRACE_HEADER: &str =
    "time_s,contact,u,v,height_m,normal_force_n,pad_m,pad_velocity_m_s,finger_m,contact_force_n,impulse_n_s";
/// Columns of `STEM.force.csv`.
const FORCE_HEADER: &str = "time_s,contact,x_n,y_n,z_n";
/// The picture keeps the strongest impulse of so many a second and contact.
const IMPULSE_RATE_HZ: f64 = 2_000.0;

/// The picture keeps the place of every so many samples.
const PATH_EVERY: u64 = 256;

type Table = CsvWriter<BufWriter<File>>;

/// Data that a render keeps besides its samples.
pub struct Recorder {
    sample_rate_hz: f64,
    trace: Option<Trace>,
    force: Option<Force>,
    curves: Option<Vec<(ContactId, ContactCurve)>>,
    progress: Option<Progress>,
    position: u64,
    failure: Option<io::Error>,
    spent: Duration,
}

impl Recorder {
    /// Keeps nothing yet.
    pub fn new(sample_rate_hz: f64) -> Self {
        Self {
            sample_rate_hz,
            trace: None,
            force: None,
            curves: None,
            progress: None,
            position: 0,
            failure: None,
            spent: Duration::ZERO,
        }
    }

    /// Writes the trace.
    pub fn trace(&mut self, file: BufWriter<File>) -> io::Result<()> {
        self.trace = Some(Trace { table: CsvWriter::new(file, TRACE_HEADER)?, rows: Vec::new(), end: 0 });
        Ok(())
    }

    /// Writes the forces, `rate_hz` rows a second and contact.
    pub fn force(&mut self, file: BufWriter<File>, rate_hz: f64) -> io::Result<()> {
        let rows = ForceRows::new(rate_hz, self.sample_rate_hz, 64);
        self.force = Some(Force { table: CsvWriter::new(file, FORCE_HEADER)?, rate_hz, rows });
        Ok(())
    }

    /// Keeps the curves of the picture.
    pub fn curves(&mut self) {
        self.curves = Some(Vec::new());
    }

    /// Shows how far the render is.
    pub fn progress(&mut self, total_samples: u64) {
        self.progress = Some(Progress::new("rendering", total_samples));
    }

    /// Ends the tables. Returns the curves, and the time that watching took.
    pub fn finish(mut self) -> io::Result<(Vec<(ContactId, ContactCurve)>, Duration)> {
        if let Some(error) = self.failure.take() {
            return Err(error);
        }
        if let Some(mut trace) = self.trace.take() {
            trace.write_rows(self.sample_rate_hz)?;
            trace.table.finish()?;
        }
        if let Some(mut force) = self.force.take() {
            force.close(u64::MAX)?;
            force.table.finish()?;
        }
        Ok((self.curves.unwrap_or_default(), self.spent))
    }

    fn write(&mut self, block: &ContactBlock<'_>) -> io::Result<()> {
        if let Some(trace) = &mut self.trace {
            trace.add(block, self.sample_rate_hz)?;
        }
        if let Some(force) = &mut self.force {
            force.add(block)?;
        }
        Ok(())
    }

    fn draw(&mut self, block: &ContactBlock<'_>) {
        let Some(curves) = &mut self.curves else { return };
        let rate_hz = self.sample_rate_hz;
        // A contact id may be used again: a gap begins another curve.
        let known = curves.iter().rposition(|(contact, _)| *contact == block.contact).filter(|&index| {
            let curve = &curves[index].1;
            let end = curve.start_s * rate_hz + curve.samples as f64;
            (end - block.first_sample as f64).abs() < 1.5
        });
        let index = known.unwrap_or_else(|| {
            let start_s = block.first_sample as f64 / rate_hz;
            curves.push((block.contact, ContactCurve { start_s, ..ContactCurve::default() }));
            curves.len() - 1
        });
        let curve = &mut curves[index].1;
        curve.add(block, rate_hz, index < DRAWN_CONTACTS);
    }
}

impl Tap for Recorder {
    fn is_watching(&self) -> bool {
        self.trace.is_some() || self.force.is_some() || self.curves.is_some() || self.progress.is_some()
    }

    fn contact(&mut self, block: &ContactBlock<'_>) {
        let began = Instant::now();
        if self.failure.is_none() {
            self.failure = self.write(block).err();
        }
        self.draw(block);
        let end = block.first_sample + block.contact_samples.len() as u64;
        if let Some(progress) = &mut self.progress {
            progress.advance(end.saturating_sub(self.position));
        }
        self.position = self.position.max(end);
        self.spent += began.elapsed();
    }
}

/// Trace rows of one stretch of time, kept until every contact has written its own.
struct Trace {
    table: Table,
    rows: Vec<(u64, u64, [f64; 9])>,
    end: u64,
}

impl Trace {
    fn add(&mut self, block: &ContactBlock<'_>, rate_hz: f64) -> io::Result<()> {
        if block.first_sample >= self.end {
            self.write_rows(rate_hz)?;
        }
        let rows = (block.first_sample..).zip(block.trace());
        self.rows.extend(rows.map(|(sample, values)| (sample, block.contact.0, values)));
        self.end = self.end.max(block.first_sample + block.contact_samples.len() as u64);
        Ok(())
    }

    /// In order of time, and of contacts within a sample.
    fn write_rows(&mut self, rate_hz: f64) -> io::Result<()> {
        self.rows.sort_by_key(|(sample, contact, _)| (*sample, *contact));
        for (sample, contact, values) in self.rows.drain(..) {
            self.table.number(sample as f64 / rate_hz).whole(contact);
            for value in values {
                self.table.number(value);
            }
            self.table.end_row()?;
        }
        Ok(())
    }
}

/// The rows of `STEM.force.csv`, one contact each.
struct Force {
    table: Table,
    rate_hz: f64,
    rows: ForceRows,
}

impl Force {
    fn add(&mut self, block: &ContactBlock<'_>) -> io::Result<()> {
        self.close(block.first_sample)?;
        self.rows.add(block);
        Ok(())
    }

    /// Writes the rows of every tick that lies before the stretch now being written.
    fn close(&mut self, before: u64) -> io::Result<()> {
        let Self { table, rate_hz, rows } = self;
        let mut written = Ok(());
        rows.close(before, |row| {
            if let (Of::Contact(contact), Ok(())) = (row.of, &written) {
                table.number(row.tick as f64 / *rate_hz).whole(contact.0);
                for force_n in row.force_n {
                    table.number(force_n);
                }
                written = table.end_row();
            }
        });
        written
    }
}

impl ContactCurve {
    fn add(&mut self, block: &ContactBlock<'_>, rate_hz: f64, whole: bool) {
        for (index, row) in block.contact_samples.iter().enumerate() {
            let time_s = (block.first_sample + index as u64) as f64 / rate_hz;
            if whole {
                let [u, v] = block.velocity_m_s[index];
                self.height_m.push(row.height_m);
                self.pad_m.push(row.pad_m);
                self.speed_m_s.push(u.hypot(v));
                self.normal_force_n.push(row.normal_force_n);
                if self.samples.is_multiple_of(PATH_EVERY) {
                    self.path_uv.push(block.uv[index]);
                }
                if row.onset.is_some() {
                    self.collisions.push([time_s, row.pad_m]);
                }
            }
            let impulse = block.impulse_n_s[index].abs();
            if impulse > 0.0 {
                match self.impulses.last_mut() {
                    Some(last) if time_s - last[0] < 1.0 / IMPULSE_RATE_HZ => last[1] = last[1].max(impulse),
                    _ => self.impulses.push([time_s, impulse]),
                }
            }
            self.samples += 1;
        }
    }
}
