"""Measurements of speed and accuracy; not part of the package that is installed."""
