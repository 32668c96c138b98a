#!/usr/bin/env python3
# Every log function; what goes where, and what is printed once, seldom, or not at all.
import rospy

rospy.loginfo("before init_node nobody hears this")
rospy.logwarn("before init_node: %s", "a warning")
rospy.init_node("logs", log_level=rospy.INFO)
rospy.logdebug("debug")
rospy.loginfo("info")
rospy.logwarn("warn")
rospy.logerr("error")
rospy.logfatal("fatal")
rospy.logout("out")
rospy.loginfo("%s and %d and %.2f %%", "text", 7, 1.5)
rospy.loginfo("100% without arguments")
rospy.loginfo({"any": "object"})
rospy.loginfo("named", logger_name="child")
for turn in range(4):
    rospy.loginfo_once("once %d", turn)
    rospy.logwarn_throttle(60, "throttled %d" % turn)
    rospy.logerr_throttle_identical(60, "identical")
    rospy.loginfo_throttle_identical(60, "changes %d" % (turn // 2))
    rospy.logdebug_once("not shown")
    rospy.logfatal_once("fatal once")
rospy.loginfo("two\nlines")
rospy.loginfo("ünïcödé")
