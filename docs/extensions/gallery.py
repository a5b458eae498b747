"""The gallery: a page for every file of examples/, with its head comment, its picture and what a run prints.

Pictures are made by running the examples. They are kept in build/gallery by the contents of the example and of the
program, so that a second build makes only those that have changed. ROPEWALK_PICTURES=none makes none.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util import logging

import ropewalk
from ropewalk.scenario.examples import title_of

ROOT = Path(__file__).parent.parent.parent
EXAMPLES = ROOT / "examples"
PAGES = ROOT / "docs" / "gallery"
KEPT = ROOT / "build" / "gallery"
GROUPS = {
    "Ropeways, cable cranes and sheaves": ("cable-crane*", "ropeway*", "sheaves", "crane-on-rope"),
    "Highlines, zip lines and tightropes": ("highline*", "leash*", "zip-line*", "tightrope", "heavy-slack*"),
    "Overhead lines and pantographs": ("en50318*", "overhead-line*", "simple-ac*"),
    "Bridges under trains and lorries": ("bridge*", "continuous-bridge*", "vehicle-on*", "uvec*", "exudyn*", "bedded*"),
    "Footbridges": ("footbridge*", "suspension*"),
    "Ropes, strings and nets as such": ("moving-force", "mass-*", "whirling*", "trampoline*"),
}
OTHERS = "More"
TRADES = {
    "Ropeways and cable cranes": (
        "ropeways", "ropeway-tower-brake",
        "Track ropes over towers, carriages with cabins, hauling ropes, brakes, crabs with hoists.",
    ),
    "Highlines, slacklines and zip lines": (
        "highlines", "highline-walker", "Walkers, falls into the leash, webbing with hysteresis, backup lines.",
    ),
    "Overhead lines and pantographs": (
        "overhead-lines", "overhead-line-limits", "Wires on droppers, contact forces and their limits, overlaps.",
    ),
    "Bridges under trains and lorries": (
        "bridges", "bridge-hslm", "Axle loads, vehicles on springs, resonance, rough roads, ballasted track.",
    ),
    "Footbridges under people": (
        "footbridges", "suspension-footbridge", "Footsteps, walkers, crowds, lock-in; beams and suspension bridges.",
    ),
    "Research": (
        "tutorials/research", "moving-force",
        "From Python: convergence beside exact solutions, controllers, sweeps, designs.",
    ),
}  # fmt: skip
"""The trades of the first page: where each leads, an example whose picture it has, and what there is."""
DRAWING = str(Path(__file__).with_name("drawing_twice.py"))
TOO_LONG = 600
"""Seconds after which an example stays without a picture."""
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Example:
    """A file of examples/: its name, title, the comment at its head, its text, and what else can be done with it."""

    name: str
    title: str
    comment: str
    text: str
    more: tuple[str, ...]

    @property
    def key(self) -> str:
        """What its picture hangs on."""
        return hashlib.sha256(f"{self.text}{program()}".encode()).hexdigest()[:16]

    @property
    def group(self) -> str:
        """The heading that it stands under."""
        fitting = (title for title, patterns in GROUPS.items() if any(fnmatch(self.name, one) for one in patterns))
        return next(fitting, OTHERS)

    def kept(self, suffix: str) -> Path:
        """Where its picture, or what its run printed, is kept."""
        return KEPT / f"{self.name}-{self.key}{suffix}"


@cache
def program() -> str:
    """A hash of all sources of the package: pictures are of this program."""
    found = hashlib.sha256()
    for path in sorted(Path(ropewalk.__file__).parent.rglob("*.py")):
        if "__pycache__" not in path.parts:
            found.update(path.read_bytes())
    return found.hexdigest()


def read(path: Path) -> Example:
    """An example as it is written."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    head = [line for line in lines[: next(i for i, line in enumerate(lines) if line.startswith("lines:") or
            re.match(r"\w+:\s*$|gravity:", line))] if line.startswith("#")]  # fmt: skip
    prose = [f"`{line.lstrip('# ')}`" if line.startswith("#   ") else line.lstrip("# ").rstrip() for line in head]
    more = tuple(word for word in ("sweep", "design", "fit") if any(line.startswith(f"{word}:") for line in lines))
    return Example(path.stem, title_of(text), " ".join(prose), text, more)


def markdown(comment: str) -> str:
    """A comment as Markdown that reads as it is written, with links to the pages and examples that it names."""
    parts = re.split(r"(`[^`]*`)", comment)
    parts[::2] = [re.sub(r"([*_<>\[\]$])", r"\\\1", part) for part in parts[::2]]
    text = "".join(parts)
    text = re.sub(r"docs/([\w\\/-]+)\.md", lambda link: f"[{link[1]}](../{link[1].replace(chr(92), '')}.md)", text)
    return re.sub(r"(?<![\w/`])([\w-]+)\.yaml(?!`)", lambda link: f"[{link[0]}]({link[1]}.md)"
                  if (EXAMPLES / link[0]).is_file() else link[0], text)  # fmt: skip


