"""How far a fit can be trusted: uncertainty, identifiability, residuals, warnings."""
