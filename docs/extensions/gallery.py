"""The gallery: a page for every file of examples/, with its head comment, its picture and the summary of its run.

Pictures and summaries are kept in docs/images/gallery and renewed by `make pictures`; no example is run here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

import pictures
from sphinx.application import Sphinx

from ropewalk.scenario.examples import title_of

PAGES = Path(__file__).parents[1] / "gallery"
GROUPS = {
    "Ropeways, cable cranes and sheaves": ("cable-crane*", "ropeway*", "sheaves"),
    "Highlines, zip lines and tightropes": ("highline*", "leash*", "zip-line*", "tightrope", "heavy-slack*"),
    "Overhead lines and pantographs": ("en50318*", "overhead-line*", "simple-ac*"),
    "Bridges under trains and lorries": ("bridge*", "continuous-bridge*", "vehicle-on*", "bedded*"),
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


@dataclass(frozen=True)
class Example:
    """A file of examples/: its name, title, the comment at its head, its text, and what else can be done with it."""

    name: str
    title: str
    comment: str
    text: str
    more: tuple[str, ...]

    @property
    def group(self) -> str:
        """The heading that it stands under."""
        fitting = (title for title, patterns in GROUPS.items() if any(fnmatch(self.name, one) for one in patterns))
        return next(fitting, OTHERS)


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
                  if (pictures.EXAMPLES / link[0]).is_file() else link[0], text)  # fmt: skip


def page(example: Example) -> str:
    """The page of an example."""
    command = f"ropewalk run examples/{example.name}.yaml -o {example.name}.nc"
    show = f"ropewalk show {example.name}.nc -o {example.name}.png"
    also = [f"ropewalk {word} examples/{example.name}.yaml" for word in example.more]
    _, summary = pictures.read(example.name)
    head = "---\norphan: true\n---"  # all examples in the navigation of every page would take half the time of a build
    parts = [head, "[Gallery](index.md)", f"# {markdown(example.title)}", markdown(example.comment)]
    if summary:
        picture = f"../images/gallery/{example.name}.png"
        parts += [f"```{{figure}} {picture}\n:figclass: gallery-picture\n:alt: {example.title}\n```"]
    parts += ["```shell\n" + "\n".join([command, show, *also]) + "\n```"]
    parts += ["## The file", f"```{{literalinclude}} ../../examples/{example.name}.yaml\n:language: yaml\n```"]
    if summary:
        parts += ["## Summary of the run", f"```text\n{summary.rstrip()}\n```"]
    return "\n\n".join(part for part in parts if part) + "\n"


def index(examples: list[Example]) -> str:
    """The page of all examples, as cards under headings."""
    parts = ["# Gallery", f"{len(examples)} examples, each a file that runs in seconds: copy the one that comes "
             "nearest to your question, and change it."]  # fmt: skip
    for title in [*GROUPS, OTHERS]:
        here = [example for example in examples if example.group == title]
        if here:
            cards = "\n".join(map(card, here))
            parts += [f"## {title}", f"::::{{grid}} 2 2 3 3\n:gutter: 2\n\n{cards}\n::::"]
    return "\n\n".join(parts) + "\n"


def card(example: Example) -> str:
    """An example as a card."""
    picture = f":img-top: ../images/gallery/{example.name}.card.png\n" if pictures.read(example.name)[0] else ""
    return f":::{{grid-item-card}} {markdown(example.title)}\n:link: {example.name}\n:link-type: doc\n{picture}:::"


def trades() -> str:
    """The trades as cards, with their pictures."""
    cards = []
    for title, (where, name, text) in TRADES.items():
        picture = f":img-top: images/gallery/{name}.card.png\n" if pictures.read(name)[0] else ""
        cards.append(f":::{{grid-item-card}} {title}\n:link: {where}\n:link-type: doc\n{picture}\n{text}\n:::")
    return "::::{grid} 2 2 3 3\n:gutter: 2\n\n" + "\n".join(cards) + "\n::::"


def write(path: Path, text: str) -> None:
    """Write a page if it has changed: the builder goes by times."""
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def build(_: Sphinx | None) -> None:
    """Write the pages of the gallery."""
    examples = [read(path) for path in sorted(pictures.EXAMPLES.glob("*.yaml"))]
    pages = {"index": index(examples), **{example.name: page(example) for example in examples}}
    PAGES.mkdir(exist_ok=True)
    for old in PAGES.glob("*.md"):
        if old.stem not in pages:
            old.unlink()
    for name, text in pages.items():
        write(PAGES / f"{name}.md", text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the gallery."""
    app.connect("builder-inited", build)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
