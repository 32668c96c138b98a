#!/usr/bin/env python3
# Loggers: levels, children, once, throttled, skipped; what the others get of it on /rosout.
import time

import rclpy
import rclpy.logging
from rcl_interfaces.msg import Log
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.qos import qos_profile_rosout_default

rclpy.init()
node = rclpy.create_node("logging", namespace="/space")
logger = node.get_logger()
print(logger.name, logger.get_effective_level().name, rclpy.logging.get_logger("free").name)
lines = []
node.create_subscription(Log, "/rosout", lines.append, qos_profile_rosout_default)
while node.count_publishers("/rosout") == 0:
    rclpy.spin_once(node, timeout_sec=0.05)
for _ in range(10):
    rclpy.spin_once(node, timeout_sec=0.02)
lines.clear()
print(logger.debug("said as debug"))
print(logger.info("said as info"))
print(logger.warning("said as warning"))
print(logger.warn("said as warn"))
print(logger.error("said as error"))
print(logger.fatal("said as fatal"))
for turn in range(3):
    logger.info(f"once {turn}", once=True)
    logger.info(f"not the first {turn}", skip_first=True)
    logger.info(f"throttled {turn}", throttle_duration_sec=10.0)
    logger.log(f"logged {turn}", LoggingSeverity.ERROR, once=True)
for turn in range(2):
    logger.warning(f"short {turn}", throttle_duration_sec=0.01)
    time.sleep(0.02)
logger.set_level(LoggingSeverity.DEBUG)
print(
    logger.debug("now it shows"),
    logger.get_effective_level().name,
    logger.is_enabled_for(LoggingSeverity.DEBUG),
)
child = logger.get_child("child")
print(child.name, child.get_effective_level().name)
child.info("by the child")
child.set_level(LoggingSeverity.ERROR)
print(child.info("not said"), logger.info("said"), child.is_enabled_for(LoggingSeverity.INFO))
rclpy.logging.set_logger_level("space.logging", LoggingSeverity.FATAL)
print(logger.error("too low"), rclpy.logging.get_logger_effective_level("space.logging").name)
rclpy.logging.set_logger_level("space.logging", LoggingSeverity.INFO)
rclpy.logging.get_logger("free").info("without a node")
for wrong in (
    lambda: logger.info("x", once=True, wrong=1),
    lambda: logger.info(5),
    lambda: logger.get_child(""),
    lambda: rclpy.logging.get_logger(""),
    lambda: rclpy.logging.get_logger(None),
    lambda: rclpy.logging.get_logging_severity_from_string("loud"),
):
    try:
        print("allowed", wrong() is not None)
    except Exception as error:
        print(type(error).__name__)
print([(level.name, level.value) for level in LoggingSeverity])
print(rclpy.logging.get_logging_severity_from_string("WARN").name)
# One line cannot change how it is filtered.
for turn in range(2):
    try:
        logger.info("changing", **({"once": True} if turn else {"skip_first": True}))
    except ValueError:
        print("changed")
end = time.monotonic() + 5
while time.monotonic() < end and not any(line.msg == "said" for line in lines):
    rclpy.spin_once(node, timeout_sec=0.1)
rclpy.spin_once(node, timeout_sec=0.1)
print([(line.level, line.name, line.msg) for line in lines])
line = lines[0]
print(line.file.endswith("logging_functions.py"), line.function, line.line > 0, line.stamp.sec > 10**9)
rclpy.shutdown()
