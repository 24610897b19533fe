//! The header of a NumPy array file: element type and shape.

/// Type of an array's elements, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dtype {
    /// 64-bit floating point.
    F64,
    /// 32-bit floating point.
    F32,
    /// Unsigned 64-bit integer.
    U64,
    /// Unsigned 32-bit integer.
    U32,
    /// Unsigned byte.
    U8,
}

impl Dtype {
    const ALL: [Self; 5] = [Self::F64, Self::F32, Self::U64, Self::U32, Self::U8];

    /// Size of one element [byte].
    #[must_use]
    pub const fn size(self) -> u64 {
        match self {
            Self::F64 | Self::U64 => 8,
            Self::F32 | Self::U32 => 4,
            Self::U8 => 1,
        }
    }

    /// NumPy's name, as in `numpy.dtype(name)`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F64 => "<f8",
            Self::F32 => "<f4",
            Self::U64 => "<u8",
            Self::U32 => "<u4",
            Self::U8 => "|u1",
        }
    }
}

/// Size of an array of `shape` [byte]; `None` where it does not fit `u64`.
pub(super) fn data_length(dtype: Dtype, shape: &[u64]) -> Option<u64> {
    // A zero makes the array empty, however large its other lengths are.
    if shape.contains(&0) {
        return Some(0);
    }
    shape.iter().try_fold(dtype.size(), |bytes, &length| bytes.checked_mul(length))
}

/// What every array file starts with.
const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Array data starts at a multiple of this [byte].
const ALIGNMENT: usize = 64;

/// The bytes before the data of an array in C order: format version 1.0, padded to a multiple of 64.
///
/// `None` where the shape has so many dimensions that the version's 64 KiB do not hold it.
pub(super) fn header(dtype: Dtype, shape: &[u64]) -> Option<Vec<u8>> {
    let lengths = match shape {
        [length] => format!("{length},"),
        _ => shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
    };
    let mut text = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({lengths}), }}", dtype.name());
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', unpadded.next_multiple_of(ALIGNMENT) - unpadded));
    text.push('\n');
    let length = u16::try_from(text.len()).ok()?;
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend(length.to_le_bytes());
    bytes.extend(text.into_bytes());
    Some(bytes)
}

/// How many bytes [`parse_start`] needs.
pub(super) const START_LENGTH: usize = 10;

/// The length of the text that follows the first bytes of an array file.
///
/// # Errors
/// What is wrong, if the file is not an array of format version 1.0.
pub(super) fn parse_start(start: &[u8; START_LENGTH]) -> Result<usize, String> {
    let [magic @ .., major, minor, low, high] = start;
    if magic != MAGIC {
        return Err("does not start like an array file".to_owned());
    }
    if [*major, *minor] != [1, 0] {
        return Err(format!("has format version {major}.{minor}, but only 1.0 is read"));
    }
    Ok(usize::from(u16::from_le_bytes([*low, *high])))
}

/// Element type and shape from the text of a header.
///
/// # Errors
/// What is wrong, if the text is not a header or describes an array that is not read here: one in Fortran order, or of
/// another type.
pub(super) fn parse_text(text: &[u8]) -> Result<(Dtype, Vec<u64>), String> {
    let text = std::str::from_utf8(text).ok().filter(|text| text.is_ascii());
    let mut cursor = Cursor { rest: text.ok_or("has a header that is not text")? };
    let (mut dtype, mut fortran_order, mut shape) = (None, None, None);
    cursor.expect('{')?;
    while !cursor.accept('}') {
        let key = cursor.quoted()?;
        cursor.expect(':')?;
        match key {
            "descr" => dtype = Some(cursor.dtype()?),
            "fortran_order" => fortran_order = Some(cursor.boolean()?),
            "shape" => shape = Some(cursor.tuple()?),
            _ => return Err(format!("has a header with the unknown key `{key}`")),
        }
        if !cursor.accept(',') {
            cursor.expect('}')?;
            break;
        }
    }
    match (dtype, fortran_order, shape) {
        (Some(dtype), Some(false), Some(shape)) => Ok((dtype, shape)),
        (Some(_), Some(true), Some(_)) => Err("is in Fortran order, but only C order is read".to_owned()),
        _ => Err("has a header without `descr`, `fortran_order` or `shape`".to_owned()),
    }
}

