"""The table of attacks: an isolated FMU that is hostile, as root and as an ordinary user, and what it achieves.

Each run is a process of its own without OPENBLAS_NUM_THREADS, so that NumPy begins threads where it finds cores.
"""

from __future__ import annotations

import contextlib
import inspect
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("fmpy", reason="FMUs need FMPy")

from ropewalk.checkpoint import to_bytes
from ropewalk.external import seccomp
from ropewalk.external.confinement import lacking

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or bool(lacking()), reason="this system cannot confine a process"
)
HELD = (
    "write", "truncate", "rename", "link", "unlink", "mkdir", "symlink", "fifo", "chmod", "fchmod", "fchmodat2",
    "chown", "utimes", "futimens", "setxattr", "chattr", "tcp", "udp", "unix", "abstract", "socketpair", "io_uring",
    "signal", "signal group", "signal by file", "pidfd", "limit of parent", "priority of parent", "ptrace",
    "memory of parent", "environment of parent", "files of parent", "list of processes", "secret of environment",
    "mount", "namespace", "chroot", "shared memory", "posix shared memory", "memfd", "terminal", "program", "keyring",
    "thread", "watcher", "python", "large file", "daemon", "bomb",
)  # fmt: skip
ALLOWED = ("read",)  # docs/fmi.md says so
RIDE = """
import os, sys, time
sys.path[:0] = sys.argv[2:]
from external.test_isolation import StillLine, ride
from ropewalk.errors import RopewalkError
from ropewalk.external.fmu import FmuModel
from ropewalk.model.fmu import Fmu
load = Fmu(on="rope", file=sys.argv[1], contacts={"a": {"force": "force", "height": "height"}}, travel={"speed": 1.0},
           every=0.01, isolated=True, patience=40.0)
model = FmuModel("car", load, 1.0, 2)
begin = time.monotonic()
try:
    print("answers", ride(model, 3))
except RopewalkError as error:
    print("error", error)
print("folder", model._worker._watched.folder, "code", model._worker._watched.process.poll())
model.close()
print("seconds", time.monotonic() - begin)
"""
XML = (
    '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0" modelName="hostile" guid="right">'
    '<CoSimulation modelIdentifier="hostile"/><ModelVariables><ScalarVariable name="height" valueReference="1" '
    'causality="input" variability="continuous"><Real start="0"/></ScalarVariable><ScalarVariable name="force" '
    'valueReference="5" causality="output" variability="continuous"><Real/></ScalarVariable></ModelVariables>'
    "<ModelStructure/></fmiModelDescription>"
)
USERS = ["the user of the tests", "an ordinary user"]


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from fmpy import platform
    from fmpy.fmi2 import FMU2Slave

    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no compiler for C here, of which the hostile FMU is made")
    folder = tmp_path_factory.mktemp("hostile")
    for place in (folder, folder.parent, folder.parent.parent):
        place.chmod(0o755)
    text = Path(__file__).with_name("hostile.c").read_text(encoding="utf-8")
    names = [name for name, _ in inspect.getmembers(FMU2Slave) if name.startswith("fmi2") and f"{name}(" not in text]
    source, library, file = folder / "hostile.c", folder / "hostile.so", folder / "hostile.fmu"
    source.write_text(text + "\n".join(f"int {name}() {{ return 3; }}" for name in names))
    subprocess.run(
        [compiler, "-shared", "-fPIC", "-O1", "-w", "-pthread", "-o", library, source, "-ldl", "-lrt"], check=True
    )
    with zipfile.ZipFile(file, "w") as archive:
        archive.write(library, f"binaries/{platform}/hostile.so")
        archive.writestr("modelDescription.xml", XML)
    return file


@pytest.fixture
def target(tmp_path: Path) -> Iterator[Path]:
    """A folder that the attacks are aimed at, open to everybody, with a socket in it."""
    folder = Path(os.path.realpath(f"/tmp/target-{os.getpid()}-{time.monotonic_ns()}"))  # sockets need short paths
    folder.mkdir()
    folder.chmod(0o777)
    (folder / "victim").write_text("precious")
    with socket.socket(socket.AF_UNIX) as by_path, socket.socket(socket.AF_UNIX) as abstract:
        by_path.bind(str(folder / "sock"))
        (folder / "sock").chmod(0o777)
        by_path.listen()
        with contextlib.suppress(OSError):
            abstract.bind("\0hostile")
            abstract.listen()
        yield folder
    shutil.rmtree(folder)


def as_user(user: str) -> list[str]:
    """What runs a command as such a user; where the tests themselves are run by one there is nobody else."""
    if user == USERS[0] or os.getuid() != 0:
        return []
    tool = shutil.which("setpriv")
    if tool is None:
        pytest.skip("no setpriv, which runs a command as another user")
    powers = ["--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search"]  # to read a Python in a home of root
    return [tool, "--reuid=65534", "--regid=65534", "--clear-groups", *powers]


