//! The files that a scene is made of.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Where names of files start from, and all files that were named so far. Whatever reads a file of
/// a scene gets its path here, so that none is forgotten.
#[derive(Clone, Debug)]
pub(crate) struct Files {
    folder: PathBuf,
    named: Rc<RefCell<Vec<PathBuf>>>,
}

impl Files {
    /// Names are relative to the folder of `path`; none was named yet.
    pub(crate) fn beside(path: &Path) -> Self {
        Self {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            named: Rc::default(),
        }
    }

    /// These files, with names relative to the folder of `path`.
    pub(crate) fn followed_from(&self, path: &Path) -> Self {
        Self {
            named: self.named.clone(),
            ..Self::beside(path)
        }
    }

    /// The path of a file that is about to be read.
    pub(crate) fn named(&self, name: impl AsRef<Path>) -> PathBuf {
        let path = self.folder.join(name);
        let mut named = self.named.borrow_mut();
        if !named.contains(&path) {
            named.push(path.clone());
        }
        path
    }

    /// All files, in the order of their first names.
    pub(crate) fn all(&self) -> Vec<PathBuf> {
        self.named.borrow().clone()
    }
}
