"""Parameter values given as text on a command line, as ROS reads them: YAML."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_WORDS = {
    "true": True,
    "false": False,
    "yes": True,
    "no": False,
    "on": True,
    "off": False,
    "null": None,
    "~": None,
    "": "",
}


def parse_value(text: str) -> Any:
    """The value that `text` means. With PyYAML installed any YAML; otherwise scalars and JSON, else the text itself."""
    try:
        import yaml  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        return _parse_scalar(text)
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        return text
    return "" if value is None and not text.strip() else value


def _parse_scalar(text: str) -> Any:
    import json

    stripped = text.strip()
    if stripped.lower() in _WORDS:
        return _WORDS[stripped.lower()]
    for read in (_integer, float, json.loads):
        try:
            return read(stripped)
        except ValueError:
            continue
    return text


def _integer(text: str) -> int:
    return int(text, 0) if text[:2].lower() in ("0x", "0o", "0b") else int(text)
