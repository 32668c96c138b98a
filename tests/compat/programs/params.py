#!/usr/bin/env python3
import rospy


def show(name, function):
    try:
        print(name, repr(function()))
    except Exception as error:
        print(name, "raised", type(error).__name__, error)


rospy.init_node(
    "params",
    argv=["params.py", "_alpha:=1", "_beta:=2.5", "_gamma:=true", "_delta:=some text", "_list:=[1, two]"],
)
for name in ("alpha", "beta", "gamma", "delta", "list"):
    show(name, lambda: rospy.get_param("~" + name))
rospy.set_param("/compat/gains", {"P": 1.0, "I": 2, "D": "three", "deep": {"er": [1, [2, False]]}})
show("gains", lambda: sorted(rospy.get_param("/compat/gains").items()))
show("P", lambda: rospy.get_param("/compat/gains/P"))
show("deep", lambda: rospy.get_param("/compat/gains/deep/er"))
show("default", lambda: rospy.get_param("/compat/none", "default"))
show("none", lambda: rospy.get_param("/compat/none"))
show("None as default", lambda: rospy.get_param("/compat/none", None))
show("has", lambda: (rospy.has_param("/compat/gains"), rospy.has_param("/compat/none")))
show("search", lambda: rospy.search_param("alpha"))
show("search in vain", lambda: rospy.search_param("nothing_of_this_name"))
show("names", lambda: [name for name in sorted(rospy.get_param_names()) if name.startswith("/compat/")])
show("cached", lambda: rospy.get_param_cached("/compat/gains/I"))
rospy.set_param("/compat/gains/I", 3)
rospy.sleep(0.3)
show("cached after a change", lambda: rospy.get_param_cached("/compat/gains/I"))
show("cached in vain", lambda: rospy.get_param_cached("/compat/none", 7))
show("delete", lambda: rospy.delete_param("/compat/gains/P"))
show("delete again", lambda: rospy.delete_param("/compat/gains/P"))
show("delete private", lambda: rospy.delete_param("~alpha"))
show("unicode", lambda: (rospy.set_param("/compat/u", "žluťoučký <&> kůň"), rospy.get_param("/compat/u")))
show(
    "numbers",
    lambda: (rospy.set_param("/compat/n", [2**31 - 1, -(2**31), 1e-300, -0.5]), rospy.get_param("/compat/n")),
)
show("too large", lambda: rospy.set_param("/compat/n", 2**31))
show("as a dictionary", lambda: ("/compat/u" in rospy.get_master(), rospy.get_master()["/compat/n"][0]))
rospy.delete_param("/compat")
