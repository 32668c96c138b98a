"""`roslib.packages`: where a package is, by $ROS_PACKAGE_PATH."""

from __future__ import annotations

import os


class InvalidROSPkgException(Exception):
    """No such package."""


# Folders below a workspace that are looked into; the depth of a package in the workspaces in use is two or three.
MAX_DEPTH = 5


def get_pkg_dir(package: str, required: bool = True, ros_root: str | None = None) -> str | None:
    """The folder of a package. Raises InvalidROSPkgException where there is none and it is `required`."""
    for root in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        for folder, folders, files in os.walk(root) if root else ():
            if "package.xml" in files:
                folders.clear()
                if os.path.basename(folder) == package:
                    return folder
            elif folder[len(root) :].count(os.sep) >= MAX_DEPTH:
                folders.clear()
    if required:
        raise InvalidROSPkgException(f"Cannot locate package [{package}]")
    return None


__all__ = ["InvalidROSPkgException", "get_pkg_dir"]
