"""The model against what others have published."""
