"""Public names that have changed keep working for one release and name their successors."""

from __future__ import annotations

from importlib import import_module

import pytest
from typer.testing import CliRunner

import ropewalk
from ropewalk.cli.app import app
from ropewalk.renamed import with_old_arguments


@pytest.mark.parametrize(("module", "old", "new"), [
    ("ropewalk", "ladder", "model_hierarchy"), ("ropewalk", "Ladder", "ModelHierarchy"),
    ("ropewalk.cosim", "Ride", "LoneVehicle"),
    ("ropewalk.cosim", "Sight", "ContactOutput"),
])  # fmt: skip
def test_an_old_name_is_the_new_one_with_a_warning(module: str, old: str, new: str) -> None:
    home = import_module(module)
    with pytest.warns(DeprecationWarning, match=f"{old} was renamed to .*{new}"):
        found = getattr(home, old)
    assert found is getattr(home, new)


def test_an_old_argument_is_the_new_one_with_a_warning() -> None:
    @with_old_arguments({"rung": "model"})
    def asked(*, model: str) -> str:
        return model

    with pytest.warns(DeprecationWarning, match=r"asked\(rung=...\) was renamed to asked\(model=...\)"):
        assert asked(**{"rung": "linear"}) == "linear"
    assert asked(model="full") == "full"


def test_what_is_no_name_is_refused() -> None:
    for module in (ropewalk, import_module("ropewalk.cosim")):
        with pytest.raises(AttributeError, match="ladders"):
            module.ladders  # noqa: B018


def test_an_old_option_works_and_says_so() -> None:
    found = CliRunner().invoke(app, ["adequacy", "none.yaml", "--x", "a=1:2:2", "--y", "b=1:2:2", "--rung", "linear"])
    assert "--rung was renamed to --model" in found.output
    assert "none.yaml" in found.output
