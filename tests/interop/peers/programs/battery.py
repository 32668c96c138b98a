#!/usr/bin/env python3
"""Asks much of the rospy API and prints what it says; two implementations must print the same."""

import sys

import rospy
from geometry_msgs.msg import Point, PoseStamped
from std_msgs.msg import ColorRGBA, Header, Int32, String
from std_msgs.msg import Time as TimeMessage


def attempt(name, function):
    try:
        print(name, "=", function())
    except Exception as error:
        print(name, "raised", type(error).__name__)


def names():
    attempt("name", rospy.get_name)
    attempt("namespace", rospy.get_namespace)
    attempt("resolve relative", lambda: rospy.resolve_name("a/b"))
    attempt("resolve private", lambda: rospy.resolve_name("~a"))
    attempt("resolve remapped", lambda: rospy.resolve_name("old"))
    attempt("resolve global", lambda: rospy.resolve_name("/a/b/"))
    attempt("arguments left", lambda: rospy.myargv(argv=sys.argv)[1:])
    attempt("caller id", rospy.get_caller_id)


def parameters():
    attempt("private from the command line", lambda: rospy.get_param("~speed"))
    attempt("missing", lambda: rospy.get_param("missing"))
    attempt("missing with default", lambda: rospy.get_param("missing", [1, "two"]))
    rospy.set_param("gains", {"p": 1.5, "i": 2, "text": "žluť", "list": [1, 2.5, True, "x"]})
    attempt("dictionary", lambda: sorted(rospy.get_param("gains").items()))
    attempt("member", lambda: rospy.get_param("gains/p"))
    attempt("has", lambda: (rospy.has_param("gains/i"), rospy.has_param("gains/none")))
    attempt("search", lambda: rospy.search_param("gains"))
    attempt("search for nothing", lambda: rospy.search_param("nothing_at_all"))
    attempt("names", lambda: sorted(name for name in rospy.get_param_names() if "gains" in name))
    attempt("delete", lambda: rospy.delete_param("gains/p"))
    attempt("delete again", lambda: rospy.delete_param("gains/p"))
    attempt("after", lambda: sorted(rospy.get_param("gains")))


def times():
    time = rospy.Time(100, 600000000)
    span = rospy.Duration(2, 700000000)
    attempt("sum", lambda: repr(time + span))
    attempt("difference", lambda: repr(time - rospy.Time(101)))
    attempt("time minus span", lambda: repr(time - span))
    attempt("negative", lambda: repr(-span))
    attempt("product", lambda: repr(span * 2))
    attempt("float product", lambda: repr(span * 0.5))
    attempt("quotient", lambda: repr(span / 2))
    attempt("seconds", lambda: (time.to_sec(), span.to_sec(), time.to_nsec(), span.to_nsec()))
    attempt("from seconds", lambda: repr(rospy.Time.from_sec(1.25)))
    attempt("from negative seconds", lambda: repr(rospy.Duration.from_sec(-1.25)))
    attempt("order", lambda: (time < rospy.Time(101), span > rospy.Duration(3), time == time))
    attempt("canonical", lambda: repr(rospy.Duration(1, -1)))
    attempt("a negative time", lambda: rospy.Time(-1))
    attempt("time plus time", lambda: time + time)
    attempt("text", lambda: str(time))
    attempt("zero", lambda: (rospy.Time().is_zero(), bool(rospy.Duration())))
    attempt("hash", lambda: len({rospy.Time(1), rospy.Time(1), rospy.Time(2)}))
    attempt("now", lambda: rospy.Time.now() - rospy.get_rostime() < rospy.Duration(1))
    attempt("now is seconds", lambda: abs(rospy.get_time() - rospy.Time.now().to_sec()) < 1)


def messages():
    attempt("defaults", lambda: PoseStamped())
    attempt("positional", lambda: Point(1, 2, 3))
    attempt("keywords", lambda: ColorRGBA(g=0.5))
    attempt("too few", lambda: Point(1, 2))
    attempt("unknown keyword", lambda: Point(w=1))
    attempt("equal", lambda: (Point(1, 2, 3) == Point(1, 2, 3), Point() == Point(x=1)))
    attempt("type", lambda: (Point._type, Point._md5sum, PoseStamped._has_header, Point._slot_types))
    attempt("slots", lambda: list(PoseStamped.__slots__))
    attempt("header", lambda: Header(stamp=rospy.Time(1, 2), frame_id="map"))
    attempt("time in a message", lambda: TimeMessage(rospy.Time(3, 4)))


def topics():
    latched = rospy.Publisher("latched", Int32, latch=True, queue_size=1)
    latched.publish(42)
    attempt("wait_for_message", lambda: rospy.wait_for_message("latched", Int32, timeout=5).data)
    attempt("wait in vain", lambda: rospy.wait_for_message("nobody_publishes", Int32, timeout=0.2))
    attempt("name of a publisher", lambda: (latched.name, latched.resolved_name, latched.type))
    attempt("a wrong type", lambda: latched.publish(String("text")))
    subscriber = rospy.Subscriber("latched", rospy.AnyMsg, lambda message: None)
    attempt("name of a subscriber", lambda: subscriber.resolved_name)
    subscriber.unregister()
    latched.unregister()
    attempt("publish when unregistered", lambda: latched.publish(1))


def timers():
    fired = []
    timer = rospy.Timer(rospy.Duration(0.01), lambda event: fired.append(event.current_real))
    while len(fired) < 3:
        rospy.sleep(0.005)
    timer.shutdown()
    timer.join()
    attempt("timer", lambda: len(fired) >= 3 and isinstance(fired[0], rospy.Time))
    once = []
    rospy.Timer(rospy.Duration(0.01), once.append, oneshot=True)
    rospy.sleep(rospy.Duration(0.2))
    attempt("oneshot", lambda: (len(once), once[0].last_real))
    rate = rospy.Rate(100)
    attempt("rate", lambda: (rate.sleep(), rate.remaining() <= rospy.Duration(0.01)))


def logs():
    for level in (rospy.logdebug, rospy.loginfo, rospy.logwarn, rospy.logerr, rospy.logfatal):
        level("a line with %s and %d", "text", 5)
    for _ in range(3):
        rospy.loginfo_throttle(60, "only once a minute")
        rospy.logwarn_once("only once")
    attempt("log functions", lambda: "ran")


def main():
    rospy.init_node("battery", argv=["x", "old:=new", "_speed:=2.5", *sys.argv[1:]])
    attempt("init_node again", lambda: rospy.init_node("other"))
    for part in (names, parameters, times, messages, topics, timers, logs):
        print("--", part.__name__)
        part()
    attempt("shut down", rospy.is_shutdown)
    rospy.signal_shutdown("done")
    attempt("shut down", rospy.is_shutdown)
    attempt("sleep when shut down", lambda: rospy.sleep(1))


main()
