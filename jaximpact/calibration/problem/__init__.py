"""The objective of a calibration: unknowns, predictions, residuals and their losses."""
