"""Blocks on the ground: rolling, sliding and slope breaks."""
