"""Back-analysis of a slope: ground parameters from where blocks stopped and how they
passed.

Data sets are simulated for candidates from the prior, reduced to summary statistics,
and the posterior is found by regression on them. `calibrate_slope` does it all.
"""
