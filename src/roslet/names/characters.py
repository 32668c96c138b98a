"""What names of ROS 1 and ROS 2 are made of. Runs on MicroPython."""

LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
DIGITS = "0123456789"

# Longer names are refused: no real graph has them, and a name is copied into every header and log line.
MAX_NAME = 4096
