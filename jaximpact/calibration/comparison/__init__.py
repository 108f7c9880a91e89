"""Laws compared on the same tests: how well each predicts what it was not fitted to."""
