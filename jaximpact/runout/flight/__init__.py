"""Blocks in free flight: ballistics and contact detection."""
