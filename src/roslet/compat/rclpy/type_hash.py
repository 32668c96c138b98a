"""`rclpy.type_hash`: the hash of a type's description."""

from __future__ import annotations

_SIZE = 32


class TypeHash:
    """Version and 32 bytes of a hash; version -1 is none. Written as `RIHS01_` and 64 hexadecimal digits."""

    __slots__ = ("_value", "_version")

    def __init__(self, version: int = -1, value: bytes = bytes(_SIZE)) -> None:
        self.version = version
        self.value = value

    @property
    def version(self) -> int:
        return self._version

    @version.setter
    def version(self, value: int) -> None:
        assert isinstance(value, int)
        self._version = value

    @property
    def value(self) -> bytes:
        return self._value

    @value.setter
    def value(self, value: bytes) -> None:
        assert isinstance(value, bytes)
        self._value = value

    @classmethod
    def from_text(cls, text: str) -> TypeHash:
        """From what `str` gives; one without a version where it is no such text."""
        head, _, digits = text.partition("_")
        if head != "RIHS01" or len(digits) != 2 * _SIZE:
            return cls()
        return cls(1, bytes.fromhex(digits))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TypeHash):
            return False
        return (self._version, self._value) == (other._version, other._value)

    def __hash__(self) -> int:
        return hash((self._version, self._value))

    def __str__(self) -> str:
        if self._version != 1 or len(self._value) != _SIZE:
            return "INVALID"
        return f"RIHS{self._version:02d}_{self._value.hex()}"

    def __repr__(self) -> str:
        return f"TypeHash(version={self._version}, value={self._value!r})"


__all__ = ["TypeHash"]
