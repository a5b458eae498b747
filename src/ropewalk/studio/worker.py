"""A process that computes for one page at a time: checks, equilibria under the pointer, runs, exports.

Everything that reads a scenario of somebody does it here, with a limit on memory: the server itself computes nothing.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import multiprocessing
import os
import signal
import tempfile
import threading
import time
import zipfile
from collections.abc import Callable
from dataclasses import asdict, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.permission import STUDIO, forbid_code
from ropewalk.studio.folder import RESULTS, Folder, check_inside
from ropewalk.studio.settings import Settings

if TYPE_CHECKING:
    from ropewalk.model.scenario import Scenario
    from ropewalk.studio.poses import Asked, Dragging

MOST_NODES = 50_000  # of a scenario in the studio
_FAREWELL = 1.0  # s, from the end of the server
EARLY = ("ropewalk.studio.streams", "xarray", "netCDF4", "ropewalk.studio.lesson", "ropewalk.studio.poses")
ACKNOWLEDGED = -1  # ticket of the message that a stop has been heard
Answer = dict[str, Any]


def main(pipe: Connection, settings: Settings) -> None:
    """Serve until the pipe ends.

    Args:
        pipe: questions come from it as dictionaries; (id, last, message) goes back.
        settings: where files are, and limits of this process and of each that it begins.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which tells us
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small problems, and other pages want the other cores
    folder = settings.folder.resolve()
    os.chdir(folder)
    if not settings.allow_code:
        forbid_code(STUDIO)
    if settings.memory:
        _bound("RLIMIT_DATA", settings.memory, is_final=True)
    if (server := multiprocessing.parent_process()) is not None:
        threading.Thread(target=_leave_with, args=(server,), daemon=True).start()
    for name in EARLY:  # while the first page is loaded
        if not pipe.poll():
            importlib.import_module(name)
    worker = ComputingProcess(pipe, folder, settings.allow_code, settings.workers, settings.disk)
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            worker.serve()


