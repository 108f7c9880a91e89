"""Checks that a wheel holds every file of the package that git knows, and no others.

Data files beside the modules (py.typed, the machine code's driver, tables, templates)
are needed at run time; tests, benchmarks, the recomputed paper and documents are not
for users' environments.
"""

import subprocess
import sys
import zipfile

listed = subprocess.run(
    ["git", "ls-files", "jaximpact"], capture_output=True, text=True, check=True
)
package = {*listed.stdout.splitlines()}
with zipfile.ZipFile(sys.argv[1]) as wheel:
    held = {name for name in wheel.namelist() if ".dist-info/" not in name}
missing, foreign = sorted(package - held), sorted(held - package)
if missing or foreign:
    sys.exit(f"the wheel lacks {missing} and should not hold {foreign}")
print(f"{len(held)} files, all of jaximpact/ and nothing else")
