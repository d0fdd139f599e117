//! What the fuzz targets share.

mod images;

pub use images::exr_images;

use cap::Cap;
use std::path::Path;
use std::{alloc::System, fs};

/// Small inputs have no claim to more; an allocation beyond it ends the run.
#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, 1 << 30);

/// Writes the inputs from which a target starts to `corpus/NAME`.
///
/// Also takes back the hook by which libfuzzer-sys ends the run at every panic, even one that is
/// caught: a panic that leaves the target still ends it.
///
/// # Panics
/// If they cannot be written.
pub fn start(name: &str, seeds: &[Vec<u8>]) {
    drop(std::panic::take_hook());
    let folder = Path::new("corpus").join(name);
    fs::create_dir_all(&folder).expect("the folder fuzz/ is writable");
    for (i, seed) in seeds.iter().enumerate() {
        fs::write(folder.join(format!("seed-{i}")), seed).expect("the corpus is writable");
    }
}
