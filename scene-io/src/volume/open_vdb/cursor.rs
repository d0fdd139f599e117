//! A file's bytes, read from front to back.

/// Where reading is, in the first bytes of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// How many are left.
    pub(super) fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// A cursor further on that reads no further than `end`.
    pub(super) fn within(&self, start: i64, end: i64) -> Result<Self, String> {
        let place = |x: i64| usize::try_from(x).ok();
        match (place(start), place(end)) {
            (Some(at), Some(end)) if self.at <= at && at <= end && end <= self.bytes.len() => {
                let bytes = &self.bytes[..end];
                Ok(Self { bytes, at })
            }
            _ => Err(format!(
                "is said to lie in bytes {start} to {end} of {}: the file is cut off or broken, copy or export it again",
                self.bytes.len()
            )),
        }
    }

    pub(super) fn seek(&mut self, at: usize) {
        self.at = at.min(self.bytes.len());
    }

    pub(super) fn take(&mut self, n: usize) -> Result<&'a [u8], String> {
        let rest = &self.bytes[self.at..];
        let taken = rest.get(..n).ok_or_else(|| {
            format!(
                "ends too early, at byte {}: the file is cut off or broken, copy or export it again",
                self.bytes.len()
            )
        })?;
        self.at += n;
        Ok(taken)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub(super) fn u8(&mut self) -> Result<u8, String> {
        self.array().map(|[byte]| byte)
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn i64(&mut self) -> Result<i64, String> {
        self.array().map(i64::from_le_bytes)
    }

    pub(super) fn i32s<const N: usize>(&mut self) -> Result<[i32; N], String> {
        let mut all = [0; N];
        for x in &mut all {
            *x = i32::from_le_bytes(self.array()?);
        }
        Ok(all)
    }

    pub(super) fn f64s<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let mut all = [0.0; N];
        for x in &mut all {
            *x = f64::from_le_bytes(self.array()?);
        }
        Ok(all)
    }

    /// A string, which need not be UTF-8.
    pub(super) fn string(&mut self) -> Result<&'a [u8], String> {
        let length = self.u32()?;
        self.take(length as usize)
    }

    /// A bit for each of 64·`words` slots.
    pub(super) fn mask(&mut self, words: usize) -> Result<Vec<u64>, String> {
        let (words, _) = self.take(8 * words)?.as_chunks();
        Ok(words.iter().map(|word| u64::from_le_bytes(*word)).collect())
    }
}
