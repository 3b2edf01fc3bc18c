"""Runs the program `slump`, with which tests compare the package."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent.parent


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run `slump` with arguments, and return the finished process."""
    path = Path(os.environ.get("SLUMP_PROGRAM", ROOT / "target" / "release" / "slump"))
    assert path.exists(), f"{path} is to be built first: cargo build --release --no-default-features"
    return subprocess.run([str(path), *arguments], capture_output=True, text=True, timeout=300)


def as_arguments(options: dict[str, Any]) -> list[str]:
    """Return keyword arguments in the form of the command line."""

    def text(value: object) -> str:
        return str(value).lower() if isinstance(value, bool) else str(value)

    return [f"--{name.replace('_', '-')}={text(value)}" for name, value in options.items()]
