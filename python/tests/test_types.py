"""The stubs say what the compiled part has, and the examples hold to them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import slump
from slump._slump import _kinds

STUB = Path(slump.__file__).parent / "_slump.pyi"
SOURCE = Path(__file__).parent.parent / "slump" / "_slump.pyi"
EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))
BEGINS, ENDS = "# Settings: ", "# Settings end.\n"


def type_of(kind: str | list[str]) -> str:
    return kind if isinstance(kind, str) else f"Literal[{', '.join(map(repr, kind))}]".replace("'", '"')


def section() -> str:
    """What a stub has to say of the settings that there are."""
    kinds = {name: type_of(kind) for name, kind in _kinds().items()}
    lines = ["class _Settings(TypedDict):"]
    lines += [f"    {name}: {kind}" for name, kind in kinds.items()]
    lines += ["", "class _Changes(TypedDict, total=False):"]
    lines += [f"    {name}: {kind} | None" for name, kind in kinds.items()]
    lines += ["", "class _Attributes:"]
    lines += [f"    {name}: {kind}" for name, kind in kinds.items()]
    return "\n".join(lines) + "\n"


def test_the_stub_has_all_settings() -> None:
    text = SOURCE.read_text()
    first = text.index("\n", text.index(BEGINS)) + 1
    last = text.index(ENDS)
    if os.environ.get("SLUMP_BLESS"):
        SOURCE.write_text(text[:first] + section() + text[last:])
    else:
        assert text[first:last] == section(), "renew it with SLUMP_BLESS=1"


def test_the_stub_has_all_other_options() -> None:
    text = SOURCE.read_text()
    signature = text[text.index("class _Options") : text.index("class Simulation")]
    for name in slump.options():
        assert name in (*_kinds(), "scene", "initial") or f"    {name}: " in signature, name


def run(*command: str) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_of_the_compiled_part() -> None:
    run("mypy.stubtest", "slump", "--concise")


def test_examples_hold_to_the_types(tmp_path: Path) -> None:
    config = Path(__file__).parent.parent / "pyproject.toml"
    run("mypy", "--config-file", str(config), "--cache-dir", str(tmp_path), *map(str, EXAMPLES))
