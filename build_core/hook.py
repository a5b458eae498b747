"""Compile the core into the wheel, or beside its sources where the installation is editable."""

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent))
import compiler


class Hook(BuildHookInterface):  # type: ignore[type-arg]
    """Compiles the core."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, and tell the builder where the library belongs."""
        root, tag = Path(self.root), compiler.platform_tag()
        home = root / "src" / "ropewalk" / "engine"
        library = compiler.build(root, home if version == "editable" else root / "build" / "core" / tag)
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{tag}"
        build_data["force_include"][str(library)] = f"ropewalk/engine/{library.name}"
