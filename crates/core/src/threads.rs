//! Parallel loops and sums whose results are bitwise the same for any number of threads. Each item of a list is
//! computed independently of the others. A sum is divided into partial sums over a fixed number of items, and these
//! partial sums are added in order.

use std::cell::Cell;
use std::hint::spin_loop;
use std::ops::Range;
use std::time::{Duration, Instant};

use crate::error::{Error, Result, check};
use rayon::Yield;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

/// Number of items that are added to one partial sum. It does not depend on the number of threads: if it did, sums
/// would round differently with another number of threads. With fewer items per partial sum, more partial sums have to
/// be distributed among the threads; with more items, a short list has too few partial sums for several threads.
const STRETCH: usize = 4096;
/// Smallest number of items (grains or contacts) for which a loop runs on several threads. Loops over fewer items run
/// on one thread, because several threads may take longer. With two threads, a step of 40 sweeps took 0.7 of the time
/// of one thread in a pile of 10,000 grains, and 0.7 to 0.8 with 50,000 discs. But it took 1.2 times as long with
/// 10,000 discs that had fewer contacts, and with 5,000 grains.
const WORTH_IT: usize = 16_384;
/// Time for which a thread without work waits for more work before it sleeps. It is longer than the serial work
/// between two sweeps of the solver. When threads slept between sweeps, waking them took as long as their work in the
/// sweep.
const PATIENCE: Duration = Duration::from_micros(200);

thread_local! {
    /// True if loops and sums of this thread are divided among several threads.
    static SHARES: Cell<bool> = const { Cell::new(false) };
    /// True if this thread is already in the loop of [`stay_awake`], in which it waits for work.
    static IS_AWAKE: Cell<bool> = const { Cell::new(false) };
}

/// Largest allowed number of threads. It is larger than the number of cores of the largest machines.
const MOST_THREADS: usize = 1024;
const ASKED: &str = "RAYON_NUM_THREADS";

/// Checks the number of threads that the environment variable `RAYON_NUM_THREADS` sets.
///
/// # Errors
/// If the number is above 1,024. The error names the environment variable.
pub fn check_threads() -> Result<()> {
    let asked = std::env::var(ASKED).unwrap_or_default();
    let is_sound = !asked.parse::<usize>().is_ok_and(|asked| asked > MOST_THREADS);
    check(is_sound, ASKED, asked, format!("a number of threads up to {MOST_THREADS}"))
}

/// Creates the thread pool if it does not exist yet.
///
/// # Errors
/// If the operating system cannot create the threads.
pub fn make_threads() -> Result<()> {
    check_threads()?;
    match rayon::ThreadPoolBuilder::new().build_global() {
        // An error without a source only means that the thread pool already exists.
        Err(error) if std::error::Error::source(&error).is_some() => {
            let allowed = "as few as the system makes; RAYON_NUM_THREADS=1 asks for one";
            Err(Error::value("the number of threads", format!("too high ({error})"), allowed))
        }
        _ => Ok(()),
    }
}

/// Runs `work` on `count` items, with several threads if that is faster than one thread. If the caller is already on a
/// thread of a pool, as when a study runs many simulations at the same time, the whole work stays on this thread. If
/// the work were divided, this thread could start another simulation while it waits for the other threads, and return
/// only when that simulation ends.
pub(crate) fn together<R: Send>(count: usize, work: impl FnOnce() -> R + Send) -> R {
    // Check the count first, because asking for the number of threads creates the pool.
    let is_alone = || rayon::current_thread_index().is_some() || rayon::current_num_threads() == 1;
    if count < WORTH_IT || is_alone() {
        return work();
    }
    rayon::scope(|_| {
        share(|| {
            rouse();
            work()
        })
    })
}

/// Runs `work` and divides its loops and sums among the threads of the pool. The caller must be on a thread of the
/// pool.
pub(crate) fn share<R>(work: impl FnOnce() -> R) -> R {
    struct Before(bool);
    impl Drop for Before {
        fn drop(&mut self) {
            SHARES.set(self.0);
        }
    }
    let _before = Before(SHARES.replace(rayon::current_num_threads() > 1));
    work()
}

/// True if loops and sums of this thread are divided among several threads.
pub(crate) fn are_there() -> bool {
    SHARES.get()
}

