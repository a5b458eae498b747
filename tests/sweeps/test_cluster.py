"""Sweeps on a Dask cluster of real processes, whose workers are killed."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys

import pytest
import xarray as xr

import ropewalk
import sweep_cases as cases
from ropewalk.errors import RopewalkError
from ropewalk.sweeps.cluster import each_on

pytest.importorskip("distributed")
OVER = {"lines.rope.length": "10.5:10.9:0.05 m"}


@pytest.fixture
def cluster(tmp_path):
    """A scheduler and two workers of one thread: its address, and what starts another worker."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address, started = f"tcp://127.0.0.1:{port}", []
    here = os.path.dirname(cases.__file__)
    path = os.pathsep.join([here, *filter(None, [os.environ.get("PYTHONPATH")])])

    def begin(*words):
        command = [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        environment = os.environ | threads | {"PYTHONPATH": path, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
        started.append(subprocess.Popen(command, **quiet, env=environment, cwd=tmp_path, start_new_session=True))
        return started[-1]

    def worker(nanny="--no-nanny"):
        return begin("dask_worker", address, "--nthreads", "1", nanny, "--no-dashboard", "--death-timeout", "60")

    scheduler = begin("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard", "--no-jupyter")
    try:
        yield address, worker, scheduler
    finally:
        for process in started:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # nannies have workers
            process.wait()


def test_a_cluster_whose_workers_are_killed_gives_what_this_machine_gives(cluster, tmp_path):
    address, worker, _ = cluster
    workers, killed = [worker(), worker()], []

    def kill(done, total):
        if done in (2, 5) and len(killed) < 2:
            workers[len(killed)].send_signal(signal.SIGKILL)
            killed.append(done)
            worker()

    store = tmp_path / "s.jsonl"
    found = ropewalk.sweep(cases.scenario(), OVER, record="largest_sag", cluster=address, store=store, progress=kill)
    assert len(killed) == 2
    assert (found["outcome"] == "completed").all()
    assert len(store.read_text("utf-8").splitlines()) == 1 + found["outcome"].size
    here = ropewalk.sweep(cases.scenario(), OVER, record="largest_sag", workers=1)
    xr.testing.assert_identical(found.drop_vars("seconds"), here.drop_vars("seconds"))


def test_only_the_task_that_kills_its_workers_is_lost(cluster):
    address, worker, _ = cluster
    worker("--nanny")
    found = dict(each_on(address, range(8), 8, cases.deadly, -1))
    assert found == {number: -1 if number == 3 else number * number for number in range(8)}


def test_a_scheduler_that_goes_is_told_and_nothing_is_lost(cluster, tmp_path):
    address, worker, scheduler = cluster
    worker()
    store = tmp_path / "s.jsonl"

    def kill(done, total):
        if done == 3:
            scheduler.kill()

    with pytest.raises(RopewalkError, match="continues the sweep"):
        ropewalk.sweep(cases.scenario(), OVER, record="largest_sag", cluster=address, store=store, progress=kill)
    found = ropewalk.sweep(cases.scenario(), OVER, record="largest_sag", workers=0, store=store)
    keys = [json.loads(line)["key"] for line in store.read_text("utf-8").splitlines()[1:]]
    assert len(keys) == len(set(keys)) == found["outcome"].size


def test_a_cluster_that_is_not_there_is_told(monkeypatch):
    monkeypatch.setattr("ropewalk.sweeps.cluster.PATIENCE", 0.5)
    with pytest.raises(RopewalkError, match="cannot be reached"):
        list(each_on("tcp://127.0.0.1:9", [1], 1, cases.squared, -1))


def test_workers_that_would_run_external_code_are_not_asked_where_it_is_forbidden(cluster, tmp_path):
    """Workers of a cluster do not inherit the option: a case is refused before it is sent."""
    address, worker, _ = cluster
    worker()
    (tmp_path / "evil.py").write_text('import pathlib\npathlib.Path("has_run").touch()\nclass X:\n    pass\n')
    stepper = '{kind: stepper, on: rope, model: "evil.py:X", every: 10 ms}'
    motion = cases.TREE | {"run": {"kind": "dynamic", "until": 0.02, "every": 0.01}}
    (tmp_path / "s.json").write_text(json.dumps(motion | {"sweep": {"over": {"loads.man": [stepper]}}}))
    command = [sys.executable, "-m", "ropewalk", "sweep", "s.json", "--cluster", address]
    for option, has_run, code in (("--no-code", False, 2), ("--quiet", True, 3)):
        ended = subprocess.run([*command, option], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (ended.returncode, (tmp_path / "has_run").exists()) == (code, has_run), ended.stderr
