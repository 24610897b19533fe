//! `series.csv`: one row of numbers per frame.

use std::io::{self, Write};

/// Writes a table of numbers as comma-separated values (RFC 4180), row after row.
///
/// The first line names the columns. Numbers have as few digits as tell them from every other `f64`, so reading gives
/// the same bits back; values that are not finite are `NaN`, `inf` and `-inf`. Lines end with `\n`.
pub struct SeriesWriter<W> {
    out: W,
    columns: usize,
}

impl<W: Write> SeriesWriter<W> {
    /// Writes the first line. `names` are those of the columns, with their units: `kinetic [J]`.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn new(mut out: W, names: &[&str]) -> io::Result<Self> {
        for (column, name) in names.iter().enumerate() {
            let separator = if column == 0 { "" } else { "," };
            if name.contains([',', '"', '\n', '\r']) {
                write!(out, "{separator}\"{}\"", name.replace('"', "\"\""))?;
            } else {
                write!(out, "{separator}{name}")?;
            }
        }
        writeln!(out)?;
        Ok(Self { out, columns: names.len() })
    }

    /// Writes one row, a value per column.
    ///
    /// # Errors
    /// If `out` fails, or there are more or fewer values than columns.
    pub fn write_row(&mut self, values: impl IntoIterator<Item = f64>) -> io::Result<()> {
        let mut count = 0;
        for value in values {
            let separator = if count == 0 { "" } else { "," };
            // `Debug` and not `Display`: it gives an exponent to the very small and the very large.
            write!(self.out, "{separator}{value:?}")?;
            count += 1;
        }
        if count != self.columns {
            let message = format!("a row of {count} values for {} columns", self.columns);
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        writeln!(self.out)
    }

    /// Flushes and gives back the output.
    ///
    /// # Errors
    /// If it fails.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

/// Writes a whole table: `columns` are names with units and values, one per row.
///
/// # Errors
/// If `out` fails, or the columns differ in length.
pub fn write_series(out: impl Write, columns: &[(&str, &[f64])]) -> io::Result<()> {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    if let Some((name, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
        let message = format!("column `{name}` has {} values, but `{}` has {rows}", values.len(), names[0]);
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let mut series = SeriesWriter::new(out, &names)?;
    for row in 0..rows {
        series.write_row(columns.iter().map(|(_, values)| values[row]))?;
    }
    series.finish()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn written(columns: &[(&str, &[f64])]) -> String {
        let mut bytes = Vec::new();
        write_series(&mut bytes, columns).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn a_table_is_a_header_and_rows() {
        let text = written(&[
            ("time [s]", &[0.0, 1.0 / 60.0]),
            ("work of \"wind\", total [J]", &[-0.0, 1e-17]),
            ("σ [1]", &[f64::NAN, f64::NEG_INFINITY]),
        ]);
        let expected = "time [s],\"work of \"\"wind\"\", total [J]\",σ [1]\n\
                        0.0,-0.0,NaN\n0.016666666666666666,1e-17,-inf\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn columns_of_different_length_are_refused() {
        let error = write_series(Vec::new(), &[("a", &[1.0, 2.0]), ("b", &[1.0])]).unwrap_err();
        assert_eq!(error.to_string(), "column `b` has 1 values, but `a` has 2");
        let mut series = SeriesWriter::new(Vec::new(), &["a", "b"]).unwrap();
        assert_eq!(series.write_row([1.0]).unwrap_err().to_string(), "a row of 1 values for 2 columns");
    }

    proptest! {
        #[test]
        fn every_number_keeps_its_bits(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            let text = written(&[("a", &[value])]);
            let read: f64 = text.lines().nth(1).unwrap().parse().unwrap();
            prop_assert!(read.to_bits() == bits || read.is_nan() && value.is_nan());
        }
    }
}
