"""What a program finds as `roslib`."""

from __future__ import annotations


def load_manifest(package_name: str, bootstrap_version: str = "0.7") -> None:
    """Did something for rosbuild packages, ten years ago. Has no effect."""


__all__ = ["load_manifest"]