def page(example: Example) -> str:
    """The page of an example."""
    command = f"ropewalk run examples/{example.name}.yaml -o {example.name}.nc"
    show = f"ropewalk show {example.name}.nc -o {example.name}.png"
    also = [f"ropewalk {word} examples/{example.name}.yaml" for word in example.more]
    printed = example.kept(".txt")
    head = "---\norphan: true\n---"  # all examples in the navigation of every page would take half the time of a build
    parts = [head, "[Gallery](index.md)", f"# {markdown(example.title)}", markdown(example.comment)]
    if example.kept(".png").is_file():
        parts += [f"```{{figure}} pictures/{example.name}.png\n:figclass: gallery-picture\n:alt: {example.title}\n```"]
    elif printed.is_file():
        parts += ["No picture was made here:\n\n```text\n" + printed.read_text(encoding="utf-8").rstrip() + "\n```"]
    parts += ["```shell\n" + "\n".join([command, show, *also]) + "\n```"]
    parts += ["## The file", f"```{{literalinclude}} ../../examples/{example.name}.yaml\n:language: yaml\n```"]
    if example.kept(".png").is_file():
        parts += ["## What the run says", "```text\n" + printed.read_text(encoding="utf-8").rstrip() + "\n```"]
    return "\n\n".join(part for part in parts if part) + "\n"


def index(examples: list[Example]) -> str:
    """The page of all examples, as cards under headings."""
    parts = ["# Gallery", f"{len(examples)} examples, each a file that runs in seconds: copy the one that comes "
             "nearest to your question, and change it."]  # fmt: skip
    for title in [*GROUPS, OTHERS]:
        here = [example for example in examples if example.group == title]
        if here:
            cards = "\n".join(map(card, here))
            parts += [f"## {title}", f"::::{{grid}} 1 2 3 3\n:gutter: 2\n\n{cards}\n::::"]
    return "\n\n".join(parts) + "\n"


def card(example: Example) -> str:
    """An example as a card."""
    picture = f":img-top: pictures/{example.name}.card.png\n" if example.kept(".card.png").is_file() else ""
    return f":::{{grid-item-card}} {markdown(example.title)}\n:link: {example.name}\n:link-type: doc\n{picture}:::"


def trades() -> str:
    """The trades as cards, with the pictures that there are."""
    cards = []
    for title, (where, name, text) in TRADES.items():
        there = (PAGES / "pictures" / f"{name}.card.png").is_file()
        picture = f":img-top: gallery/pictures/{name}.card.png\n" if there else ""
        cards.append(f":::{{grid-item-card}} {title}\n:link: {where}\n:link-type: doc\n{picture}\n{text}\n:::")
    return "::::{grid} 1 2 3 3\n:gutter: 2\n\n" + "\n".join(cards) + "\n::::"


def draw(example: Example) -> None:
    """Run an example and draw it, for its page and for its card; what it says of itself stands beside the picture."""
    with tempfile.TemporaryDirectory() as folder:
        result, *pictures = (Path(folder) / f"result{suffix}" for suffix in (".nc", ".png", ".card.png"))
        ropewalk_command = [sys.executable, "-m", "ropewalk"]
        run = called([*ropewalk_command, "run", f"examples/{example.name}.yaml", "-o", str(result)])
        says = run.stdout.replace(str(result), f"{example.name}.nc")
        if result.is_file():
            shown = called([sys.executable, DRAWING, str(result), *map(str, pictures)])
            says = says if shown.returncode == 0 else shown.stderr
        else:
            says = run.stderr
        KEPT.mkdir(parents=True, exist_ok=True)
        for old in KEPT.glob(f"{example.name}-{'?' * 16}.*"):
            old.unlink()
        example.kept(".txt").write_text(says, encoding="utf-8")
        for picture, suffix in zip(pictures, (".png", ".card.png"), strict=True):
            if picture.is_file():
                shutil.copy(picture, example.kept(suffix))


def called(command: list[str]) -> subprocess.CompletedProcess[str]:
    """A command of the program, which is over in time or has failed."""
    try:
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=TOO_LONG, check=False)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 1, "", f"not over after {TOO_LONG} s\n")


def draw_missing(examples: list[Example]) -> None:
    """Draw those that are not kept, the first alone: what it compiles serves the others.

    What could not be drawn (a package that is not installed, no time) is tried again by the next build.
    """
    missing = [example for example in examples if not example.kept(".card.png").is_file()]
    if missing:
        log.info("drawing %d of %d examples (minutes; kept in %s)", len(missing), len(examples), KEPT)
        draw(missing[0])
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(draw, missing[1:]))


def write(path: Path, text: str) -> None:
    """Write a page if it has changed: the builder goes by times."""
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def build(_: Sphinx | None) -> None:
    """Write the pages of the gallery."""
    examples = [read(path) for path in sorted(EXAMPLES.glob("*.yaml"))]
    if os.environ.get("ROPEWALK_PICTURES") != "none":
        draw_missing(examples)
    pictures = PAGES / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    pages = {"index": index(examples), **{example.name: page(example) for example in examples}}
    for old in [*PAGES.glob("*.md"), *pictures.glob("*.png")]:
        if old.name.split(".")[0] not in pages:
            old.unlink()
    for example in examples:
        for suffix in (".png", ".card.png"):
            if example.kept(suffix).is_file():
                shutil.copy2(example.kept(suffix), pictures / f"{example.name}{suffix}")
    for name, text in pages.items():
        write(PAGES / f"{name}.md", text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the gallery."""
    app.connect("builder-inited", build)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
