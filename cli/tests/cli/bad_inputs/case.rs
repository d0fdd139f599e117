//! A row of the table.

/// A bad input, and how the command must take it.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    /// Names and bytes; names that end in `/` are folders.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    pub(crate) arguments: Vec<&'static str>,
    /// The exit code.
    pub(crate) code: i32,
    /// What the message must hold, in this order and with ` … ` between: the file, the field, a word
    /// of the mend.
    pub(crate) words: &'static str,
}

impl Case {
    /// `command` is split at spaces.
    pub(crate) fn new(
        name: &'static str,
        command: &'static str,
        code: i32,
        words: &'static str,
    ) -> Self {
        Self {
            name,
            files: Vec::new(),
            arguments: command.split(' ').collect(),
            code,
            words,
        }
    }

    /// With one more file.
    pub(crate) fn file(mut self, name: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.push((name, bytes.into()));
        self
    }
}

/// `text` with `new` in place of `old`, which stands there once.
pub(crate) fn replaced(text: &str, old: &str, new: &str) -> String {
    assert_eq!(text.matches(old).count(), 1, "{old}");
    text.replace(old, new)
}
