//! Computes the Pareto front of solver methods: the best combinations of speed and error.

/// Returns the indices of those points (speed, error) for which no other point is at least as fast and at least as
/// accurate, by increasing speed. Of equal points, the first is returned.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    // The fastest point comes first. Among equally fast points, the most accurate point comes first.
    order.sort_by(|&one, &other| {
        let ((speed, error), (other_speed, other_error)) = (points[one], points[other]);
        other_speed.total_cmp(&speed).then(error.total_cmp(&other_error))
    });
    let mut front = Vec::new();
    let mut least_error = f64::INFINITY;
    for index in order {
        if points[index].1 < least_error {
            least_error = points[index].1;
            front.push(index);
        }
    }
    front.reverse();
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(1.0, 0.1), (2.0, 0.2), (1.5, 0.3), (4.0, 0.2), (0.5, 0.1), (5.0, 0.9)];
        assert_eq!(pareto_front(&points), [0, 3, 5]);
        assert_eq!(pareto_front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
        assert!(pareto_front(&[]).is_empty());
    }
}
