//! Reading an archive.

use std::collections::BTreeMap;
use std::io::{self, Read, Seek, SeekFrom};

use zip::result::ZipError;
use zip::{CompressionMethod, ZipArchive};

use super::npy::{self, Dtype};

/// Why an archive cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpzError {
    /// Reading itself failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The bytes are not a zip archive, or a damaged one.
    #[error("not a readable .npz archive: {reason}")]
    Archive {
        /// What is wrong.
        reason: String,
    },
    /// An array is damaged, of a kind that is not read here, or of an unexpected type or shape.
    #[error("array `{name}` {reason}")]
    Array {
        /// Name of the array.
        name: String,
        /// What is wrong, as the rest of a sentence.
        reason: String,
    },
    /// An array is not there.
    #[error("array `{name}` is missing; the archive holds {}", list(present))]
    Missing {
        /// Name of the array.
        name: String,
        /// Names of the arrays that are there.
        present: Vec<String>,
    },
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { format!("`{}`", names.join("`, `")) }
}

impl NpzError {
    pub(in crate::write) fn array(name: &str, reason: impl Into<String>) -> Self {
        Self::Array { name: name.to_owned(), reason: reason.into() }
    }
}

impl From<ZipError> for NpzError {
    fn from(error: ZipError) -> Self {
        match error {
            // A damaged length makes the reader run past the end of the file.
            ZipError::Io(error) if error.kind() != io::ErrorKind::UnexpectedEof => Self::Io(error),
            other => Self::Archive { reason: other.to_string() },
        }
    }
}

impl From<NpzError> for io::Error {
    fn from(error: NpzError) -> Self {
        match error {
            NpzError::Io(error) => error,
            other => Self::new(io::ErrorKind::InvalidData, other),
        }
    }
}

/// One array of an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NpzArray {
    /// Type of its elements.
    pub dtype: Dtype,
    /// Its lengths, first index first.
    pub shape: Vec<u64>,
    /// Where its data starts in the file [byte].
    pub offset: u64,
}

impl NpzArray {
    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> u64 {
        // That the data fits the file was checked on opening.
        npy::data_length(self.dtype, &self.shape).map_or(0, |bytes| bytes / self.dtype.size())
    }

    /// Whether there are no elements.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Reads an uncompressed `.npz` archive as [`NpzWriter`](super::NpzWriter) or `numpy.savez` writes it, any part of any array.
///
/// Checksums are not compared, so that the intact frames of a file with a damaged one can still be read.
pub struct NpzReader<R> {
    input: R,
    arrays: BTreeMap<String, NpzArray>,
}

impl<R: Read + Seek> NpzReader<R> {
    /// Reads the directory and the header of every array.
    ///
    /// # Errors
    /// If `input` is not an archive of uncompressed arrays in C order, of the types in [`Dtype`].
    pub fn new(mut input: R) -> Result<Self, NpzError> {
        let file_length = input.seek(SeekFrom::End(0))?;
        let mut archive = ZipArchive::new(input)?;
        let mut arrays = BTreeMap::new();
        for index in 0..archive.len() {
            let mut entry = archive.by_index_raw(index)?;
            let file_name = entry.name()?.into_owned();
            let Some(name) = file_name.strip_suffix(".npy") else {
                return Err(NpzError::Archive {
                    reason: format!("it holds `{file_name}`, which is no array"),
                });
            };
            if entry.compression() != CompressionMethod::Stored || entry.encrypted() {
                return Err(NpzError::array(name, "is compressed; write it with `numpy.savez`"));
            }
            let (start, length) = (entry.data_start().unwrap_or(u64::MAX), entry.size());
            if start.checked_add(length).is_none_or(|end| file_length < end) {
                return Err(NpzError::array(name, "reaches past the end of the file"));
            }
            let array =
                read_header(&mut entry, start, length).map_err(|reason| NpzError::array(name, reason))?;
            arrays.insert(name.to_owned(), array);
        }
        Ok(Self { input: archive.into_inner(), arrays })
    }

    /// Names of the arrays, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrays.keys().map(String::as_str)
    }

    /// Array `name`: its type, its shape and its place in the file.
    ///
    /// # Errors
    /// If there is no such array.
    pub fn array(&self, name: &str) -> Result<&NpzArray, NpzError> {
        self.arrays.get(name).ok_or_else(|| NpzError::Missing {
            name: name.to_owned(),
            present: self.arrays.keys().cloned().collect(),
        })
    }

    /// The data of array `name` from element `first` on: little-endian, last index fastest.
    ///
    /// # Errors
    /// If there is no such array, `first` is above its number of elements, or `input` fails.
    pub fn data(&mut self, name: &str, first: u64) -> Result<io::Take<&mut R>, NpzError> {
        let array = self.array(name)?;
        let (length, size, offset) = (array.len(), array.dtype.size(), array.offset);
        if length < first {
            return Err(NpzError::array(name, format!("has {length} elements, none at {first}")));
        }
        self.input.seek(SeekFrom::Start(offset + first * size))?;
        Ok(self.input.by_ref().take((length - first) * size))
    }
}

/// The array in an entry of `length` bytes at `start` of the file.
fn read_header(entry: &mut impl Read, start: u64, length: u64) -> Result<NpzArray, String> {
    let cut_short = |_| "ends within its header".to_owned();
    let mut bytes = [0; npy::START_LENGTH];
    entry.read_exact(&mut bytes).map_err(cut_short)?;
    let mut text = vec![0; npy::parse_start(&bytes)?];
    entry.read_exact(&mut text).map_err(cut_short)?;
    let (dtype, shape) = npy::parse_text(&text)?;
    let header_length = (bytes.len() + text.len()) as u64;
    let data_length = length.saturating_sub(header_length);
    if npy::data_length(dtype, &shape) != Some(data_length) {
        return Err(format!(
            "has {data_length} bytes of data, which do not fit {} of shape {shape:?}",
            dtype.name()
        ));
    }
    Ok(NpzArray { dtype, shape, offset: start + header_length })
}
