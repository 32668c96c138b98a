"""`rclpy.logging_service`: others ask for and set the levels of a node's loggers."""

from __future__ import annotations

from typing import Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy import logging


class LoggingService:
    """Two services of a node: `~/get_logger_levels` and `~/set_logger_levels`."""

    def __init__(self, node: Any) -> None:
        name = node.get_name()
        self._level = message_class("rcl_interfaces/msg/LoggerLevel")
        self._result = message_class("rcl_interfaces/msg/SetLoggerLevelsResult")
        for what, kind, callback in (
            ("get_logger_levels", "GetLoggerLevels", self._get),
            ("set_logger_levels", "SetLoggerLevels", self._set),
        ):
            node.create_service(message_class(f"rcl_interfaces/srv/{kind}"), f"{name}/{what}", callback)

    def _get(self, request: Any, response: Any) -> Any:
        response.levels = [
            self._level(name=name, level=int(logging.get_logger_level(name))) for name in request.names
        ]
        return response

    def _set(self, request: Any, response: Any) -> Any:
        results = []
        for one in request.levels:
            try:
                logging.set_logger_level(one.name, one.level)
                results.append(self._result(successful=True))
            except ValueError as error:
                results.append(self._result(successful=False, reason=str(error)))
        response.results = results
        return response


__all__ = ["LoggingService"]
