//! What a pass takes of the heap.

use std::sync::atomic::AtomicBool;
use tyndall_core::{PassContext, PassError};
use tyndall_driver::PassStreams;

/// For the queues of the thread pool.
const BASE: u64 = 1 << 20;

/// A pass that may take so many bytes.
pub type Bounded<'a> = &'a dyn Fn(u64, &PassContext<'_, PassStreams>) -> Result<(), PassError>;

/// A test of what passes take, in bytes, against what they may: from 4 MiB on always a quarter more,
/// until all have enough. `heap` is how much of it is taken now, and was at most, of a process that
/// does nothing else.
///
/// # Panics
/// If a pass takes more than it may but for 1 MiB, or fails for another reason.
pub fn check_memory(passes: &[Bounded<'_>], heap: impl Fn() -> [usize; 2]) {
    let (streams, running) = (PassStreams::new(1, 0), AtomicBool::new(false));
    let cx = PassContext::new(0, &streams, &running);
    let (mut allowed, mut enough) = (4 << 20, vec![false; passes.len()]);
    while enough.contains(&false) {
        for (i, pass) in passes.iter().enumerate() {
            if enough[i] {
                continue;
            }
            let [before, _] = heap();
            let pass = pass(allowed, &cx);
            let peak = (heap()[1] - before) as u64;
            assert!(
                peak <= allowed + BASE,
                "pass {i}: {peak} bytes of {allowed}"
            );
            match pass {
                Ok(()) => enough[i] = true,
                Err(PassError::Memory { needed, .. }) => assert!(needed > allowed),
                Err(other) => panic!("{other}"),
            }
        }
        allowed += allowed / 4;
    }
}
