"""Parameter values given as text on a command line, as ROS reads them: YAML."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
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
        value = load_yaml(yaml, text)
    except ValueError:
        return text
    return "" if value is None and not text.strip() else value


def load_yaml(yaml: ModuleType, text: str) -> Any:
    """The value of a YAML text. Raises ValueError that says where and what is wrong."""
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or str(error)
        place = "" if mark is None else f"line {mark.line + 1}, column {mark.column + 1}: "
        raise ValueError(f"{place}{problem}") from None
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # PyYAML lets these out where a tag does not fit its value (`!!int x`), or a date is none (2020-13-45).
        raise ValueError(f"{type(error).__name__}: {error}") from None


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