def tried(fmu: Path, target: Path, attacks: str, user: str = USERS[0], forgery: bytes = b"") -> tuple[str, str]:
    """What a run with these attacks has printed to stdout and stderr."""
    own = os.getuid() if not as_user(user) else 65534
    os.chown(target, own, -1)
    os.chown(target / "victim", own, -1)
    (target.with_suffix(".forgery")).write_bytes(forgery)
    with socket.create_server(("127.0.0.1", 0)) as server:
        environment = {
            **os.environ, "HOSTILE_TARGET": str(target), "HOSTILE_ATTACKS": attacks, "HOSTILE_API_TOKEN": "secret",
            "HOSTILE_PORT": str(server.getsockname()[1]), "HOSTILE_FORGERY": str(target.with_suffix(".forgery")),
        }  # fmt: skip
        for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
            environment.pop(name, None)
        command = [*as_user(user), sys.executable, "-c", RIDE, str(fmu), str(Path(__file__).parents[1])]
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, errors="replace", timeout=120, check=False
        )
    target.with_suffix(".forgery").unlink()
    assert done.returncode == 0, done.stderr
    folder = re.search(r"folder (\S+)", done.stdout)
    assert folder
    assert not Path(folder[1]).exists()
    return done.stdout, done.stderr


def is_as_before(target: Path) -> bool:
    status = (target / "victim").stat()
    return (
        sorted(entry.name for entry in target.iterdir()) == ["sock", "victim"]
        and (target / "victim").read_text() == "precious"
        and status.st_mode & 0o777 == 0o644
        and time.time() - status.st_mtime < 1000.0
        and status.st_gid != 1
    )


def hooked(monkeypatch: pytest.MonkeyPatch, folder: Path, code: str) -> None:
    """Run some code at the beginning of all processes."""
    for place in (folder, folder.parent):
        place.chmod(0o755)
    (folder / "sitecustomize.py").write_text(code)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), *filter(None, sys.path)]))


@pytest.mark.parametrize("user", USERS)
def test_the_attacks_are_held_and_the_fmu_still_answers(fmu: Path, target: Path, user: str) -> None:
    (target / "victim").chmod(0o644)
    out, err = tried(fmu, target, ",".join((*HELD, *ALLOWED)), user)
    found = dict(re.findall(r"ATTACK (.*): (DONE|held)", err))
    assert found == dict.fromkeys(HELD, "held") | dict.fromkeys(ALLOWED, "DONE")
    assert "answers [-100.0, -100.0, -100.0, -100.0]" in out
    assert is_as_before(target)


@pytest.mark.parametrize("user", USERS)
def test_the_attacks_work_where_nothing_confines(
    fmu: Path, target: Path, user: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The table would show it: without confinement most of the attacks succeed."""
    hooked(monkeypatch, tmp_path, "import ropewalk.external.confinement as c\nc.confine = lambda folder: None\n")
    _, err = tried(fmu, target, "write,chmod,utimes,tcp,unix,abstract,signal,shared memory,memfd,thread", user)
    assert "held" not in err
    assert not is_as_before(target)


@pytest.mark.parametrize("user", USERS)
@pytest.mark.parametrize(
    ("attack", "said"),
    [
        ("memory", ""), ("shared anonymous", "took more memory than it may"), ("threads", "had more than 1000 threads"),
        ("fill", "filled its folder with more than 0.27 GB"), ("flood", ""), ("print", ""),
    ],
)  # fmt: skip
def test_what_takes_too_much_is_bounded(
    fmu: Path, target: Path, user: str, attack: str, said: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    small = "import ropewalk.external.confinement as c\nc._MOST_MEMORY, c.LARGEST_FILE = 1 << 29, 1 << 27\n"
    hooked(monkeypatch, tmp_path, small)  # 8 times less than usual, to be there sooner
    out, err = tried(fmu, target, attack, user)
    assert f"ATTACK {attack}: DONE" not in err
    assert said in out
    assert ("error" in out) == bool(said)
    assert len(err) < 1_200_000  # 1 MiB, the last piece of up to 64 KiB, and a remark
    assert float(out.rpartition("seconds")[2]) < 35.0  # less than its patience: it was ended, or it was quick


@pytest.mark.parametrize(
    "forgery",
    [
        b"\0" * 4096, b"\xff" * 64,
        *(len(data).to_bytes(8, "little") + data for data in map(to_bytes, (
            ("done", [float("nan")]), ("done", []), ("done", ["x"]), ("done", None), ("failed", 7), ("said", 7),
            "nothing", ("done", [1.0, 2.0]), ("said", ("x", "y")),
        ))),
    ],
    ids=range(11),
)  # fmt: skip
def test_forged_answers_are_refused(fmu: Path, target: Path, forgery: bytes) -> None:
    out, _ = tried(fmu, target, "forge", forgery=forgery)
    assert "error load car: its FMU hostile.fmu gives no answer but something else, in the step from t = 0 s" in out


def test_no_sign_that_controls_a_terminal_comes_through(fmu: Path, target: Path) -> None:
    out, err = tried(fmu, target, "escape")
    assert "its log: " in out
    assert out.replace("\n", "").isprintable()
    assert err.replace("\n", "").isprintable()
    assert "pwned" in err


def test_the_numbers_of_refused_calls_are_those_of_this_system() -> None:
    """Of both tables, since no test runs on the other processor; as the headers of the system have them."""
    files = ("/usr/include/x86_64-linux-gnu/asm/unistd_64.h", "/usr/include/asm-generic/unistd.h")
    seen = 0
    for column, file in enumerate(map(Path, files)):
        if file.is_file():
            found = re.findall(r"#define __NR(?:3264)?_(\w+)\s+(\d+)", file.read_text())
            known = {name: int(number) for name, number in found}
            for name, numbers in seccomp._REFUSED.items():
                assert known.get(name, numbers[column]) == numbers[column], name
                seen += name in known
    if not seen:
        pytest.skip("no headers of the kernel here")
