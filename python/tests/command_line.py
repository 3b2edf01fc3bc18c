"""The program itself, which the package is held against."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent.parent


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs `slump` with arguments."""
    path = Path(os.environ.get("SLUMP_PROGRAM", ROOT / "target" / "release" / "slump"))
    assert path.exists(), f"{path} is to be built first: cargo build --release --no-default-features"
    return subprocess.run([str(path), *arguments], capture_output=True, text=True, timeout=300)


def as_arguments(options: dict[str, Any]) -> list[str]:
    """Keyword arguments as the command line writes them."""

    def text(value: object) -> str:
        return str(value).lower() if isinstance(value, bool) else str(value)

    return [f"--{name.replace('_', '-')}={text(value)}" for name, value in options.items()]
