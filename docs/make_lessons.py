"""Compute the scenarios of the studio's lessons and keep their results: small, single precision, xz."""

from __future__ import annotations

import json
import lzma
import sys

import numpy as np
import xarray as xr

from ropewalk.scenario import load
from ropewalk.simulate import simulate
from ropewalk.studio.lesson import FOLDER
from ropewalk.studio.streams import stored

UNUSED = ("velocity", "strain", "contact_speed", "friction_power")  # the page draws none of them
FINEST = {"position": 2.0**-14, "body_position": 2.0**-14, "contact_position": 2.0**-14, "energy": 0.0}  # m
OTHERS = 2.0**-4  # N, to which forces are rounded, so that they compress


def reduced(dataset: xr.Dataset) -> xr.Dataset:
    """Return a result in single precision without the quantities that the page does not draw."""
    unused = [name for name, array in dataset.variables.items() if "sample" in array.dims or not array.size]
    kept = dataset.drop_vars([*unused, *(name for name in UNUSED if name in dataset)])
    for name, array in kept.data_vars.items():
        if array.dtype.kind == "f":
            finest = FINEST.get(str(name), 0.0 if array.attrs["units"] == "1" else OTHERS)
            values = np.round(array.values / finest) * finest if finest else array.values
            kept[name] = (array.dims, values.astype(np.float32), array.attrs)
    kept.attrs["ended"] = json.dumps({key: value for key, value in stored(dataset).items() if key != "curves"})
    return kept


def keep(name: str) -> int:
    """Run a scenario, write its kept result and return its size in bytes."""
    dataset = simulate(load(FOLDER / f"{name}.yaml"))
    kept = reduced(dataset)
    kept.encoding = {}
    for variable in kept.variables.values():
        variable.encoding = {}
    plain = kept.to_netcdf(format="NETCDF3_64BIT", engine="scipy", unlimited_dims=[])
    packed = lzma.compress(bytes(plain), preset=9)
    (FOLDER / f"{name}.nc.xz").write_bytes(packed)
    return len(packed)


if __name__ == "__main__":
    for file in sorted(FOLDER.glob("*.yaml")):
        if file.stem != "lessons" and (len(sys.argv) < 2 or file.stem in sys.argv[1:]):
            print(f"{file.stem}: {keep(file.stem) / 1e3:.0f} kB", flush=True)