/// Keeps the other threads of the pool awake for [`PATIENCE`] after their last task, if the loops of this thread are
/// divided among them. Without this call these threads would fall asleep between two loops.
pub(crate) fn rouse() {
    if are_there() {
        (1..rayon::current_num_threads()).for_each(|_| rayon::spawn(stay_awake));
    }
}

/// Executes tasks of the thread pool until there has been no task for [`PATIENCE`]. A thread that waits for this thread
/// is delayed by hardly more than [`PATIENCE`]. The function is never called with a single thread, as in a browser,
/// where `Instant` does not exist.
fn stay_awake() {
    if IS_AWAKE.replace(true) {
        return;
    }
    let mut since = Instant::now();
    while since.elapsed() < PATIENCE {
        if rayon::yield_now() == Some(Yield::Executed) {
            since = Instant::now();
        } else {
            (0..32).for_each(|_| spin_loop());
        }
    }
    IS_AWAKE.set(false);
}

fn are_worth_it(count: usize) -> bool {
    count >= WORTH_IT && are_there()
}

/// Fills a list with `count` items, each computed from its index. The previous items are removed, but the allocated
/// memory is used again.
pub(crate) fn fill<T: Send>(list: &mut Vec<T>, count: usize, item: impl Fn(usize) -> T + Sync) {
    list.clear();
    if list.capacity() < count {
        // Reserve more memory than needed now, so that later steps do not allocate once a pile is at rest.
        list.reserve(count.next_power_of_two());
    }
    if are_worth_it(count) {
        (0..count).into_par_iter().with_min_len(STRETCH / 4).map(&item).collect_into_vec(list);
    } else {
        list.extend((0..count).map(item));
    }
}

/// Computes a sum over `count` items. `sum` returns the partial sum over a range of items, and `add` receives the
/// partial sums in order.
pub(crate) fn add_up<S: Send>(
    count: usize,
    sum: impl Fn(Range<usize>) -> S + Sync,
    mut add: impl FnMut(S),
) {
    let stretches = count.div_ceil(STRETCH);
    let of = |stretch: usize| sum(stretch * STRETCH..count.min((stretch + 1) * STRETCH));
    if are_worth_it(count) {
        let sums: Vec<S> = (0..stretches).into_par_iter().map(&of).collect();
        sums.into_iter().for_each(add);
    } else {
        (0..stretches).for_each(|stretch| add(of(stretch)));
    }
}

#[cfg(test)]
mod tests {
    use rayon::ThreadPoolBuilder;

    use super::*;

    #[test]
    fn a_run_among_others_in_a_pool_is_left_alone() {
        let pool = ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        assert!(!pool.install(|| together(10 * STRETCH, are_there)));
        assert_eq!(together(10 * STRETCH, are_there), rayon::current_num_threads() > 1);
        assert!(!together(STRETCH, are_there));
        assert!(!are_there());
    }

    #[test]
    fn threads_that_are_kept_awake_do_what_there_is_and_go_to_sleep() {
        let pool = ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        let mut list = Vec::new();
        pool.install(|| {
            share(|| {
                for round in 0..200 {
                    rouse();
                    fill(&mut list, 5 * STRETCH, |k| k + round);
                }
            });
        });
        assert!(list.iter().enumerate().all(|(k, &item)| item == k + 199));
        // No waiting thread may prevent the pool from ending.
        drop(pool);
    }

    #[test]
    fn sums_and_lists_are_the_same_on_any_number_of_threads() {
        // The sum of these numbers depends on the order of addition.
        let number = |k: usize| (k as f64 * 0.7).sin() * 10f64.powi((k % 13) as i32);
        let count = 5 * STRETCH + 17;
        let result = |threads: usize| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                share(|| {
                    let (mut list, mut sum) = (vec![1.0], 0.0);
                    fill(&mut list, count, number);
                    add_up(
                        count,
                        |of| list[of].iter().sum::<f64>(),
                        |of_stretch| sum += of_stretch,
                    );
                    (list, sum.to_bits())
                })
            })
        };
        let (list, sum) = result(1);
        assert_eq!(list.len(), count);
        assert!(list.iter().enumerate().all(|(k, &item)| item == number(k)));
        let in_one = list.iter().sum::<f64>().to_bits();
        assert_ne!(sum, in_one, "the numbers tell one order from another");
        for threads in [2, 3, 7] {
            assert_eq!(result(threads), (list.clone(), sum));
        }
    }
}
