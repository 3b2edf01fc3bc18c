//! Work shared out over threads so that no bit hangs on their number: items are made one by one into their places, and sums
//! are added up in stretches of one length, whose sums are added in order.

use std::cell::Cell;
use std::hint::spin_loop;
use std::ops::Range;
use std::time::{Duration, Instant};

use crate::error::{Error, Result, check};
use rayon::Yield;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

/// Items of which one sum is made at a time.
const STRETCH: usize = 4096;
/// Items, of any kind, from which on threads are worth it. On two, a step of 40 sweeps took 0.7 of the time of one thread in a
/// pile of 10,000 grains, but 1.2 times as long where 10,000 discs touched less, and with 5,000 grains; it took 0.7 to 0.8 with
/// 50,000 discs.
const WORTH_IT: usize = 16_384;
/// How long a thread that was roused waits for work before it sleeps. Longer than what one thread does by itself between
/// two sweeps; where a thread was let sleep between them, waking it cost as much as it then did.
const PATIENCE: Duration = Duration::from_micros(200);

thread_local! {
    /// True where what this thread does is shared out.
    static SHARES: Cell<bool> = const { Cell::new(false) };
    /// True where this thread is kept awake.
    static IS_AWAKE: Cell<bool> = const { Cell::new(false) };
}

/// More threads than the largest machines have cores.
const MOST_THREADS: usize = 1024;
const ASKED: &str = "RAYON_NUM_THREADS";

/// Refuses a number of threads that no machine has.
///
/// # Errors
/// Names the variable that asks for it.
pub fn check_threads() -> Result<()> {
    let asked = std::env::var(ASKED).unwrap_or_default();
    let is_sound = !asked.parse::<usize>().is_ok_and(|asked| asked > MOST_THREADS);
    check(is_sound, ASKED, asked, format!("a number of threads up to {MOST_THREADS}"))
}

/// Makes the threads that work is shared out over, where there are none yet.
///
/// # Errors
/// Where the system makes none.
pub fn make_threads() -> Result<()> {
    check_threads()?;
    match rayon::ThreadPoolBuilder::new().build_global() {
        // Without a source it only says that they are there.
        Err(error) if std::error::Error::source(&error).is_some() => {
            let allowed = "as few as the system makes; RAYON_NUM_THREADS=1 asks for one";
            Err(Error::value("the number of threads", format!("too high ({error})"), allowed))
        }
        _ => Ok(()),
    }
}

/// Does work on so many items on the threads of the pool, if they are worth it, and if nothing else is done there. Whoever
/// is on a thread of a pool already is one of several that share it, and is left alone: waiting for a part of its
/// work a thread takes up whatever it finds, and might come back from a whole run of another.
pub(crate) fn together<R: Send>(count: usize, work: impl FnOnce() -> R + Send) -> R {
    // A small step asks for no pool: asking makes it.
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

/// Does work, on a thread of a pool, whose parts are shared out.
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

/// True where parts of what is done now go to other threads.
pub(crate) fn are_there() -> bool {
    SHARES.get()
}

/// Has the other threads wait for work for a while, where parts of it go to them: between two of its calls they would
/// fall asleep.
pub(crate) fn rouse() {
    if are_there() {
        (1..rayon::current_num_threads()).for_each(|_| rayon::spawn(stay_awake));
    }
}

/// Does what there is to do, until there was nothing for a while. A thread that comes here while it waits for another
/// leaves again in time, whatever that waits for. Where there is one thread, as in a browser, whose programs have no such
/// clock, it is never called.
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

/// Fills a list with so many items, each by its number. What it held before goes; its memory stays.
pub(crate) fn fill<T: Send>(list: &mut Vec<T>, count: usize, item: impl Fn(usize) -> T + Sync) {
    list.clear();
    if list.capacity() < count {
        // With room for what the next steps may find, so that none allocates once a pile is at rest.
        list.reserve(count.next_power_of_two());
    }
    if are_worth_it(count) {
        (0..count).into_par_iter().with_min_len(STRETCH / 4).map(&item).collect_into_vec(list);
    } else {
        list.extend((0..count).map(item));
    }
}

/// Adds up so many items: `sum` is that of a stretch of them, and `add` gets one after the other.
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
        // None is left that would keep a pool from its end.
        drop(pool);
    }

    #[test]
    fn sums_and_lists_are_the_same_on_any_number_of_threads() {
        // Sums of such numbers differ in the order in which they are added.
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
