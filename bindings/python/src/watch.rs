//! Watch over a render: rows of trace and force, progress, Ctrl-C.

use crate::interrupt::Pulse;
use asperity::live::ports::{ForceRows, Of};
use asperity::{ContactBlock, Tap};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Rows of one contact each, as columns.
#[derive(Default)]
pub struct Rows<const N: usize> {
    /// Sample or tick of each row.
    pub at: Vec<u64>,
    /// Contact of each row.
    pub contact: Vec<u64>,
    /// The numbers of each row.
    pub values: Vec<[f64; N]>,
}

/// A row index array, a contact array and (rows, columns).
pub type PyRows<'py> = (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray1<u64>>, Bound<'py, PyArray2<f64>>);

impl<const N: usize> Rows<N> {
    fn new() -> Self {
        Self { at: Vec::new(), contact: Vec::new(), values: Vec::new() }
    }

    fn add(&mut self, at: u64, contact: u64, values: [f64; N]) {
        self.at.push(at);
        self.contact.push(contact);
        self.values.push(values);
    }

    /// As arrays.
    pub fn arrays(self, py: Python<'_>) -> PyResult<PyRows<'_>> {
        let shape = [self.values.len(), N];
        let values = PyArray1::from_vec(py, self.values.into_flattened()).reshape(shape)?;
        Ok((PyArray1::from_vec(py, self.at), PyArray1::from_vec(py, self.contact), values))
    }
}

/// The tap of a render.
pub struct Watch {
    pulse: Pulse,
    trace: Option<Rows<9>>,
    force: Option<(ForceRows, Rows<3>)>,
}

impl Watch {
    /// Keeps what is asked for.
    pub fn new(pulse: Pulse, trace: bool, force_rate_hz: Option<f64>, sample_rate_hz: f64) -> Self {
        let force = |rate_hz| (ForceRows::new(rate_hz, sample_rate_hz, 64), Rows::new());
        Self { pulse, trace: trace.then(Rows::new), force: force_rate_hz.map(force) }
    }

    /// Error of Python when it did not want to go on.
    pub fn error(&mut self) -> Option<PyErr> {
        self.pulse.error()
    }

    /// The rows, complete.
    pub fn finish(mut self) -> (Option<Rows<9>>, Option<Rows<3>>) {
        if let Some((making, made)) = &mut self.force {
            close(making, made, u64::MAX);
        }
        (self.trace, self.force.map(|(_, made)| made))
    }
}

impl Tap for Watch {
    fn is_watching(&self) -> bool {
        self.trace.is_some() || self.force.is_some()
    }

    fn contact(&mut self, block: &ContactBlock<'_>) {
        if let Some(rows) = &mut self.trace {
            trace(rows, block);
        }
        if let Some((making, made)) = &mut self.force {
            close(making, made, block.first_sample);
            making.add(block);
        }
    }

    fn goes_on(&mut self, done: u64, of: u64) -> bool {
        self.pulse.beat(done as f64 / of.max(1) as f64)
    }
}

fn trace(rows: &mut Rows<9>, block: &ContactBlock<'_>) {
    for (sample, values) in (block.first_sample..).zip(block.trace()) {
        rows.add(sample, block.contact.0, values);
    }
}

/// Takes the rows of every tick that nothing can change any more.
fn close(making: &mut ForceRows, made: &mut Rows<3>, before: u64) {
    making.close(before, |row| {
        if let Of::Contact(contact) = row.of {
            made.add(row.tick, contact.0, row.force_n);
        }
    });
}
