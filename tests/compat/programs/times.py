#!/usr/bin/env python3
# Arithmetic of times and durations, and times in messages.
import genpy
import rospy
from std_msgs.msg import Header, Time


def show(text):
    try:
        value = eval(text)
        print(text, "=", repr(value), str(value))
    except Exception as error:
        print(text, "raised", type(error).__name__)


T, D = rospy.Time, rospy.Duration
H = Header(1, rospy.Time(5, 6), "map")
for text in """
T(1, 5) + D(2)
T(3) - T(1)
T(3) - D(1, 1)
T(1) - T(3)
D(1) * 2
2 * D(1)
D(1) * 2.5
D(3) / 2
D(3) / 2.0
D(3) // 2
D(3) / D(2)
D(3) // D(2)
D(5) % D(3)
divmod(D(5), D(3))
-D(1.5)
abs(D(-1.5))
D(-1, 999999999).to_sec()
D(0.1) + D(0.2)
D(1) - D(3)
D(1) + T(1)
T(1) + T(1)
T(1) * 2
T(1) < T(2), T(1) <= T(1), T(1) == T(1, 0), T(1) != T(1, 1)
T(1) == 1, T(1) == D(1), D(1) == genpy.Duration(1), T(1) == genpy.Time(1)
D(1) > 0
T(-1)
T(1.5, 1)
T('a')
T.from_sec(1.25), T.from_sec(1.25).to_nsec(), T.from_seconds(2.5)
D.from_sec(-1.25), D.from_sec(1e-9), D(-1.25).secs, D(-1.25).nsecs
T(1, 2000000000), D(1, -1), D(0, -1)
T().is_zero(), D().is_zero(), bool(T()), bool(D(1))
T(12, 34).to_time(), T(12, 340000000).to_sec()
len({T(1), T(1), D(1)}), hash(T(1)) == hash(genpy.Time(1))
max(D(1), D(2)), sorted([T(3), T(1)])
H.stamp, H.stamp + D(1), H.stamp.to_sec(), H
Time(T(1, 2)).data, Time(), Time(genpy.Time(1.5))
Header(stamp=T(1)).stamp is None, Header().stamp.__class__.__name__
H.stamp.secs + 1, H.stamp.nsecs
T(1) - 1
D(0.1) + 0.1
D('1')
isinstance(H.stamp, genpy.Time), isinstance(T(1), genpy.Time), isinstance(T(1) + D(1), T)
[type(x).__name__ for x in (T(1) - T(1), D(1) * 3, -D(1), T(1) + D(1))]
[type(x).__module__ for x in (T(1) - T(1), D(1) * 3, -D(1), T(1) + D(1), genpy.Time(2) - D(1))] != []
genpy.Time(3), genpy.Duration(-3, 1), genpy.Time(3) - rospy.Time(1)
""".strip().splitlines():
    show(text)
show("rospy.Time.now()") if False else None
try:
    rospy.Time.now()
except rospy.ROSInitException as error:
    print("before init_node:", error)
rospy.init_node("times")
now = rospy.Time.now()
stamped = Header(stamp=now)
rospy.sleep(0.01)
print(
    rospy.Time.now() > stamped.stamp,
    rospy.Time.now() - stamped.stamp < rospy.Duration(2),
    abs(rospy.get_time() - now.to_sec()) < 2,
)
