"""What ParaView gets: XML that says what the result says, one file for each frame, and a list of them."""

from __future__ import annotations

import base64
import struct
import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import spatial_cases as cases
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.results import ResultError, export

FEW = np.linspace(0.0, 2.0, 5)
TYPES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4"}


def array(element: ElementTree.Element) -> np.ndarray:
    """Decode a data array by the rules of the format: a header of its own, then the blocks."""
    text = element.text
    count = struct.unpack("=Q", base64.b64decode(text[:12])[:8])[0]
    size = 8 * (3 + count)
    length = -(-size // 3) * 4  # of the header in base64
    head = struct.unpack(f"={3 + count}Q", base64.b64decode(text[:length])[:size])
    rest = base64.b64decode(text[length:])
    raw = zlib.decompress(rest) if count else b""
    assert len(raw) == head[0] * head[1]
    if count:
        assert head[3] == len(rest)
    values = np.frombuffer(raw, TYPES[element.get("type")])
    components = element.get("NumberOfComponents")
    return values if components is None else values.reshape(-1, int(components))


class Read:
    """A `.vtp` as arrays by section and name."""

    def __init__(self, file: Path) -> None:
        root = ElementTree.parse(file).getroot()
        self.about = dict(root.attrib)
        self.piece = root.find("PolyData/Piece")
        self.parts = {part.tag: {a.get("Name"): array(a) for a in part} for part in self.piece}
        self.instant = array(root.find("PolyData/FieldData/DataArray"))
        codes = root.find("PolyData/FieldData/Array").text.split()
        self.names = bytes(map(int, codes)).decode().split("\0")[:-1]

    def size(self, name: str) -> int:
        return int(self.piece.get(f"NumberOf{name}"))


@pytest.fixture(scope="module")
def tent():
    return cases.net(times=FEW, side=4, ropes=True)


def test_the_list_names_every_frame_with_its_time(tent, tmp_path):
    done = []
    export(tent, tmp_path / "tent.pvd", progress=done.append)
    root = ElementTree.parse(tmp_path / "tent.pvd").getroot()
    assert root.get("type") == "Collection"
    listed = root.findall("Collection/DataSet")
    assert [float(entry.get("timestep")) for entry in listed] == FEW.tolist()
    files = [tmp_path / entry.get("file") for entry in listed]
    assert sorted(files) == sorted((tmp_path / "tent").iterdir())
    assert [float(Read(file).instant[0]) for file in files] == FEW.tolist()
    assert done[-1] == 1.0


def test_points_strokes_and_triangles_are_those_of_the_result(tent, tmp_path):
    export(tent, tmp_path / "tent.pvd")
    frame = Read(tmp_path / "tent" / "frame_000002.vtp")
    points = frame.parts["Points"]["Points"]
    np.testing.assert_array_equal(points[:36], tent["position"].values[2])
    np.testing.assert_array_equal(points[36:], tent["contact_position"].values[2])
    assert frame.size("Points") == len(points) == 37
    assert (frame.size("Verts"), frame.size("Lines"), frame.size("Polys")) == (1, 16, 18)
    strokes = frame.parts["Lines"]["connectivity"].reshape(-1, 2)
    assert strokes[3:5].tolist() == [[3, 4], [5, 6]]  # no stroke joins two lines
    np.testing.assert_array_equal(frame.parts["Polys"]["connectivity"].reshape(-1, 3), tent["cell_node"].values)
    np.testing.assert_array_equal(frame.parts["Polys"]["offsets"], np.arange(3, 55, 3))
    assert frame.parts["Verts"]["connectivity"].tolist() == [36]


def test_data_belong_to_their_points_and_cells(tent, tmp_path):
    export(tent, tmp_path / "tent.pvd")
    frame = Read(tmp_path / "tent" / "frame_000002.vtp")
    cell, point = frame.parts["CellData"], frame.parts["PointData"]
    unknown = [np.nan]
    np.testing.assert_allclose(cell["tension"], [*unknown, *tent["tension"].values[2], *(18 * unknown)], rtol=1e-6)
    np.testing.assert_allclose(cell["cell_tension"][17:], tent["cell_tension"].values[2], rtol=1e-6)
    assert np.isnan(cell["cell_tension"][:17]).all()
    assert [frame.names[k] for k in cell["name"]] == ["person", *tent["link_line"].values, *(18 * ["net"])]
    assert [frame.names[k] for k in point["name"]] == [*tent["line"].values, "person"]
    assert point["kind"].tolist() == [0] * 36 + [1]
    assert point["contact_force"][-1].tolist() == [0.0, 20.0, -700.0]
    assert not point["contact_force"][:-1].any()
    np.testing.assert_array_equal(point["velocity"][:36], tent["velocity"].values[2])
    assert point["xi"][:5].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    for section, size in (("PointData", 37), ("CellData", 35)):
        assert {len(values) for values in frame.parts[section].values()} == {size}


def test_bodies_are_points_and_loads_off_the_line_are_left_out(tmp_path):
    bridge = cases.bridge(times=FEW)
    gone = bridge.assign(contact_position=bridge["contact_position"].where(bridge["time"] < 0.9))
    export(gone, tmp_path / "bridge.pvd")
    there, away = (Read(tmp_path / "bridge" / f"frame_00000{k}.vtp") for k in (0, 4))
    assert there.parts["PointData"]["kind"][-2:].tolist() == [1, 2]
    assert away.parts["PointData"]["kind"][-2:].tolist() == [0, 2]
    assert away.names[away.parts["CellData"]["name"][0]] == "walker.body"
    np.testing.assert_array_equal(away.parts["Points"]["Points"][-1], bridge["body_position"].values[4, 0])


def test_a_plane_result_has_y_zero_and_no_triangles(result, tmp_path):
    export(result.isel(time=[10]), tmp_path / "rope.pvd")
    frame = Read(tmp_path / "rope" / "frame_000000.vtp")
    np.testing.assert_array_equal(frame.parts["Points"]["Points"][:41, [0, 2]], result["position"].values[10])
    assert not frame.parts["Points"]["Points"][:, 1].any()
    assert frame.parts["Polys"]["connectivity"].size == 0
    assert "cell_tension" not in frame.parts["CellData"]


def test_a_load_path_stands_for_the_time(tmp_path):
    export(cases.bridge(times=[0.0, 0.7], path="load_path"), tmp_path / "slow.pvd")
    listed = ElementTree.parse(tmp_path / "slow.pvd").getroot().findall("Collection/DataSet")
    assert [entry.get("timestep") for entry in listed] == ["0.0", "0.7"]


def test_frames_of_an_earlier_export_go_and_other_files_stay(tent, tmp_path):
    export(tent, tmp_path / "tent.pvd")
    (tmp_path / "tent" / "mine.vtp").write_text("mine")
    export(tent.isel(time=[0]), tmp_path / "tent.pvd")
    assert sorted(file.name for file in (tmp_path / "tent").iterdir()) == ["frame_000000.vtp", "mine.vtp"]


def test_exports_that_cannot_be_made_are_refused_clearly(tent, tmp_path):
    with pytest.raises(ResultError, match=r"ends in \.pvd"):
        export(tent, tmp_path / "tent.vtk")
    with pytest.raises(ResultError, match="no frames"):
        export(tent.isel(time=[]), tmp_path / "tent.pvd")
    (tmp_path / "tent").write_text("a file stands where the folder should be")
    with pytest.raises(ResultError, match="cannot be written"):
        export(tent, tmp_path / "tent.pvd")


def test_show_exports_by_suffix(tmp_path):
    cases.whirl(times=FEW, file=tmp_path / "whirl.nc")
    out = CliRunner().invoke(app, ["show", str(tmp_path / "whirl.nc"), "-o", str(tmp_path / "whirl.pvd")])
    assert (out.exit_code, out.stdout) == (0, "")
    assert len(list((tmp_path / "whirl").iterdir())) == 5
    assert ElementTree.parse(tmp_path / "whirl.pvd").getroot().get("type") == "Collection"
