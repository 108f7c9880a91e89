"""The model: geometry, the ground's laws, balance, and the ends of an impact."""