/// What is left of a header's text: a Python literal.
struct Cursor<'a> {
    rest: &'a str,
}

impl<'a> Cursor<'a> {
    fn accept(&mut self, wanted: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(wanted);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn expect(&mut self, wanted: char) -> Result<(), String> {
        if self.accept(wanted) { Ok(()) } else { Err(format!("has a damaged header: `{wanted}` is missing")) }
    }

    /// The text up to the first character that `stop` accepts.
    fn until(&mut self, stop: impl Fn(char) -> bool) -> &'a str {
        let (text, rest) = self.rest.split_at(self.rest.find(stop).unwrap_or(self.rest.len()));
        self.rest = rest;
        text
    }

    fn quoted(&mut self) -> Result<&'a str, String> {
        let quote = if self.accept('"') { '"' } else { '\'' };
        if quote == '\'' {
            self.expect(quote)?;
        }
        let text = self.until(|c| c == quote);
        self.expect(quote)?;
        Ok(text)
    }

    fn dtype(&mut self) -> Result<Dtype, String> {
        if self.rest.trim_start().starts_with('[') {
            return Err("holds records, but only plain numbers are read".to_owned());
        }
        let name = self.quoted()?;
        Dtype::ALL.into_iter().find(|dtype| dtype.name() == name).ok_or_else(|| {
            let known = Dtype::ALL.map(Dtype::name).join(", ");
            format!("holds elements of type `{name}`, but only {known} are read")
        })
    }

    fn boolean(&mut self) -> Result<bool, String> {
        self.rest = self.rest.trim_start();
        match self.until(|c| !c.is_ascii_alphabetic()) {
            "True" => Ok(true),
            "False" => Ok(false),
            other => Err(format!("has a damaged header: `{other}` is neither True nor False")),
        }
    }

    fn tuple(&mut self) -> Result<Vec<u64>, String> {
        let mut lengths = Vec::new();
        self.expect('(')?;
        while !self.accept(')') {
            self.rest = self.rest.trim_start();
            let digits = self.until(|c| !c.is_ascii_digit());
            lengths
                .push(digits.parse().map_err(|_| format!("has a damaged header: `{digits}` is no length"))?);
            if !self.accept(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(lengths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What NumPy writes for `numpy.zeros((2, 3))`, but for the padding.
    #[test]
    fn the_header_is_numpys() {
        let header = header(Dtype::F64, &[2, 3]).unwrap();
        let text = b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
        assert!(header.starts_with(text), "{}", String::from_utf8_lossy(&header));
        assert_eq!((header.len(), header.last()), (128, Some(&b'\n')));
    }

    #[test]
    fn every_shape_is_read_back() {
        for dtype in Dtype::ALL {
            for shape in [&[][..], &[0], &[7], &[0, 3], &[2, 3, u64::MAX]] {
                let header = header(dtype, shape).unwrap();
                assert_eq!(header.len() % ALIGNMENT, 0);
                let (start, text) = header.split_first_chunk().unwrap();
                assert_eq!(parse_start(start), Ok(text.len()));
                assert_eq!(parse_text(text), Ok((dtype, shape.to_vec())));
            }
        }
        assert_eq!(header(Dtype::U8, &[1; 40_000]), None);
    }

    #[test]
    fn a_foreign_header_is_refused_by_name() {
        let error = |text: &str| parse_text(text.as_bytes()).unwrap_err();
        assert_eq!(
            error("{'descr': '>f8', 'fortran_order': False, 'shape': (1,), }"),
            "holds elements of type `>f8`, but only <f8, <f4, <u8, <u4, |u1 are read"
        );
        assert_eq!(
            error("{'shape': (1,), \"descr\": \"<f8\", 'fortran_order': True}\n"),
            "is in Fortran order, but only C order is read"
        );
        assert_eq!(
            error("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,), }"),
            "holds records, but only plain numbers are read"
        );
        assert_eq!(
            error("{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }"),
            "has a damaged header: `` is no length"
        );
        assert_eq!(error("{}"), "has a header without `descr`, `fortran_order` or `shape`");
    }
}
