"""The command line keeps its contract: exit codes, what goes to stdout and stderr, what is written."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
import standin

import ropewalk
from ropewalk.results import open_result


def test_run_writes_the_result_and_prints_the_table(call, scenario, folder):
    out = call("run", scenario())
    assert out.exit_code == 0, out.output
    assert "largest tension" in out.stdout
    assert "3.60 times real time" in out.stdout
    assert out.stderr == "result written to rope.nc\n"
    result = open_result(folder / "rope.nc")
    assert (result.attrs["outcome"], result.sizes["time"]) == ("completed", 61)


def test_the_result_goes_to_the_current_folder_or_where_it_is_asked(call, scenario, folder):
    (folder / "cases").mkdir()
    scenario(name="cases/deep.yaml")
    assert call("run", "cases/deep.yaml", "-q").exit_code == 0
    assert call("run", "cases/deep.yaml", "-q", "-o", "cases/other.nc").exit_code == 0
    assert {p.name for p in folder.glob("**/*.nc")} == {"deep.nc", "other.nc"}
    assert (folder / "deep.nc").exists()


def test_an_earlier_result_is_replaced_and_that_is_said(call, scenario):
    name = scenario()
    call("run", name)
    assert call("run", name).stderr == "result written to rope.nc (replaced)\n"


def test_json_stands_alone_on_stdout(call, scenario):
    out = call("run", scenario(), "--json")
    found = json.loads(out.stdout)
    assert found["file"] == "rope.nc"
    assert found["outcome"] == "completed"
    assert found["largest_tension"]["unit"] == "N"


def test_quiet_is_silent(call, scenario):
    out = call("run", scenario(), "--quiet")
    assert (out.exit_code, out.stdout, out.stderr) == (0, "", "")


def test_set_changes_the_scenario(call, scenario, folder):
    out = call("run", scenario(), "-q", "--set", "title=Changed", "--set", "run.until=2 s")
    assert out.exit_code == 0, out.output
    message = json.loads(open_result(folder / "rope.nc").attrs["scenario"])
    assert (message["title"], message["run"]["until"]) == ("Changed", 2.0)


@pytest.mark.parametrize("command", ["run", "check", "spectrum"])
def test_every_problem_of_an_input_has_a_line_and_nothing_is_written(command, call, scenario, folder):
    name = scenario()
    text = (folder / name).read_text().replace("mass: 1 kg/m", "mass: -1 kg/m").replace("kind: force", "kind: farce")
    (folder / name).write_text(text)
    out = call(command, name, "--set", "gravity=1 kg")
    assert out.exit_code == 2
    assert out.stdout == ""
    lines = out.stderr.splitlines()
    assert len(lines) == 3
    assert "Traceback" not in out.stderr
    assert sum(line.startswith("rope.yaml:") for line in lines) == 2
    assert [p.name for p in folder.iterdir()] == [name]


def test_a_missing_file_is_bad_input(call, folder):
    out = call("check", "none.yaml")
    assert (out.exit_code, out.stdout) == (2, "")
    assert "none.yaml" in out.stderr


def test_a_missing_folder_is_told_before_computing(call, scenario, folder):
    out = call("run", scenario(), "-o", "no/out.nc")
    assert out.exit_code == 2
    assert "does not exist" in out.stderr
    assert not (folder / "no").exists()


def test_the_scenario_is_never_overwritten_by_its_result(call, scenario, folder):
    name = scenario()
    before = (folder / name).read_bytes()
    out = call("run", name, "-o", name)
    assert out.exit_code == 2
    assert (folder / name).read_bytes() == before


def test_a_breakdown_keeps_the_partial_result_and_gives_the_advice(call, scenario, folder):
    out = call("run", scenario("breakdown"), "--json")
    assert out.exit_code == 3
    assert json.loads(out.stdout)["outcome"] == "diverged"
    for word in ("diverged", "rope.nc", standin.ADVICE):
        assert word in out.stderr
    assert open_result(folder / "rope.nc").sizes["time"] == 21


def test_a_doubtful_run_is_kept_and_has_an_exit_code_of_its_own(call, scenario, folder):
    out = call("run", scenario("no force"))
    assert out.exit_code == 4
    assert "doubtful" in out.stdout.splitlines()[0]
    for word in ("are unreliable", "rope.nc", "never exerts a force", "loads.walker.force"):
        assert word in out.stderr
    assert open_result(folder / "rope.nc").attrs["outcome"] == "doubtful"
    assert "doubt: load walker never exerts a force" in call("show", "rope.nc").stdout


def test_a_run_without_a_beginning_leaves_the_earlier_result_alone(call, scenario, folder):
    assert call("run", scenario(), "-q").exit_code == 0
    before = (folder / "rope.nc").read_bytes()
    assert call("run", scenario("no equilibrium")).exit_code == 3
    assert (folder / "rope.nc").read_bytes() == before


def test_a_run_without_a_beginning_writes_nothing(call, scenario, folder):
    out = call("run", scenario("no equilibrium"))
    assert out.exit_code == 3
    assert out.stderr == "the line is shorter than the distance of its ends\n"
    assert not (folder / "rope.nc").exists()


def test_an_error_on_the_way_tells_where_the_partial_result_is(call, scenario):
    out = call("run", scenario("impossible"))
    assert out.exit_code == 3
    assert "Newton found no rest shape\nthe computed part is kept in rope.nc" in out.stderr


def test_a_fault_is_owned_up_to_in_a_few_words(call, scenario):
    name = scenario("fault")
    out = call("run", name)
    assert out.exit_code == 1
    assert "ZeroDivisionError: float division by zero" in out.stderr
    assert "--traceback" in out.stderr
    assert "Traceback (most" not in out.stderr
    assert isinstance(call("--traceback", "run", name).exception, ZeroDivisionError)


def test_show_prints_the_table_on_stdout_or_json(call, scenario):
    call("run", scenario(), "-q")
    out = call("show", "rope.nc")
    assert (out.exit_code, out.stderr) == (0, "")
    assert out.stdout.startswith("Rope: completed")
    assert json.loads(call("show", "rope.nc", "--json").stdout)["title"] == "Rope"


@pytest.mark.parametrize(
    ("name", "magic"), [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.PDF", b"%PDF"), ("a.gif", b"GIF89a")]
)
def test_show_draws_by_suffix(name, magic, call, scenario, folder):
    call("run", scenario(), "-q")
    out = call("show", "rope.nc", "-o", name)
    assert (out.exit_code, out.stdout, out.stderr) == (0, "", f"{name} written\n")
    assert (folder / name).read_bytes().startswith(magic)


@pytest.mark.parametrize("name", ["a.jpeg2", "no/a.png", "noresult"])
def test_show_refuses_what_it_cannot_draw_before_it_starts(name, call, scenario, folder):
    (folder / "text.nc").write_text("text")
    out = call("show", "text.nc", *([] if name == "noresult" else ["-o", name]))
    assert out.exit_code == 2
    assert len(out.stderr.splitlines()) == 1


def test_new_writes_a_scenario_that_runs_and_overwrites_nothing(call, folder):
    assert call("new", "first").exit_code == 0
    assert call("run", "first.yaml", "-q").exit_code == 0
    before = (folder / "first.yaml").read_text()
    out = call("new", "first")
    assert out.exit_code == 2
    assert "exists already" in out.stderr
    assert (folder / "first.yaml").read_text() == before
    assert call("new", "no/first").exit_code == 2


def test_check_says_fine_and_what_the_run_is_and_writes_nothing(call, scenario, folder):
    out = call("check", scenario())
    assert (out.exit_code, out.stdout) == (0, "rope.yaml: valid (Rope: rope, walker; dynamic)\ndynamic\n")
    assert [p.name for p in folder.iterdir()] == ["rope.yaml"]


def test_schema_is_json_on_stdout(call):
    assert json.loads(call("schema").stdout)["properties"]["lines"]


def test_the_list_of_commands_says_of_each_what_it_does_in_a_whole_sentence(call):
    listed = call("--help").stdout.partition("Commands:")[2].strip().splitlines()
    assert len(listed) >= 20
    assert [line for line in listed if not line.endswith(".") or line.endswith("...")] == []


def test_version(call):
    assert call("--version").stdout == f"ropewalk {ropewalk.__version__}\n"


def test_figures_draws_all_or_those_asked_for(call, folder):
    assert call("figures").exit_code == 0
    assert len(list((folder / "figures").iterdir())) == 3
    assert call("figures", "-o", "few", "--only", "4", "--only", "table-1").exit_code == 0
    assert {p.stem for p in (folder / "few").iterdir()} == {"figure-4", "figure-table-1"}
    out = call("figures", "--only", "9")
    assert out.exit_code == 2
    assert "choose from 3, 4, table-1" in out.stderr


def test_spectrum_prints_a_list_or_json(call, scenario):
    name = scenario()
    assert call("spectrum", name).stdout == "at                 None\nlargest frequency  12.5 Hz\n"
    assert json.loads(call("spectrum", name, "--at", "0.5", "--json").stdout)["at"] == 0.5


@pytest.mark.parametrize(
    ("arguments", "allowed"),
    [(["--help"], set()), (["--version"], set()), (["run", "--help"], {"pydantic"})],  # typer wants it there
)
def test_help_imports_nothing_heavy(arguments, allowed):
    code = (
        "import sys\nfrom ropewalk.cli.app import app\n"
        f"try:\n    app({arguments!r})\nfinally:\n    print(*sys.modules, file=sys.stderr)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=30)
    assert out.returncode == 0
    heavy = {"numba", "numpy", "scipy", "matplotlib", "xarray", "netCDF4", "pydantic", "pint", "rich", "ruamel"}
    assert {name.split(".")[0] for name in out.stderr.split()} & heavy <= allowed


@pytest.mark.parametrize("name", ["a" * 300 + ".nc", "loop.nc"])
def test_a_name_that_no_file_can_have_is_bad_input(call, folder, name):
    (folder / "loop.nc").symlink_to(folder / "loop.nc")
    found = call("show", name)
    assert found.exit_code == 2
    assert "there is no such file" in found.stderr
