"""Minimisation of the objective: methods and starting points."""
