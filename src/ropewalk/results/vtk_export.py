"""Export for ParaView and other readers of VTK files: a `.pvd` that lists one `.vtp` for each frame.

The format is described in the VTK file formats document, https://docs.vtk.org/en/latest/vtk_file_formats/. Arrays are
written inline, compressed and in base64, so that every file is an XML document.
"""

from __future__ import annotations

import base64
import re
import struct
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.contract import path_name
from ropewalk.results.files import ResultError
from ropewalk.results.frame import Array
from ropewalk.results.nets import Indices, in_space, net_names, triangles
from ropewalk.results.statistics import lines

if TYPE_CHECKING:
    import xarray as xr

SUFFIX = ".pvd"
KINDS = ("node", "contact", "body")  # values 0, 1, 2 of the point data `kind`
_OURS = re.compile(r"frame_\d{6,}\.vtp")
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32"}
_LEVEL = 4  # of the compression: more takes much longer and gains little

Progress = Callable[[float], None]
Element = ElementTree.Element


def export(dataset: xr.Dataset, path: str | Path, *, progress: Progress | None = None) -> None:
    """Write a result for ParaView: `OUT.pvd`, and next to it the folder `OUT` with one `.vtp` for each frame.

    A link is a stroke between two nodes, a cell of a net a triangle, a contact or body a single point; loads off
    their lines are left out. Point data: `velocity`, `xi`, `kind` (0 node, 1 contact, 2 body), and at contacts
    `contact_force`, `hold_force` and `contact_speed`. Cell data: `tension` and `strain` of links, `cell_tension` of
    triangles, `name`, a number in the list `names` of the field data. What is not known is NaN, but forces are zero.
    `load_path` stands for the time where there is none.

    Args:
        dataset: a result with at least one frame.
        path: where to write; it ends in `.pvd`. Frames that an earlier export left in the folder are removed.
        progress: is told the fraction done.

    Raises:
        ResultError: another suffix, no frames, or a file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != SUFFIX:
        raise ResultError(f"{path}: an export for ParaView ends in {SUFFIX}")
    count = dataset.sizes[path_name(dataset)]
    if not count:
        raise ResultError("there is nothing to export: the result has no frames")
    folder, shape = path.with_suffix(""), _Topology(dataset)
    root = Element("VTKFile", type="Collection", version="1.0", byte_order=_order())
    collection = ElementTree.SubElement(root, "Collection")
    try:
        folder.mkdir(exist_ok=True)
        for old in folder.iterdir():
            if _OURS.fullmatch(old.name):
                old.unlink()
        for k, instant in enumerate(dataset[path_name(dataset)].values.tolist()):
            name = f"frame_{k:06d}.vtp"
            _write(_frame(dataset, shape, k, instant), folder / name)
            place = f"{folder.name}/{name}"
            ElementTree.SubElement(collection, "DataSet", timestep=repr(instant), group="", part="0", file=place)
            if progress is not None:
                progress((k + 1) / count)
        _write(root, path)
    except OSError as problem:
        raise ResultError(f"{path}: cannot be written ({problem})") from problem


class _Topology:
    """What stays the same in all frames: strokes, triangles, and which name belongs to which point and cell."""

    def __init__(self, dataset: xr.Dataset) -> None:
        node_line, link_line = dataset["line"].values, dataset["link_line"].values
        self.triangles = triangles(dataset)
        strokes = np.zeros((dataset.sizes["link"], 2), dtype=np.intp)
        for line in lines(dataset):
            nodes = np.flatnonzero(node_line == line)
            strokes[link_line == line] = np.stack((nodes[:-1], nodes[1:]), axis=1)
        self.strokes = strokes
        loads, bodies = dataset["load"].values.tolist(), dataset["body"].values.tolist()
        self.names = list(dict.fromkeys([*lines(dataset), *net_names(dataset), *loads, *bodies]))
        nets: object = dataset["cell_net"].values if "cell_net" in dataset.coords else ()
        self.single = self._numbers([*loads, *bodies])
        self.link = self._numbers(link_line)
        self.cell = self._numbers(nets)
        self.node = self._numbers(node_line)

    def _numbers(self, names: object) -> NDArray[np.int32]:
        place = {name: i for i, name in enumerate(self.names)}
        return np.array([place[str(name)] for name in np.asarray(names).tolist()], dtype=np.int32)


def _frame(dataset: xr.Dataset, shape: _Topology, k: int, instant: float) -> Element:
    """One frame as a VTK PolyData document."""
    now = dataset.isel({path_name(dataset): k})
    nodes, links, cells = len(shape.node), len(shape.link), len(shape.cell)
    places = np.concatenate([in_space(now[name].values) for name in ("contact_position", "body_position")])
    there = np.isfinite(places).all(axis=1)
    contacts = np.flatnonzero(there[: dataset.sizes["contact"]])
    bodies = np.flatnonzero(there[dataset.sizes["contact"] :])
    extra = len(contacts) + len(bodies)
    points = np.concatenate((in_space(now["position"].values), places[there]))

    root = Element("VTKFile", type="PolyData", version="1.0", byte_order=_order(), header_type="UInt64",
                   compressor="vtkZLibDataCompressor")  # fmt: skip
    poly = ElementTree.SubElement(root, "PolyData")
    field = ElementTree.SubElement(poly, "FieldData")
    _array(field, "TimeValue", np.array([instant]), NumberOfTuples="1")
    _names(field, shape.names)
    sizes = {"NumberOfPoints": nodes + extra, "NumberOfVerts": extra, "NumberOfLines": links, "NumberOfPolys": cells}
    piece = ElementTree.SubElement(poly, "Piece", {name: str(size) for name, size in sizes.items()}, NumberOfStrips="0")

    def beside(name: str, of_contacts: Array, rest: float) -> Array:
        """Values of contacts after the same value for all nodes, and bodies with it, too."""
        out = np.full((nodes + extra, *of_contacts.shape[1:]), rest)
        out[nodes : nodes + len(contacts)] = of_contacts[contacts]
        return out

    speeds = np.full((extra, 3), np.nan)
    speeds[len(contacts) :] = in_space(now["body_velocity"].values)[bodies]
    kind = np.repeat(np.arange(3, dtype=np.int32), (nodes, len(contacts), len(bodies)))
    single = shape.single[there]
    data = ElementTree.SubElement(piece, "PointData", Vectors="velocity")
    _array(data, "velocity", _short(np.concatenate((in_space(now["velocity"].values), speeds))))
    xi = beside("contact_xi", now["contact_xi"].values, np.nan)
    xi[:nodes] = now["xi"].values
    _array(data, "xi", _short(xi))
    _array(data, "kind", kind)
    _array(data, "name", np.concatenate((shape.node, single)))
    for name in ("contact_force", "hold_force"):
        _array(data, name, _short(np.nan_to_num(beside(name, in_space(now[name].values), 0.0))))
    _array(data, "contact_speed", _short(beside("contact_speed", now["contact_speed"].values, np.nan)))

    data = ElementTree.SubElement(piece, "CellData", Scalars="tension")
    for name in ("tension", "strain"):
        _array(data, name, _short(_padded(now[name].values, extra, cells)))
    if "cell_tension" in now:
        _array(data, "cell_tension", _short(_padded(now["cell_tension"].values, extra + links, 0)))
    _array(data, "name", np.concatenate((single, shape.link, shape.cell)))

    _array(ElementTree.SubElement(piece, "Points"), "Points", points)
    singles: Indices = np.arange(nodes, nodes + extra, dtype=np.intp)[:, None]
    for part, corners in (("Verts", singles), ("Lines", shape.strokes), ("Polys", shape.triangles)):
        found = ElementTree.SubElement(piece, part)
        _array(found, "connectivity", corners.astype(np.int64).ravel())
        _array(found, "offsets", corners.shape[1] * np.arange(1, len(corners) + 1, dtype=np.int64))
    return root


def _padded(values: Array, before: int, after: int) -> Array:
    """Values with NaN for the cells before and behind them."""
    width = [(before, after)] + [(0, 0)] * (values.ndim - 1)
    return np.pad(values, width, constant_values=np.nan)


def _short(values: Array) -> NDArray[np.float32]:
    """Values with the seven digits that pictures need; positions keep all of theirs."""
    return values.astype(np.float32)


def _array(parent: Element, name: str, values: NDArray[np.generic], **more: str) -> None:
    """Add a data array: compressed in one block, base64."""
    about = {"type": _TYPES[values.dtype.str[1:]], "Name": name, "format": "binary", **more}
    if values.ndim > 1:
        about["NumberOfComponents"] = str(values.shape[1])
    raw = np.ascontiguousarray(values).tobytes()
    packed = zlib.compress(raw, _LEVEL)
    header = struct.pack("=4Q", 1, len(raw), 0, len(packed)) if raw else struct.pack("=3Q", 0, 0, 0)
    text = base64.b64encode(header) + (base64.b64encode(packed) if raw else b"")
    ElementTree.SubElement(parent, "DataArray", about).text = text.decode("ascii")


def _names(parent: Element, names: list[str]) -> None:
    """Add the list of names: characters as numbers, each name closed by a zero."""
    codes = b"".join(name.encode() + b"\0" for name in names)
    about = {"type": "String", "Name": "names", "format": "ascii", "NumberOfTuples": str(len(names))}
    ElementTree.SubElement(parent, "Array", about).text = " ".join(map(str, codes))


def _write(root: Element, file: Path) -> None:
    ElementTree.ElementTree(root).write(file, encoding="utf-8", xml_declaration=True)


def _order() -> str:
    return "LittleEndian" if sys.byteorder == "little" else "BigEndian"
