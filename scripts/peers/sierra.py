"""Sierra/SD matrices through iwan against the frequencies of Sierra's own Exodus file.

    python scripts/peers/sierra.py [--iwan PROGRAM] FOLDER/block_a [FOLDER/block_a2 ...]

Fetches nothing: each argument is what NAME_Kaa.m, NAME_Maa.m, NAME_ASetMap.m, NAME_gid.m and NAME-eig.exo begin with, such as those in docs/book/assets
of github.com/sandialabs/sdynpy. The Exodus file (netCDF classic) has the frequencies as its times.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np
from scipy.io import netcdf_file

TOLERANCE = 1e-8


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("names", nargs="+")
    given = arguments.parse_args()
    worst = 0.0
    for name in given.names:
        with netcdf_file(f"{name}-eig.exo", mmap=False) as exodus:
            expected = np.array(exodus.variables["time_whole"][:], dtype=float)
        expected = np.sort(expected[expected > 1.0])
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            base = str(pathlib.Path(name).resolve())
            lines = [f"{key} = {json.dumps(base + tail)}" for key, tail in
                     [("stiffness", "_Kaa.m"), ("mass", "_Maa.m"), ("rows", "_ASetMap.m"), ("numbers", "_gid.m")]]
            (folder / "s.toml").write_text("[matrices]\n" + "\n".join(lines) + "\n")
            command = [given.iwan, "modes", "s.toml", "--count", str(len(expected)), "--json", "--quiet", "--out", "out"]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{name}: {done.stderr}")
        found = json.loads(done.stdout)
        own = np.array(found["stuck"])[: len(expected)]
        off = np.abs(own / expected - 1.0)
        worst = max(worst, off.max())
        print(f"{pathlib.Path(name).name}: {len(expected)} elastic frequencies from {expected[0]:.3f} to {expected[-1]:.3f} Hz, "
              f"largest difference {off.max():.1e}; zero modes {found['zero_modes']['stuck']}; mass {found['size']['total_mass']:.9g}")
    if worst > TOLERANCE:
        raise SystemExit(f"larger than {TOLERANCE}")


if __name__ == "__main__":
    main()
