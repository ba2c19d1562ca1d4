"""Newton's method, the mean-offset constraint, and sparse factorization behind one interface."""
