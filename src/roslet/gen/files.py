"""Generated files: written where they differ from what is there."""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping


def write_files(directory: str | os.PathLike[str], files: Mapping[str, str]) -> list[str]:
    """Write files, by their paths below `directory` with `/`, in that order; those that changed, as full paths."""
    changed = []
    for path in sorted(files):
        full = os.path.join(directory, *path.split("/"))
        if _write_if_changed(full, files[path]):
            changed.append(full)
    return changed


def _write_if_changed(path: str, text: str) -> bool:
    try:
        with open(path, encoding="utf-8", newline="") as file:
            if file.read() == text:
                return False
    except FileNotFoundError:
        os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(text)
    return True
