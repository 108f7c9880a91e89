"""The figures and claims of Dattola, Crosta and di Prisco (2023), recomputed; not part
of the package that is installed."""
