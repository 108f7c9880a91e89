"""Minimisation of the objective: methods, starting points, kept fits."""
