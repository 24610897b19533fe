//! NumPy archives: named arrays in one file, uncompressed, so that any part of an array can be read alone.

mod npy;
mod reader;
mod writer;

pub use npy::Dtype;
pub use reader::{NpzArray, NpzError, NpzReader};
pub use writer::NpzWriter;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;
    use std::io::{Cursor, Read};
    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    /// An archive with one array of each type, one of them empty.
    fn example() -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = NpzWriter::new(&mut bytes);
        for (name, dtype, shape) in [
            ("time", Dtype::F64, &[2][..]),
            ("weights", Dtype::F32, &[2, 1, 3]),
            ("triangles", Dtype::U32, &[0, 3]),
            ("colours", Dtype::U8, &[3]),
            ("count", Dtype::U64, &[]),
        ] {
            let length = npy::data_length(dtype, shape).unwrap();
            let data: Vec<u8> = (0..length).map(|n| n as u8).collect();
            writer.write_array(name, dtype, shape, |out| out.write_all(&data)).unwrap();
        }
        writer.finish().unwrap();
        bytes.into_inner()
    }

    /// Reads all there is.
    fn read_all(bytes: &[u8]) -> Result<BTreeMap<String, Vec<u8>>, NpzError> {
        let mut reader = NpzReader::new(Cursor::new(bytes))?;
        let names: Vec<String> = reader.names().map(str::to_owned).collect();
        let mut arrays = BTreeMap::new();
        for name in names {
            let mut data = Vec::new();
            reader.data(&name, 0)?.read_to_end(&mut data)?;
            arrays.insert(name, data);
        }
        Ok(arrays)
    }

    #[test]
    fn what_was_written_is_read_back() {
        let bytes = example();
        let arrays = read_all(&bytes).unwrap();
        let lengths: Vec<_> = arrays.iter().map(|(name, data)| (name.as_str(), data.len())).collect();
        assert_eq!(lengths, [("colours", 3), ("count", 8), ("time", 16), ("triangles", 0), ("weights", 24)]);
        assert!(arrays.values().all(|data| data.iter().enumerate().all(|(n, &byte)| byte == n as u8)));
        let mut reader = NpzReader::new(Cursor::new(&bytes)).unwrap();
        let array = reader.array("weights").unwrap();
        assert_eq!((array.dtype, array.shape.as_slice(), array.offset % 64), (Dtype::F32, &[2, 1, 3][..], 0));
        let mut part = [0; 4];
        reader.data("weights", 4).unwrap().read_exact(&mut part).unwrap();
        assert_eq!(part, [16, 17, 18, 19]);
        assert_eq!(bytes, example(), "the same arrays give the same bytes");
    }

    /// A full disk: every place at which it may fill up gives an error from some call, and no panic.
    #[test]
    fn an_output_that_fails_gives_an_error() {
        let length = example().len();
        for room in 0..length {
            let mut storage = vec![0; room];
            let mut writer = NpzWriter::new(Cursor::new(&mut storage[..]));
            let result = [("time", 16), ("weights", 24), ("triangles", 0), ("colours", 3), ("count", 8)]
                .into_iter()
                .try_for_each(|(name, length)| {
                    writer.write_array(name, Dtype::U8, &[length], |out| {
                        out.write_all(&vec![0; length as usize])
                    })
                });
            assert!(result.and_then(|()| writer.finish()).is_err(), "{room} of {length} bytes");
        }
    }

    #[test]
    fn a_foreign_file_is_refused() {
        let error = |bytes: &[u8]| read_all(bytes).unwrap_err().to_string();
        assert!(error(b"").starts_with("not a readable .npz archive: "), "{}", error(b""));
        assert!(error(b"[run]\nduration = 3.0\n").starts_with("not a readable .npz archive: "));
        let mut reader = NpzReader::new(Cursor::new(example())).unwrap();
        assert_eq!(
            reader.data("positions", 0).unwrap_err().to_string(),
            "array `positions` is missing; the archive holds `colours`, `count`, `time`, `triangles`, `weights`"
        );
        assert_eq!(reader.data("time", 3).unwrap_err().to_string(), "array `time` has 2 elements, none at 3");
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        zip.start_file("notes.txt", SimpleFileOptions::default()).unwrap();
        let bytes = zip.finish().unwrap().into_inner();
        assert_eq!(error(&bytes), "not a readable .npz archive: it holds `notes.txt`, which is no array");
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_do_not_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = read_all(&bytes);
        }

        #[test]
        fn damage_does_not_panic(
            damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
            cut in any::<prop::sample::Index>(),
            is_cut in any::<bool>(),
        ) {
            let mut bytes = example();
            for (index, value) in damage {
                let index = index.index(bytes.len());
                bytes[index] = value;
            }
            if is_cut {
                bytes.truncate(cut.index(bytes.len()));
            }
            let _ = read_all(&bytes);
        }
    }
}
