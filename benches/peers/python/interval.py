"""Means over initial states with their 95 % intervals (Student's t)."""

import numpy as np
import scipy.stats


def mean(values):
    """Mean, half the 95 % interval (None for a single value) and number of the values."""
    values = np.asarray(list(values), float)
    count = len(values)
    within = None
    if count > 1:
        within = float(scipy.stats.t.ppf(0.975, count - 1) * values.std(ddof=1) / np.sqrt(count))
    return {"mean": float(values.mean()), "within": within, "states": count}


def difference(ones, others):
    """Mean of the differences ones − others of the states that both have; each maps a state to a value."""
    return mean(ones[state] - others[state] for state in sorted(ones.keys() & others.keys()))
