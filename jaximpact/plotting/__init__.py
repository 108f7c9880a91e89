"""The drawing of an impact, and the style of all drawings."""
