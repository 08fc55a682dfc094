"""Is one set of numbers enough? Calibrated numbers held against tolerances, records, levels, times and modes."""
