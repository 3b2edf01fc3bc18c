//! Threads that give way to all others.

/// Cores that are left to what is in front.
#[cfg(target_os = "linux")]
const LEFT: usize = 1;
/// Where the system is not asked for a lower priority, another one for the window.
#[cfg(not(target_os = "linux"))]
const LEFT: usize = 2;

/// How many cores are idle while a world runs: none where there is one.
pub(super) fn idle_cores() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    cores.saturating_sub(LEFT)
}

/// Gives the thread that calls it the lowest priority. On Linux a priority is a thread's own, and that of the
/// "process" None is that of the calling thread (setpriority(2), "C library/kernel differences").
#[cfg(target_os = "linux")]
pub(super) fn give_way() {
    const NICEST: i32 = 19;
    // Where it is refused, the thread shares its core as any other would.
    let _ = rustix::process::setpriority_process(None, NICEST);
}

#[cfg(not(target_os = "linux"))]
pub(super) fn give_way() {}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn one_thread_gives_way_and_the_others_stay() {
        let nice = || rustix::process::getpriority_process(None).unwrap();
        let before = nice();
        let lowest = std::thread::spawn(move || {
            give_way();
            nice()
        });
        assert_eq!(lowest.join().unwrap(), 19);
        assert_eq!(nice(), before);
    }
}
