from nodes import make, master

__all__ = ["make", "master"]
