"""Links of pages that are read in the repository, too: what is beside docs/ there has a page of its own here."""

from __future__ import annotations

import posixpath
import re

from sphinx.application import Sphinx

EXAMPLE = re.compile(r"\]\((?:\.\./)+examples(?:/([\w-]+)\.yaml)?\)")
LINK = re.compile(r"\]\(((?:\.\./)+|docs/)?(notes/?|README\.md|CONTRIBUTING\.md|CHANGELOG\.md|CODE_OF_CONDUCT\.md"
                  r"|SECURITY\.md)\)")  # fmt: skip
PAGES = {
    "notes": "notes/index.md",
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changes.md",
    "CODE_OF_CONDUCT.md": "conduct.md",
    "SECURITY.md": "security.md",
}


def up(docname: str) -> str:
    """The way from a page to the folder of all pages."""
    return "../" * docname.count("/")


def adapted(docname: str, text: str) -> str:
    """The text of a page with links to examples and to files beside docs/ led to their pages."""
    text = EXAMPLE.sub(lambda link: f"]({up(docname)}gallery/{link[1] or 'index'}.md)", text)
    text = LINK.sub(lambda link: f"]({up(docname)}{PAGES[link[2].rstrip('/')]})", text)
    if docname in ("contributing", "changes", "conduct", "security"):  # written for the root of the repository
        text = re.sub(r"\]\(docs/", "](", text)
    return text


def read(_: Sphinx, docname: str, source: list[str]) -> None:
    """Adapt a page when it is read."""
    source[0] = adapted(posixpath.normpath(docname), source[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register what is done when pages are read."""
    app.connect("source-read", read, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
