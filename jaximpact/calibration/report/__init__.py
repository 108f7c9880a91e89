"""The result of a calibration in files: report, tables, figures."""
