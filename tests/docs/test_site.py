"""The site: built without a warning, nothing loaded from elsewhere, every link inside leads somewhere.

Outside addresses cannot be asked without a network, and are not.
"""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
import typer.main

import ropewalk
from ropewalk.cli.app import app

ROOT = Path(__file__).parent.parent.parent
DOCS = ROOT / "docs"
LOADING = {
    "script": "src",
    "img": "src",
    "link": "href",
    "iframe": "src",
    "source": "src",
    "video": "src",
    "object": "data",
}
MARKDOWN = [*ROOT.glob("*.md"), *(path for path in DOCS.rglob("*.md") if path.parent != DOCS / "gallery")]


class Page(HTMLParser):
    """What a page loads, what it links to, and the anchors it has."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.loads: set[str] = set()
        self.links: set[str] = set()
        self.anchors: set[str] = {""}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors.add(given.get("id", ""))
        self.loads.add(given.get(LOADING.get(tag, ""), ""))
        if tag == "a":
            self.links.add(given.get("href", ""))


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site as `make docs` builds it."""
    target = tmp_path_factory.mktemp("site")
    options = ["--quiet", "--fail-on-warning", "--keep-going", "--nitpicky", "--fresh-env", "--builder", "html"]
    command = [
        sys.executable,
        "-m",
        "sphinx",
        *options,
        "--doctree-dir",
        str(target / "trees"),
        str(DOCS),
        str(target / "html"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return target / "html"


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    return {path: Page(path) for path in site.rglob("*.html")}


def test_nothing_is_loaded_from_elsewhere(site: Path, pages: dict[Path, Page]) -> None:
    loaded = {address for page in pages.values() for address in page.loads}
    assert not {address for address in loaded if urlsplit(address).netloc}
    for style in site.rglob("*.css"):
        assert not re.search(r"(@import|url\()\s*[\"']?(https?:)?//", style.read_text(encoding="utf-8")), style


def test_every_link_inside_leads_to_a_page_and_its_anchor(pages: dict[Path, Page]) -> None:
    dead = set()
    for path, page in pages.items():
        for link in page.links:
            to = urlsplit(link)
            if to.scheme or to.netloc:
                continue
            target = (path.parent / unquote(to.path)).resolve() if to.path else path
            known = pages[target].anchors if target in pages else {""}
            if not target.is_file() or (target.suffix == ".html" and unquote(to.fragment) not in known):
                dead.add(f"{path.name}: {link}")
    assert not dead


def test_every_example_command_and_public_name_has_its_place(site: Path, pages: dict[Path, Page]) -> None:
    examples = {path.stem for path in (ROOT / "examples").glob("*.yaml")}
    assert {path.stem for path in (site / "gallery").glob("*.html")} - {"index"} == examples
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    assert {f"ropewalk-{name}" for name in commands} <= pages[site / "command-line.html"].anchors
    known = {anchor.removeprefix("ropewalk.").rpartition(".")[2] for anchor in pages[site / "python.html"].anchors}
    assert set(ropewalk.__all__) - {"calc", "theory"} <= known


def test_formulas_are_set(site: Path) -> None:
    text = (site / "formulas.html").read_text(encoding="utf-8")
    assert text.count('<math xmlns="http://www.w3.org/1998/Math/MathML" display="block"') >= 10
    assert "$" not in re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)
    assert "\\" not in "".join(re.findall(r"<math.*?</math>", text, flags=re.DOTALL))


def test_the_citation_names_this_version() -> None:
    assert f"\nversion: {ropewalk.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", MARKDOWN, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_of_pages_lead_to_files_of_the_repository(page: Path) -> None:
    """As they are read without the site."""
    text = re.sub(r"^```.*?^```$|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    links = {urlsplit(link) for link in re.findall(r"\]\(([^)\s]+)\)", text)}
    assert not [link.path for link in links if not link.netloc and link.path and not (page.parent / link.path).exists()]
