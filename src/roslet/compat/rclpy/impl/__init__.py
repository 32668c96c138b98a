"""`rclpy.impl`: what rclpy's own modules share; programs take the levels of loggers from it."""
