//! Tables of numbers that read back as the same numbers, quickly.

use std::io::{self, Write};

/// Writes rows of comma-separated values; numbers are the shortest decimals that round-trip.
#[derive(Debug)]
pub struct CsvWriter<W: Write> {
    out: W,
    line: Vec<u8>,
}

impl<W: Write> CsvWriter<W> {
    /// Begins a table with its header.
    ///
    /// # Errors
    /// When the header cannot be written.
    pub fn new(mut out: W, header: &str) -> io::Result<Self> {
        out.write_all(header.as_bytes())?;
        out.write_all(b"\n")?;
        Ok(Self { out, line: Vec::with_capacity(256) })
    }

    /// Adds a number to the row.
    pub fn number(&mut self, value: f64) -> &mut Self {
        self.comma();
        push_number(&mut self.line, value);
        self
    }

    /// Adds a whole number to the row.
    pub fn whole(&mut self, value: u64) -> &mut Self {
        self.comma();
        let _ = write!(self.line, "{value}");
        self
    }

    /// Ends the row.
    ///
    /// # Errors
    /// When the row cannot be written.
    pub fn end_row(&mut self) -> io::Result<()> {
        self.line.push(b'\n');
        self.out.write_all(&self.line)?;
        self.line.clear();
        Ok(())
    }

    /// Ends the table.
    ///
    /// # Errors
    /// When the last rows cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }

    fn comma(&mut self) {
        if !self.line.is_empty() {
            self.line.push(b',');
        }
    }
}

/// The shortest decimal that reads back as `value`; an exponent where plain digits would be long.
pub fn push_number(line: &mut Vec<u8>, value: f64) {
    let size = value.abs();
    if value == 0.0 {
        line.push(b'0');
    } else if (1e-3..1e15).contains(&size) {
        let _ = write!(line, "{value}");
    } else {
        let _ = write!(line, "{value:e}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        let mut rng = Rng::new(3);
        for _ in 0..20_000 {
            let value = rng.normal() * 10f64.powf(rng.uniform() * 60.0 - 30.0);
            let mut text = Vec::new();
            push_number(&mut text, value);
            let back: f64 = std::str::from_utf8(&text).unwrap().parse().unwrap();
            assert_eq!(back.to_bits(), value.to_bits());
            assert!(text.len() <= 24, "{}", String::from_utf8_lossy(&text));
        }
    }

    #[test]
    fn a_row_is_what_it_says() {
        let mut bytes = Vec::new();
        let mut table = CsvWriter::new(&mut bytes, "time_s,contact,u").unwrap();
        table.number(0.5).whole(3).number(1e-9).end_row().unwrap();
        table.finish().unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), "time_s,contact,u\n0.5,3,1e-9\n");
    }
}
