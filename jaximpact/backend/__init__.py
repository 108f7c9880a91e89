"""What runs the integration: machine code of our own, or XLA's programs."""
