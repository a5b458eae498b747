"""A process that computes for one page at a time: checks, equilibria under the pointer, runs, exports.

Everything that reads a scenario of somebody does it here, with a limit on memory: the server itself computes nothing.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import multiprocessing
import os
import signal
import tempfile
import threading
import time
import zipfile
from collections.abc import Iterable
from dataclasses import asdict, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pydantic import ValidationError

from ropewalk import results
from ropewalk.errors import Problem, RopewalkError, ScenarioError, condensed
from ropewalk.external.models import refuse_code
from ropewalk.model.run import Dynamic, Linear
from ropewalk.permission import STUDIO, forbid_code
from ropewalk.results.contract import run_info_attributes, scenario_attributes
from ropewalk.results.files import check_own
from ropewalk.results.frames import Frames
from ropewalk.results.labelled import of_frames
from ropewalk.scenario import loads
from ropewalk.studio.folder import RESULTS, Folder, check_inside
from ropewalk.studio.lesson import kept_result
from ropewalk.studio.preview import preview
from ropewalk.studio.settings import Settings
from ropewalk.studio.share import shared
from ropewalk.studio.streams import Stream, of_frame, of_result, remark_of, stored

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model.scenario import Scenario
    from ropewalk.results.frame import Layout, RunInfo
    from ropewalk.studio.poses import Asked, Dragging

MOST_NODES = 50_000  # of a scenario in the studio
_FAREWELL = 1.0  # s, from the end of the server
SUFFIXES = {"report": ".html", "zip": ".csv"}  # of exports that are not named as their files end
EARLY = ("xarray", "netCDF4", "ropewalk.studio.poses")
Answer = dict[str, Any]
Kind = Literal["event", "stopped", "answer"]  # of a message about a question; the answer is the last one


def main(pipe: Connection, settings: Settings) -> None:
    """Serve until the pipe ends.

    Args:
        pipe: questions come from it as dictionaries; pairs of a `Kind` and a message go back.
        settings: where files are, and limits of this process and of each that it begins.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which tells us
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small problems, and other pages want the other cores
    os.chdir(settings.folder.resolve())
    if not settings.allow_code:
        forbid_code(STUDIO)
    if settings.memory:
        _bound("RLIMIT_DATA", settings.memory, is_final=True)
    if (server := multiprocessing.parent_process()) is not None:
        threading.Thread(target=_leave_with, args=(server,), daemon=True).start()
    for name in EARLY:  # while the first page is loaded
        if not pipe.poll():
            importlib.import_module(name)
    worker = ComputingProcess(pipe, settings)
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            worker.serve()


