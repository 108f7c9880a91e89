"""The integration of an impact in time: method, steps, and landing on events."""
