from ros2_nodes import make2

__all__ = ["make2"]
