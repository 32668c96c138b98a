#!/bin/sh
# ros1_peers.sh DIR: runs Debian's gencpp and genpy on the packages in tests/interop/peers/ws and compiles the roscpp peer.
#   DIR/include  C++ headers    DIR/python  Python packages (for PYTHONPATH)    DIR/bin/roscpp_peer
set -eu
cd "$(dirname "$0")/.."
out=$1
sources=tests/interop/peers
python=/usr/bin/python3
gencpp=/usr/lib/gencpp
genpy=/usr/lib/genpy

for needed in "$gencpp/gen_cpp.py" "$genpy/genmsg_py.py" /usr/include/ros/ros.h; do
    [ -e "$needed" ] || { echo "ros1_peers.sh: $needed is missing (Debian's ROS 1 packages)" >&2; exit 1; }
done

includes=
for package in "$sources"/ws/*/; do
    includes="$includes -I$(basename "$package"):${package}msg"
done
for package in std_msgs geometry_msgs sensor_msgs; do
    includes="$includes -I$package:/usr/share/$package/msg"
done

for package in "$sources"/ws/*/; do
    name=$(basename "$package")
    mkdir -p "$out/include/$name" "$out/python/$name"
    : >"$out/python/$name/__init__.py"
    for kind in msg srv; do
        [ -d "$package$kind" ] || continue
        for file in "$package$kind"/*."$kind"; do
            # shellcheck disable=SC2086 # includes is words on purpose
            "$python" "$gencpp/gen_cpp.py" "$file" $includes -p "$name" -o "$out/include/$name" -e /usr/share/gencpp
            # shellcheck disable=SC2086
            "$python" "$genpy/gen${kind}_py.py" "$file" $includes -p "$name" -o "$out/python/$name/$kind"
        done
        "$python" "$genpy/gen${kind}_py.py" --initpy -p "$name" -o "$out/python/$name/$kind"
    done
done

mkdir -p "$out/bin"
# shellcheck disable=SC2046 # flags are words on purpose
g++ -O1 -std=c++17 -w -I"$out/include" -o "$out/bin/roscpp_peer" "$sources/roscpp_peer.cpp" \
    $(pkg-config --cflags --libs roscpp) -lpthread
