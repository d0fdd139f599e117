//! Little-endian numbers in bytes that may end anywhere.

/// What a file says of places outside itself is an error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn slice(self, at: usize, length: usize) -> Result<&'a [u8], String> {
        let end = at.checked_add(length);
        let slice = end.and_then(|end| self.0.get(at..end));
        slice.ok_or_else(|| {
            format!(
                "it ends too early, at byte {}: the file is cut off or damaged, copy or export it again",
                self.0.len()
            )
        })
    }

    pub(super) fn array<const N: usize>(self, at: usize) -> Result<[u8; N], String> {
        let mut array = [0; N];
        array.copy_from_slice(self.slice(at, N)?);
        Ok(array)
    }

    pub(super) fn u8(self, at: usize) -> Result<u8, String> {
        self.array(at).map(u8::from_le_bytes)
    }

    pub(super) fn u16(self, at: usize) -> Result<u16, String> {
        self.array(at).map(u16::from_le_bytes)
    }

    pub(super) fn u32(self, at: usize) -> Result<u32, String> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub(super) fn u64(self, at: usize) -> Result<u64, String> {
        self.array(at).map(u64::from_le_bytes)
    }

    pub(super) fn i64(self, at: usize) -> Result<i64, String> {
        self.array(at).map(i64::from_le_bytes)
    }

    pub(super) fn f32(self, at: usize) -> Result<f32, String> {
        self.array(at).map(f32::from_le_bytes)
    }

    pub(super) fn f64(self, at: usize) -> Result<f64, String> {
        self.array(at).map(f64::from_le_bytes)
    }

    /// A number of bytes. More than can be addressed are cut off in any case.
    pub(super) fn size(self, at: usize) -> Result<usize, String> {
        Ok(usize::try_from(self.u64(at)?).unwrap_or(usize::MAX))
    }

    /// The text up to the first zero.
    pub(super) fn text(self, at: usize, length: usize) -> Result<String, String> {
        let text = self.slice(at, length)?;
        let text = text.split(|&byte| byte == 0).next().unwrap_or(text);
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    /// A bit of a mask that begins at `at`.
    pub(super) fn bit(self, at: usize, bit: usize) -> Result<bool, String> {
        Ok(self.u8(at + bit / 8)? >> (bit % 8) & 1 == 1)
    }
}
