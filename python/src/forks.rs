//! Work after a fork. `multiprocessing` may fork this process, and the threads of a pool stay behind: whoever
//! gives work to rayon's global pool in a child waits for ever. So a child has a pool of its own.

use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// The process that loaded this module.
static LOADED_IN: OnceLock<u32> = OnceLock::new();
/// The pool of a forked process.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Remembers which process has the global pool.
pub(crate) fn remember_this_process() {
    LOADED_IN.get_or_init(process::id);
}

/// Does work that may be shared out to threads.
///
/// # Errors
/// Where a forked process cannot start them.
pub(crate) fn shared_out<T: Send>(
    work: impl FnOnce() -> T + Send,
) -> Result<T, ThreadPoolBuildError> {
    let this = process::id();
    if LOADED_IN.get() == Some(&this) {
        return Ok(work());
    }
    let mut forked = FORKED.lock().unwrap_or_else(PoisonError::into_inner);
    let pool = match &*forked {
        Some((owner, pool)) if *owner == this => Arc::clone(pool),
        _ => {
            let pool = Arc::new(ThreadPoolBuilder::new().build()?);
            // That of the parent has no threads here; ending it would wait for them.
            std::mem::forget(forked.replace((this, Arc::clone(&pool))));
            pool
        }
    };
    drop(forked);
    Ok(pool.install(work))
}