def _bound(what: str, most: int, *, is_final: bool = False) -> None:
    """Bound what this process takes to so many bytes, where the system can; for good, or until the next bound."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        limit = getattr(resource, what)
        hard = most if is_final else resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (most, hard))  # an error where the system's own limit is lower


def _leave_with(server: Any) -> None:
    """End this process when its server has gone, after a moment for what it writes; it may be waiting for a sweep."""
    server.join()
    time.sleep(_FAREWELL)
    os._exit(1)


class ComputingProcess:
    """What answers questions."""

    def __init__(self, pipe: Connection, settings: Settings) -> None:
        self._pipe, self._settings = pipe, settings
        self._folder = Folder(settings.folder, settings.disk)
        self._dragging: Dragging | None = None
        self._waiting = list[Answer]()
        self._head = dict[str, Any]()  # of all that answers the question: its number

    def serve(self) -> None:
        """Answer the next question."""
        asked = self._waiting.pop(0) if self._waiting else self._pipe.recv()
        if asked["do"] == "stop":  # of what has ended meanwhile
            return
        self._head = {"id": asked["id"]}
        try:
            found = getattr(self, f"_do_{asked['do']}")(asked)
        except ScenarioError as error:
            several = condensed(error.problems)
            found = {"problems": [{**asdict(p), "message": str(replace(p, file="", line=None))} for p in several]}
        except RopewalkError as error:
            found = {"error": str(error)}
        except KeyboardInterrupt:
            found = {"error": "stopped before the first result"}
        except MemoryError:
            found = {"error": "this needs more memory than the studio may use; start the studio with a larger limit"}
        except RecursionError:
            found = {"error": "the blocks are nested too deeply"}
        except (LookupError, ValidationError) as error:
            found = {"error": f"invalid request ({type(error).__name__}: {error})"}
        except Exception as error:
            found = {"error": f"ropewalk failed ({type(error).__name__}: {error}); this is a fault of ropewalk"}
        self._send(found, "answer")

    def _send(self, message: Answer | bytes | str, kind: Kind = "event") -> None:
        """Send something about the question that is answered now."""
        if isinstance(message, dict):  # no full paths on the page
            message = json.dumps({**self._head, **message}).replace(f"{self._folder.path}{os.sep}", "")
        try:
            self._pipe.send((kind, message))
        except OSError:  # the server has gone: a run ends as if it were stopped, and keeps what it has
            raise KeyboardInterrupt from None

    def _send_all(self, messages: Iterable[bytes]) -> None:
        for message in messages:
            self._send(message)

    def _stop_if_asked(self, _: float = 0.0) -> None:
        """Stop the run that goes on if the page says so, or has gone; what else it says waits."""
        while self._pipe.poll():
            try:
                asked = self._pipe.recv()
            except EOFError:
                raise KeyboardInterrupt from None
            if asked["do"] == "stop":
                self._send({"event": "stopped"}, "stopped")
                raise KeyboardInterrupt
            self._waiting.append(asked)

    def _progress(self, event: str, **how_far: Any) -> None:
        self._send({"event": event, **how_far})
        self._stop_if_asked()

    def _scenario(self, asked: Answer) -> Scenario:
        """The scenario of a text, refused where it runs code, leaves the folder or is huge."""
        scenario = loads(str(asked["text"]), str(asked.get("name") or "scenario.yaml"))
        self._allow(scenario)
        return scenario

    def _allow(self, scenario: Scenario) -> None:
        if not self._settings.allow_code:
            refuse_code(scenario.loads)
        tree = scenario.model_dump(mode="python", by_alias=True, exclude_unset=True, warnings=False)
        check_inside(tree, self._folder.path)
        for name, line in scenario.lines.items():
            if isinstance(elements := getattr(line, "elements", None), int) and elements > MOST_NODES:
                remedy = f"use at most {MOST_NODES} in the studio"
                raise ScenarioError([Problem(f"lines.{name}.elements", "is too large here", str(elements), remedy)])

    def _opened(self, asked: Answer) -> tuple[Path, xr.Dataset, bool]:
        """The file of a result or a sweep, what is in it, and whether that is a sweep."""
        file = self._folder.file(str(asked["name"]), RESULTS)
        try:
            return file, results.open_result(file), False
        except results.ResultError:
            from ropewalk.sweeps.writing import read

            if (many := read(file)) is None:
                raise
            return file, many, True

    def _target(self, asked: Answer, suffix: str, kinds: tuple[str, ...] = RESULTS) -> Path:
        """A file that is named as that of a scenario is."""
        return self._folder.file(f"{Path(str(asked.get('name') or 'scenario.yaml')).stem}{suffix}", kinds)

    def _bound_disk(self) -> None:
        """Bound the files that are written from now on to what is left of the disk, or refuse to begin."""
        if left := self._folder.bytes_left():
            _bound("RLIMIT_FSIZE", left)

    def _do_check(self, asked: Answer) -> Answer:
        """Every mistake in a text."""
        self._scenario(asked)
        return {"problems": []}

    def _do_prepare(self, asked: Answer) -> Answer | bytes:
        """A scenario made ready for dragging, with what can be changed by hand; a picture where nothing can be."""
        from ropewalk.studio.poses import KEYS, Dragging, draggable, force_of

        scenario = self._scenario(asked)
        self._dragging, found = Dragging(scenario), []
        for name in draggable(scenario):
            on = scenario.loads[name].on
            kept = {key: getattr(scenario.lines[on], key) for key in KEYS}
            found.append({"name": name, "on": on, "force": force_of(scenario, name), "line": kept})
        head = {"title": scenario.title, "loads": found, "gravity": scenario.gravity}
        if found or (declared := preview(scenario)) is None:
            return head
        return of_frame(declared, {**self._head, **head})

    def _dragged(self, asked: Answer) -> tuple[Dragging, Asked]:
        from ropewalk.studio.poses import Asked

        if self._dragging is None:
            raise RopewalkError("no scenario is loaded")
        return self._dragging, Asked(**asked["pose"])

    def _do_pose(self, asked: Answer) -> bytes:
        """The equilibrium with the load under the pointer."""
        dragging, wanted = self._dragged(asked)
        pose = dragging.posed(wanted)
        frames = Frames.together([pose.frame])
        block = of_frames(pose.layout, frames.path, frames.of, dragging.attributes)
        return of_frame(block, self._head, **({} if pose.linear is None else {"ghost": pose.linear}))

    def _do_release(self, asked: Answer) -> Answer:
        """The motion of the load when it is let go where it was dragged to; not written to a file."""
        dragging, wanted = self._dragged(asked)
        return self._run(asked, dragging.released(wanted, dragging.xi), None)

    def _do_run(self, asked: Answer) -> Answer:
        """A run as `ropewalk run` does it: its result is written while it goes on, unless it is not to be kept."""
        scenario = self._scenario(asked)
        if asked.get("unkept"):
            return self._run(asked, scenario, None)
        self._bound_disk()
        file = self._target(asked, ".nc")
        if not asked.get("overwrite"):
            try:
                check_own(file, scenario)
            except results.ResultError:  # the page asks whether to replace it
                return {"replaces": file.name}
        return self._run(asked, scenario, file)

    def _run(self, asked: Answer, scenario: Scenario, file: Path | None) -> Answer:
        from ropewalk.simulate import must_compile, output_times, simulate

        run, how_long = scenario.run, must_compile(scenario)
        self._send({"event": "state", "state": f"preparing, first run only ({how_long})" if how_long else "setting up"})
        total = output_times(run).size if isinstance(run, Dynamic | Linear) else getattr(run, "positions", 1)
        stream, attributes = Stream(self._head, total), scenario_attributes(scenario)

        def seen(layout: Layout, frames: Frames, run_info: RunInfo) -> None:
            block = of_frames(layout, frames.path, frames.of, {**attributes, **run_info_attributes(run_info)})
            doubts = [remark_of(str(doubt)) for doubt in run_info.doubts]
            self._send_all(stream.messages(block, run={"doubts": doubts, "warnings": run_info.warnings}))

        overwrite = bool(asked.get("overwrite"))
        with simulate(scenario, file=file, overwrite=overwrite, progress=self._stop_if_asked, seen=seen) as dataset:
            return {"file": file.name if file else None, **stored(dataset)}

    def _do_result(self, asked: Answer) -> Answer:
        """A result that is there, as if it had just been computed; of a sweep, its cases."""
        file, dataset, is_sweep = self._opened(asked)
        if is_sweep:
            from ropewalk.studio.sweeps import described

            return {"file": file.name, "sweep": described(dataset)}
        with dataset:
            self._send_all(of_result(dataset, self._head))
            return {"file": file.name, **stored(dataset)}

    def _do_lesson(self, asked: Answer) -> Answer:
        """Send the kept result of a lesson's scenario: nothing is computed, and nothing compiled."""
        dataset, ended = kept_result(str(asked["name"]))
        self._send_all(of_result(dataset, self._head))
        return {"file": None, **ended}

    def _do_sweep(self, asked: Answer) -> Answer:
        """The sweep of a scenario, as `ropewalk sweep` does it, into FILE.sweep.nc and FILE.sweep.jsonl."""
        from ropewalk.studio.sweeps import checked_plan, described
        from ropewalk.sweeps.plan import asked as wished
        from ropewalk.sweeps.sweeping import sweep
        from ropewalk.sweeps.writing import read, write

        scenario = self._scenario(asked)
        file, store = self._target(asked, ".sweep.nc"), self._target(asked, ".sweep.jsonl", (".jsonl",))
        if file.exists() and read(file) is None:
            raise results.ResultError(f"{file.name}: exists already and is not a sweep; it is not overwritten")
        self._bound_disk()
        checked_plan(scenario, wished(scenario, None), self._allow, self._folder.path)
        found = sweep(
            scenario, store=store, workers=self._settings.workers,
            progress=lambda done, total: self._progress("cases", done=done, total=total),
        )  # fmt: skip
        write(found, file)
        return {"file": file.name, "sweep": described(found)}

    def _do_models(self, asked: Answer) -> Answer:
        """Simpler models beside the full one, as `ropewalk compare` shows them."""
        from ropewalk.compare import model_hierarchy

        scenario, picture = self._scenario(asked), io.StringIO()
        found = model_hierarchy(scenario, progress=lambda model, done: self._progress("model", model=model, done=done))
        found.figure().savefig(picture, format="svg")
        tables = [found.table(), [("assumptions", "measured"), *found.assumptions.table()]]
        return {"title": found.title, "tables": tables, "verdict": found.verdict, "picture": picture.getvalue()}

    def _do_case(self, asked: Answer) -> Answer:
        """The scenario of one case of a sweep."""
        from ropewalk.studio.sweeps import case_of

        file, dataset, is_sweep = self._opened(asked)
        with dataset:
            if not is_sweep:
                raise RopewalkError(f"{file.name}: is no sweep")
            return case_of(dataset, int(asked["row"]), self._allow, self._folder.path)

    def _do_export(self, asked: Answer) -> bytes:
        """A result as a figure, film, table, report, or a page that needs no server; a sweep as figure or table."""
        from ropewalk.cli.console import show_in
        from ropewalk.sweeps.writing import write

        file, dataset, is_sweep = self._opened(asked)
        kind = str(asked["as"])
        with dataset, tempfile.TemporaryDirectory() as place:
            made = Path(place) / f"{file.stem}{SUFFIXES.get(kind, f'.{kind}')}"
            if is_sweep:
                if kind not in ("png", "svg", "pdf", "csv", "xlsx"):
                    raise RopewalkError(f"{kind}: sweeps are exported as png, svg, pdf, csv or xlsx")
                write(dataset, made)
            elif kind == "page":
                return shared(dataset).encode()
            else:
                several = show_in(dataset, made, quiet=True)
                if kind == "zip":
                    made = made.with_suffix(".zip")
                    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
                        for table in several:
                            archive.write(table, table.name)
            return made.read_bytes()
