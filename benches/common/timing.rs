//! Timing by the shortest of all repeats. The shortest time has the fewest interruptions, and is the number that
//! differs least between two runs on one machine.

use std::time::{Duration, Instant};

use criterion::Criterion;

/// Returns criterion with few samples, so that all benchmarks together take some minutes.
pub fn criterion() -> Criterion {
    Criterion::default()
        .sample_size(12)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(900))
        .without_plots()
        .configure_from_args()
}

/// Measures `routine` with criterion under `name`. Returns the shortest time of one call, s.
pub fn least_secs(criterion: &mut Criterion, name: &str, mut routine: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    criterion.bench_function(name, |bencher| {
        bencher.iter_custom(|count| {
            let start = Instant::now();
            for _ in 0..count {
                routine();
            }
            let elapsed = start.elapsed();
            least = least.min(elapsed.as_secs_f64() / count as f64);
            elapsed
        });
    });
    least
}
