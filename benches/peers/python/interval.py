"""Means over initial states with their 95 % confidence intervals (Student's t)."""

import numpy as np
import scipy.stats


def mean(values):
    """Return the mean, half of its 95 % confidence interval (None for a single value) and the number of values."""
    values = np.asarray(list(values), float)
    count = len(values)
    within = None
    if count > 1:
        within = float(scipy.stats.t.ppf(0.975, count - 1) * values.std(ddof=1) / np.sqrt(count))
    return {"mean": float(values.mean()), "within": within, "states": count}


def difference(ones, others):
    """Return the mean of the differences `ones` − `others`, two maps from states to values, over the states in both."""
    return mean(ones[state] - others[state] for state in sorted(ones.keys() & others.keys()))
