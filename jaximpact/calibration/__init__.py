"""Soil parameters from measured impacts, with what the data do not determine."""
