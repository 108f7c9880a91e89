"""Derivatives of trajectories with respect to block, ground and release."""
