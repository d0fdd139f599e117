//! What the parser of OBJ and MTL files would panic at.

/// Whether the vertices of faces have numbers that it can calculate with.
pub(super) fn obj(bytes: &[u8]) -> Result<(), String> {
    const LARGEST: u64 = u32::MAX as u64;
    for (line, text) in lines(bytes) {
        let mut words = text.split_whitespace();
        if !matches!(words.next(), Some("f" | "l" | "p")) {
            continue;
        }
        let indices = words.flat_map(|word| word.split('/'));
        let mut numbers = indices.filter_map(|index| index.parse::<i64>().ok());
        if let Some(index) = numbers.find(|n| n.unsigned_abs() > LARGEST) {
            return Err(format!(
                "line {line}: there is no vertex {index}: export it again"
            ));
        }
    }
    Ok(())
}

/// Whether colours have three numbers.
pub(super) fn mtl(bytes: &[u8]) -> Result<(), String> {
    for (line, text) in lines(bytes) {
        let mut words = text.split_whitespace();
        let key = words.next().unwrap_or_default();
        if matches!(key, "Ka" | "Kd" | "Ks" | "Ke") && words.count() < 3 {
            return Err(format!(
                "line {line}: `{key}` needs three numbers: write `{key} r g b`"
            ));
        }
    }
    Ok(())
}

/// The lines and their numbers, from 1.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, std::borrow::Cow<'_, str>)> {
    let lines = bytes.split(|&byte| byte == b'\n').enumerate();
    lines.map(|(i, line)| (i + 1, String::from_utf8_lossy(line)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_panic_is_named() {
        let why = obj(b"v 0 0 0\nf 1//6148914691236517206 1 1").unwrap_err();
        assert!(why.contains("line 2") && why.contains("6148914691236517206"));
        obj(b"f 1/2/3 -1//-1 4294967295 x\nv 1e99 0 0").unwrap();
        let why = mtl(b"newmtl a\n\n Kd 0.5 0.5\r\n").unwrap_err();
        assert!(why.contains("line 3") && why.contains("`Kd r g b`"));
        mtl(b"newmtl a\nKd 1 1 1\nNs 3\n# Kd\n").unwrap();
    }
}