def _bound(what: str, most: int, *, is_final: bool = False) -> None:
    """Bound what this process takes to so many bytes, where the system can; for good, or until the next bound."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        limit = getattr(resource, what)
        hard = resource.getrlimit(limit)[1]
        bound = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(limit, (bound, bound if is_final else hard))


def _leave_with(server: Any) -> None:
    """End this process when its server has gone, after a moment for what it writes; it may be waiting for a sweep."""
    server.join()
    time.sleep(_FAREWELL)
    os._exit(1)


class ComputingProcess:
    """What answers questions."""

    def __init__(self, pipe: Connection, folder: Path, allow_code: bool, processes: int | None, disk: int = 0) -> None:
        self._pipe, self._folder, self._allow_code, self._processes = pipe, folder, allow_code, processes
        self._disk = disk
        self._dragging: Dragging | None = None
        self._waiting = list[Answer]()
        self._now = 0, 0  # ticket and number of the question
        self._xi = 0.0  # m, where the load was dragged to last

    def serve(self) -> None:
        """Answer the next question."""
        from ropewalk.errors import RopewalkError, ScenarioError

        asked = self._waiting.pop(0) if self._waiting else self._pipe.recv()
        ticket, number, do = asked["ticket"], asked["id"], str(asked["do"])
        self._now = ticket, number
        try:
            answer: Callable[[Answer], Answer | bytes] | None = getattr(self, f"_do_{do}", None)
            found = {} if answer is None else answer(asked)
        except ScenarioError as error:
            found = {"problems": problems_of(error)}
        except RopewalkError as error:
            found = {"error": str(error)}
        except KeyboardInterrupt:
            found = {"error": "stopped before the first result"}
        except MemoryError:
            found = {"error": "this needs more memory than the studio may use; start the studio with a larger limit"}
        except RecursionError:
            found = {"error": "the blocks are nested too deeply"}
        except LookupError as error:
            found = {"error": f"invalid request: {error} is absent or unknown"}
        except Exception as error:
            found = {"error": f"ropewalk failed ({type(error).__name__}: {error}); this is a fault of ropewalk"}
        self._send(ticket, True, found if isinstance(found, bytes) else {"id": number, **found})

    def _say(self, message: Answer | bytes) -> None:
        """Send something before the answer to the question."""
        self._send(self._now[0], False, message if isinstance(message, bytes) else {"id": self._now[1], **message})

    def _send(self, ticket: int, last: bool, message: Answer | bytes | str) -> None:
        if not isinstance(message, bytes):
            message = json.dumps(message).replace(f"{self._folder}{os.sep}", "")  # no full paths on the page
        try:
            self._pipe.send((ticket, last, message))
        except OSError:  # the server has gone: a run ends as if it were stopped, and keeps what it has
            raise KeyboardInterrupt from None

    def _scenario(self, asked: Answer) -> Scenario:
        """The scenario of a text, refused where it runs code, leaves the folder or is huge."""
        from ropewalk.scenario import loads

        scenario = loads(str(asked["text"]), str(asked.get("name") or "scenario.yaml"))
        self._allow(scenario)
        return scenario

    def _allow(self, scenario: Scenario) -> None:
        from ropewalk.errors import Problem, ScenarioError
        from ropewalk.external.models import refuse_code

        if not self._allow_code:
            refuse_code(scenario.loads)
        check_inside(
            scenario.model_dump(mode="python", by_alias=True, exclude_unset=True, warnings=False), self._folder
        )
        for name, line in scenario.lines.items():
            if isinstance(elements := getattr(line, "elements", None), int) and elements > MOST_NODES:
                remedy = f"use at most {MOST_NODES} in the studio"
                raise ScenarioError([Problem(f"lines.{name}.elements", "is too large here", str(elements), remedy)])

    def _result(self, name: str) -> Path:
        return Folder(self._folder).file(name, RESULTS)

    def _do_check(self, asked: Answer) -> Answer:
        """Every mistake in a text."""
        self._scenario(asked)
        return {"problems": []}

    def _do_prepare(self, asked: Answer) -> Answer | bytes:
        """A scenario made ready for dragging, with what can be changed by hand; a picture where nothing can be."""
        from ropewalk.studio.poses import KEYS, Dragging, draggable, force_of
        from ropewalk.studio.preview import preview
        from ropewalk.studio.streams import of_frame

        scenario = self._scenario(asked)
        self._dragging = Dragging(scenario)
        found = []
        for name in draggable(scenario):
            load = scenario.loads[name]
            line = scenario.lines[load.on]
            kept = {key: getattr(line, key) for key in KEYS}
            found.append({"name": name, "on": load.on, "force": force_of(scenario, name), "line": kept})
        head = {"title": scenario.title, "loads": found, "gravity": scenario.gravity}
        if found or (declared := preview(scenario)) is None:
            return head
        return of_frame(declared, {"id": asked["id"], **head})

    def _asked(self, asked: Answer) -> Asked:
        from ropewalk.studio.poses import Asked

        given = asked["pose"]
        weight, wind = (None if (value := given.get(key)) is None else float(value) for key in ("weight", "wind"))
        contact = str(given.get("contact", "clamped"))
        return Asked(str(given["load"]), float(given["x"]), contact, weight, wind, dict(given.get("line", {})))

    def _do_pose(self, asked: Answer) -> Answer | bytes:
        """The equilibrium with the load under the pointer."""
        from ropewalk.studio.streams import of_pose

        if self._dragging is None:
            return {"error": "no scenario is loaded"}
        pose = self._dragging.posed(self._asked(asked))
        self._xi = pose.xi
        return of_pose(pose, self._dragging.attributes, {"id": asked["id"]})

    def _do_release(self, asked: Answer) -> Answer:
        """The motion of the load when it is let go where it was dragged to; not written to a file."""
        if self._dragging is None:
            return {"error": "no scenario is loaded"}
        return self._run(asked, self._dragging.released(self._asked(asked), self._xi), None)

    def _bound_disk(self) -> None:
        """Bound the files that are written from now on to what is left of the disk, or refuse to begin."""
        if self._disk:
            _bound("RLIMIT_FSIZE", Folder(self._folder).bytes_left(self._disk))

    def _do_run(self, asked: Answer) -> Answer:
        """A run as `ropewalk run` does it: its result is written while it goes on, unless it is not to be kept."""
        from ropewalk.results import ResultError
        from ropewalk.results.files import check_own

        scenario = self._scenario(asked)
        if asked.get("unkept"):
            return self._run(asked, scenario, None)
        self._bound_disk()
        file = self._result(f"{Path(str(asked.get('name') or 'scenario.yaml')).stem}.nc")
        if not asked.get("overwrite"):
            try:
                check_own(file, scenario)
            except ResultError:  # the page asks whether to replace it
                return {"replaces": file.name}
        return self._run(asked, scenario, file)

    def _run(self, asked: Answer, scenario: Scenario, file: Path | None) -> Answer:
        from ropewalk.model.run import Dynamic, Linear, Quasistatic
        from ropewalk.results.contract import scenario_attributes
        from ropewalk.simulate import must_compile, output_times, simulate
        from ropewalk.studio.streams import Streamed, stored

        run, how_long = scenario.run, must_compile(scenario)
        state = f"preparing, first run only ({how_long})" if how_long else "setting up"
        self._say({"event": "state", "state": state})
        total = run.positions if isinstance(run, Quasistatic) else 1
        if isinstance(run, Dynamic | Linear):
            total = int(output_times(run).size)
        send = Streamed(self._say, {"id": asked["id"]}, total, scenario_attributes(scenario))
        overwrite = bool(asked.get("overwrite"))
        dataset = simulate(scenario, file=file, overwrite=overwrite, progress=self._stop_if_asked, seen=send)
        with dataset:
            return {"file": file.name if file else None, **stored(dataset)}

    def _stop_if_asked(self, _: float) -> None:
        """Stop the run that goes on if the page says so, or has gone; what else it says waits."""
        while self._pipe.poll():
            try:
                asked = self._pipe.recv()
            except EOFError:
                raise KeyboardInterrupt from None
            if asked["do"] == "stop":
                self._send(ACKNOWLEDGED, False, {})
                self._say({"event": "stopped"})
                raise KeyboardInterrupt
            self._waiting.append(asked)

    def _do_result(self, asked: Answer) -> Answer:
        """A result that is there, as if it had just been computed; of a sweep, its cases."""
        from ropewalk.results import ResultError, open_result
        from ropewalk.studio.streams import of_result, stored

        file = self._result(str(asked["name"]))
        try:
            dataset = open_result(file)
        except ResultError:
            from ropewalk.studio.sweeps import described
            from ropewalk.sweeps.writing import read

            if (many := read(file)) is None:
                raise
            return {"file": file.name, "sweep": described(many)}
        with dataset:
            for message in of_result(dataset, {"id": asked["id"]}):
                self._say(message)
            return {"file": file.name, **stored(dataset)}

    def _do_lesson(self, asked: Answer) -> Answer:
        """Send the kept result of a lesson's scenario: nothing is computed, and nothing compiled."""
        from ropewalk.studio.lesson import kept_result
        from ropewalk.studio.streams import of_result

        dataset, ended = kept_result(str(asked["name"]))
        for message in of_result(dataset, {"id": asked["id"]}):
            self._say(message)
        return {"file": None, **ended}

    def _do_sweep(self, asked: Answer) -> Answer:
        """The sweep of a scenario, as `ropewalk sweep` does it, into FILE.sweep.nc and FILE.sweep.jsonl."""
        from ropewalk.results import ResultError
        from ropewalk.studio.sweeps import checked_plan, described
        from ropewalk.sweeps.plan import asked as wished
        from ropewalk.sweeps.sweeping import sweep
        from ropewalk.sweeps.writing import read, write

        scenario, folder = self._scenario(asked), Folder(self._folder)
        stem = Path(str(asked.get("name") or "scenario.yaml")).stem
        file, store = folder.file(f"{stem}.sweep.nc", RESULTS), folder.file(f"{stem}.sweep.jsonl", (".jsonl",))
        if file.exists() and read(file) is None:
            raise ResultError(f"{file.name}: exists already and is not a sweep; it is not overwritten")
        self._bound_disk()
        checked_plan(scenario, wished(scenario, None), self._allow, self._folder)

        def progress(done: int, total: int) -> None:
            self._say({"event": "cases", "done": done, "total": total})
            self._stop_if_asked(0.0)

        found = sweep(scenario, store=store, workers=self._processes, progress=progress)
        write(found, file)
        return {"file": file.name, "sweep": described(found)}

    def _do_models(self, asked: Answer) -> Answer:
        """Simpler models beside the full one, as `ropewalk compare` shows them."""
        import io

        from ropewalk.compare import model_hierarchy

        def progress(model: str, done: float) -> None:
            self._say({"event": "model", "model": model, "done": done})
            self._stop_if_asked(done)

        found, picture = model_hierarchy(self._scenario(asked), progress=progress), io.StringIO()
        found.figure().savefig(picture, format="svg")
        tables = [found.table(), [("assumptions", "measured"), *found.assumptions.table()]]
        return {"title": found.title, "tables": tables, "verdict": found.verdict, "picture": picture.getvalue()}

    def _do_case(self, asked: Answer) -> Answer:
        """The scenario of one case of a sweep."""
        from ropewalk.studio.sweeps import case_of
        from ropewalk.sweeps.writing import read

        file = self._result(str(asked["name"]))
        if (many := read(file)) is None:
            return {"error": f"{file.name}: is no sweep"}
        return case_of(many, int(asked["row"]), self._allow, self._folder)

    def _do_export(self, asked: Answer) -> Answer | bytes:
        """A result as a figure, film, table, report, or a page that needs no server; a sweep as figure or table."""
        from ropewalk.results import figure, film, html_report, open_result, write_tables
        from ropewalk.studio.share import shared
        from ropewalk.sweeps.writing import read, write

        file, kind = self._result(str(asked["name"])), str(asked["as"])
        with tempfile.TemporaryDirectory() as place:
            made = Path(place) / f"{file.stem}.{kind}"
            if (many := read(file)) is not None:
                if kind not in ("png", "svg", "pdf", "csv", "xlsx"):
                    return {"error": f"{kind}: sweeps are exported as png, svg, pdf, csv or xlsx"}
                write(many, made)
                return made.read_bytes()
            with open_result(file) as dataset:
                if kind in ("page", "report"):
                    return (shared if kind == "page" else html_report)(dataset).encode()
                if kind in ("png", "svg", "pdf"):
                    figure(dataset).savefig(made)
                elif kind in ("gif", "mp4"):
                    film(dataset, made)
                elif kind == "zip":  # all tables, where they are files of their own
                    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as several:
                        for table in write_tables(dataset, made.with_suffix(".csv")):
                            several.write(table, table.name)
                else:
                    made = write_tables(dataset, made)[0]
                return made.read_bytes()


def problems_of(error: Any) -> list[Answer]:
    """The problems of a scenario, as the page shows them."""
    from ropewalk.errors import condensed

    return [{**asdict(p), "message": str(replace(p, file="", line=None))} for p in condensed(error.problems)]
