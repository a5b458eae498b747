"""Renew the pictures of the gallery in docs/images/gallery:  make pictures

Run every example. Draw its picture again where its file or the numbers of its summary have changed since the picture
was made, and always with `--all` (after a change of how figures look). Names of examples restrict the renewal to them.
A renewal that was interrupted continues where it stopped, unless the package has changed since.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image
from ruamel.yaml import YAML

import ropewalk
from ropewalk.results.figures import panels_of

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
FOLDER = ROOT / "docs" / "images" / "gallery"
FINISHED = ROOT / "build" / "pictures.txt"
"""State of the package, then the examples whose pictures an interrupted renewal has finished."""
SUFFIXES = (".png", ".card.png", ".txt")
TOLERANCE = 0.02
"""Relative difference up to which two numbers agree: processors round differently, and peaks are sampled."""
FLOOR = 1e-3
"""Part of the largest number with the same unit below which differences are rounding errors."""
UNCOMPARED = re.compile(r"residual|estimated error|step|method|iterations")
"""Rows whose numbers are errors or belong to the method."""
NUMBER = re.compile(
    r"(?P<row>\S+(?: \S+)*) {2,}(?P<value>-?\d[\d.]*(?:e[+-]\d+)?)"
    r"(?:°| ?(?P<prefix>[µmkM]?)(?P<unit>[NJWsmPg][\w/²·]*)?)(?: |$)"
)
PREFIXES = {"": 1.0, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6}
RESOLUTION = {".png": 110, ".card.png": 150}
"""Dots per inch: sharp in a column of text, and all pictures together less than 8 MB."""
COLOURS = 64
TIME_LIMIT = 900
"""Seconds after which a run is given up."""


def examples() -> list[str]:
    """Return the names of all examples."""
    return sorted(path.stem for path in EXAMPLES.glob("*.yaml"))


def kept(name: str, suffix: str) -> Path:
    """Return the path of the picture, of the small picture or of the summary of an example."""
    return FOLDER / f"{name}{suffix}"


def key(name: str) -> str:
    """Return a hash of the contents of an example; comments are not part of it."""
    contents = YAML(typ="safe").load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    return hashlib.sha256(json.dumps(contents, default=str).encode()).hexdigest()[:16]


def read(name: str) -> tuple[str, str]:
    """Return the key and the summary that belong to the picture of an example; empty where there is no picture."""
    if not all(kept(name, suffix).is_file() for suffix in SUFFIXES):
        return "", ""
    first, _, summary = kept(name, ".txt").read_text(encoding="utf-8").partition("\n")
    return first.rpartition(" ")[2], summary


def numbers(summary: str) -> dict[str, tuple[float, str]]:
    """Return the number and the unit without prefix of every row of a summary, by heading and row."""
    found, heading = dict[str, tuple[float, str]](), ""
    for line in summary.splitlines():
        row = NUMBER.match(line)
        if row is None:
            heading = heading if "  " in line else line
        elif not UNCOMPARED.search(row["row"]):
            prefix, unit = (row["prefix"] or "", row["unit"]) if row["unit"] else ("", row["prefix"] or "")
            size = PREFIXES[prefix] / (3600 if unit == "m/h" else 1)
            found[f"{heading}: {row['row']}"] = float(row["value"]) * size, unit.replace("m/h", "m/s")
    return found


def differences(old: str, new: str) -> list[str]:
    """Return the rows whose numbers differ between two summaries, with both numbers."""
    before, after = numbers(old), numbers(new)
    largest = dict[str, float]()
    for value, unit in (*before.values(), *after.values()):
        largest[unit] = max(largest.get(unit, 0.0), abs(value))
    found = [f"{row}: only one of two summaries has it" for row in before.keys() ^ after.keys()]
    for row in before.keys() & after.keys():
        (a, unit), (b, _) = before[row], after[row]
        if abs(a - b) > max(TOLERANCE * max(abs(a), abs(b)), FLOOR * largest[unit]):
            found.append(f"{row}: {a:g} and {b:g} {unit}")
    return sorted(found)


def run(name: str, result: Path) -> str:
    """Run an example and return its summary without the time that the run took.

    Raises:
        RuntimeError: the run wrote no result; with the end of its message.
    """
    command = [sys.executable, "-m", "ropewalk", "run", f"examples/{name}.yaml", "-o", str(result), "--overwrite"]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
    except subprocess.TimeoutExpired as late:
        raise RuntimeError(f"the run took more than {TIME_LIMIT} s") from late
    if not result.is_file():
        raise RuntimeError(" ".join(done.stderr.split())[-300:] or f"the run ended with code {done.returncode}")
    return re.sub(r"^time taken .*\n", "", done.stdout.replace(str(result), f"{name}.nc"), flags=re.MULTILINE)


def draw(name: str, result: Path) -> None:
    """Write the figure of a result as `ropewalk show` draws it, and its first panel as the small picture."""
    with ropewalk.open_result(result) as dataset:
        panels = panels_of(dataset)
        first = "shapes" if "shapes" in panels else panels[0]
        figures = {
            ".png": ropewalk.figure(dataset),
            ".card.png": ropewalk.figure(dataset, panels=[first], size="12x6cm"),
        }
        for suffix, figure in figures.items():
            drawn = io.BytesIO()
            figure.savefig(drawn, format="png", dpi=RESOLUTION[suffix])
            few = Image.open(drawn).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
            few.save(kept(name, suffix), optimize=True)


def renew(name: str, always: bool) -> str:
    """Renew the picture of an example where this is necessary, and return the reason."""
    old_key, old = read(name)
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / f"{name}.nc"
        new = run(name, result)
        changed = differences(old, new)
        reason = (
            "new" if not old_key else "example changed" if old_key != key(name) else
            f"numbers changed ({changed[0]})" if changed else "drawn again" if always else ""
        )  # fmt: skip
        if reason:
            draw(name, result)
    if reason or new != old:
        kept(name, ".txt").write_text(f"contents of the example: {key(name)}\n{new}", encoding="utf-8")
    return reason or ("unchanged" if new == old else "picture unchanged, summary renewed")


class Progress:
    """Examples that a renewal has finished, on disk until all are, so that it can continue after an interruption."""

    def __init__(self, always: bool) -> None:
        state = hashlib.sha256(str(always).encode())
        for path in sorted(Path(ropewalk.__file__).parent.rglob("*.py")):
            state.update(path.read_bytes())
        earlier = FINISHED.read_text(encoding="utf-8").split() if FINISHED.is_file() else []
        self.names = earlier if earlier[:1] == [state.hexdigest()] else [state.hexdigest()]

    def add(self, name: str) -> None:
        """Note that an example is finished."""
        self.names.append(name)
        FINISHED.parent.mkdir(exist_ok=True)
        FINISHED.write_text("\n".join(self.names), encoding="utf-8")


def renew_all(names: list[str], always: bool) -> list[str]:
    """Renew the pictures of examples, print every one of them, and return those that failed."""
    progress, failed = Progress(always), []
    everything = names == examples()
    for number, name in enumerate(names, 1):
        if everything and name in progress.names:
            continue
        print(f"[{number:2}/{len(names)}] {name}: ", end="", flush=True)
        begin = time.perf_counter()
        try:
            print(renew(name, always), f"({time.perf_counter() - begin:.0f} s)", flush=True)
        except (RuntimeError, ValueError) as problem:
            failed.append(name)
            print(f"not renewed: {problem}", flush=True)
        else:
            progress.add(name)
    if everything:
        FINISHED.unlink(missing_ok=True)
    return failed


def remove_orphans() -> None:
    """Remove pictures of examples that no longer exist."""
    for path in FOLDER.iterdir():
        if path.name.partition(".")[0] not in examples():
            path.unlink()
            print(f"removed {path.name}: there is no such example", flush=True)


def main() -> int:
    """Renew the pictures of all examples, or of those named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="an example, such as zip-line (default: all)")
    parser.add_argument("--all", action="store_true", help="draw every picture again")
    options = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    failed = renew_all(options.names or examples(), options.all)
    remove_orphans()
    size = sum(path.stat().st_size for path in FOLDER.iterdir())
    print(f"All pictures together have {size / 1e6:.1f} MB.", f"Not renewed: {', '.join(failed)}" if failed else "")
    return len(failed) > 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("\nInterrupted. The same command continues with the next example.")
