"""Other people's solvers on the same impacts, for `python -m benchmarks`.

A module whose name ends in `_peer` brings `methods()`, a list of objects with

* `name`, and `family`: methods of one family share a colour;
* `tolerances`, from coarse to fine, at which it is measured;
* `solve(scenes, tolerance, batch)`: an `Answer` with e_n and seconds. `scenes` is a
  `jaximpact.Scene` with fields `(n,)`; `batch` lets it take them all at once on every
  core, else they are solved one after another on one.

A module that cannot be imported, because a package is not installed, is left out; the
packages are the extra `peers` of pyproject.toml.
"""
