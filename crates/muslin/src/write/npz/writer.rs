//! Writing an archive.

use std::cell::Cell;
use std::io::{self, Seek, SeekFrom, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::npy::{self, Dtype};

/// Writes a `.npz` archive, array after array. The same arrays give the same bytes everywhere.
///
/// Array data starts at multiples of 64 bytes of the file. An array above 4 GiB is written in the zip format's 64-bit
/// form, which NumPy reads too. After an error nothing more is written.
pub struct NpzWriter<W: Write + Seek> {
    zip: ZipWriter<Output<W>>,
}

impl<W: Write + Seek> NpzWriter<W> {
    /// Starts an archive at the current position of `out`, which must be its start.
    pub fn new(out: W) -> Self {
        Self { zip: ZipWriter::new(Output { inner: out, position: 0, discards: Cell::new(false) }) }
    }

    /// Appends array `name` of `shape`; `write_data` writes its elements: little-endian, last index fastest.
    ///
    /// # Errors
    /// If `out` or `write_data` fails, `write_data` writes another number of bytes than the shape needs, the name is
    /// taken, or the size does not fit a file. The archive cannot be finished from then on.
    pub fn write_array(
        &mut self,
        name: &str,
        dtype: Dtype,
        shape: &[u64],
        write_data: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let result = self.try_write_array(name, dtype, shape, write_data);
        if let (Err(_), Some(output)) = (&result, self.zip.get_ref()) {
            output.discards.set(true);
        }
        result
    }

    fn try_write_array(
        &mut self,
        name: &str,
        dtype: Dtype,
        shape: &[u64],
        write_data: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let too_large =
            || invalid_input(format!("array `{name}` of shape {shape:?} is too large for a file"));
        let header = npy::header(dtype, shape).ok_or_else(too_large)?;
        let length = npy::data_length(dtype, shape).ok_or_else(too_large)?;
        let entry_length = length.checked_add(header.len() as u64).ok_or_else(too_large)?;
        // Time, system and permissions would otherwise depend on when and where the archive is written.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .system(System::Unix)
            .unix_permissions(0o644)
            .with_alignment(64)
            .large_file(u64::from(u32::MAX) <= entry_length);
        self.zip.start_file(format!("{name}.npy"), options)?;
        self.zip.write_all(&header)?;
        let mut data = Exactly { out: &mut self.zip, left: length };
        write_data(&mut data)?;
        match data.left {
            0 => Ok(()),
            left => Err(invalid_input(format!("array `{name}` lacks {left} of its {length} bytes"))),
        }
    }

    /// Writes the archive's directory and flushes `out`.
    ///
    /// # Errors
    /// If `out` fails, or an array could not be written.
    pub fn finish(self) -> io::Result<()> {
        let mut output = self.zip.finish()?;
        output.flush()?;
        match output.discards.get() {
            false => Ok(()),
            true => Err(invalid_input("the archive lacks an array that could not be written".to_owned())),
        }
    }
}

fn invalid_input(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// The output under [`ZipWriter`], which completes its archive even when dropped after an error, and prints if that
/// fails: from an error on, this only pretends to write.
struct Output<W> {
    inner: W,
    position: u64,
    discards: Cell<bool>,
}

impl<W> Output<W> {
    fn noting_failure<T>(&self, result: io::Result<T>) -> io::Result<T> {
        if result.as_ref().is_err_and(|error| error.kind() != io::ErrorKind::Interrupted) {
            self.discards.set(true);
        }
        result
    }
}

impl<W: Write> Write for Output<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = match self.discards.get() {
            true => Ok(bytes.len()),
            // A full slice takes nothing and does not call that an error.
            false => self.inner.write(bytes).and_then(|written| match written {
                0 if !bytes.is_empty() => Err(io::ErrorKind::WriteZero.into()),
                _ => Ok(written),
            }),
        };
        let written = self.noting_failure(result)?;
        self.position = self.position.saturating_add(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = if self.discards.get() { Ok(()) } else { self.inner.flush() };
        self.noting_failure(result)
    }
}

impl<W: Seek> Seek for Output<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let result = match (self.discards.get(), to) {
            (false, _) => self.inner.seek(to),
            (true, SeekFrom::Start(position)) => Ok(position),
            (true, SeekFrom::Current(distance) | SeekFrom::End(distance)) => {
                Ok(self.position.saturating_add_signed(distance))
            }
        };
        self.position = self.noting_failure(result)?;
        Ok(self.position)
    }
}

/// Passes on a given number of bytes and refuses any more.
struct Exactly<W> {
    out: W,
    left: u64,
}

impl<W: Write> Write for Exactly<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.left < bytes.len() as u64 {
            return Err(invalid_input("more array data than the shape has room for".to_owned()));
        }
        let written = self.out.write(bytes)?;
        self.left -= written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn wrong_use_is_refused() {
        let mut writer = NpzWriter::new(Cursor::new(Vec::new()));
        let error = writer.write_array("a", Dtype::U8, &[3], |out| out.write_all(&[0; 2])).unwrap_err();
        assert_eq!(error.to_string(), "array `a` lacks 1 of its 3 bytes");
        let error = writer.finish().unwrap_err();
        assert_eq!(error.to_string(), "the archive lacks an array that could not be written");
        let mut writer = NpzWriter::new(Cursor::new(Vec::new()));
        let error = writer.write_array("a", Dtype::U8, &[3], |out| out.write_all(&[0; 4])).unwrap_err();
        assert_eq!(error.to_string(), "more array data than the shape has room for");
        let error = writer.write_array("b", Dtype::F64, &[1 << 40, 1 << 40], |_| Ok(())).unwrap_err();
        assert_eq!(
            error.to_string(),
            "array `b` of shape [1099511627776, 1099511627776] is too large for a file"
        );
    }

    #[test]
    fn after_a_failure_nothing_is_written_and_nothing_fails() {
        let mut storage = [0; 4];
        let mut output =
            Output { inner: Cursor::new(&mut storage[..]), position: 0, discards: Cell::new(false) };
        output.write_all(&[1; 6]).unwrap_err();
        output.rewind().unwrap();
        output.write_all(&[2; 6]).unwrap();
        output.flush().unwrap();
        assert_eq!((output.stream_position().unwrap(), storage), (6, [1; 4]));
    }
}
