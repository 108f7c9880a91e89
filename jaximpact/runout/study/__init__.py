"""Run-out study from its file to its report."""
