#!/bin/sh
# Installs the Debian packages that the peers and the tools need, or those that the arguments name: only those missing, only
# as root. Anywhere else it says what is missing and succeeds; the tests that need them then skip (and fail when CI is set).
set -eu

packages=${*:-"
python3-venv
ros-core python3-rospy python3-rosmaster python3-roslaunch python3-rosbag python3-rostopic python3-rosnode
python3-rosservice python3-rosparam python3-rosmsg python3-roslz4 python3-genpy python3-gencpp python3-genmsg
libroscpp-dev libstd-msgs-dev libgeometry-msgs-dev libsensor-msgs-dev libstd-srvs-dev
python3-std-msgs python3-geometry-msgs python3-sensor-msgs python3-nav-msgs python3-shape-msgs python3-stereo-msgs
python3-trajectory-msgs python3-visualization-msgs python3-diagnostic-msgs python3-actionlib-msgs python3-std-srvs
python3-rosgraph-msgs python3-roscpp-msg python3-tf2-msgs python3-map-msgs python3-move-base-msgs python3-pcl-msgs
python3-topic-tools python3-tf python3-actionlib python3-dynamic-reconfigure python3-nodelet python3-bond
python3-polled-camera python3-numpy python3-yaml
ros-std-msgs ros-std-srvs ros-geometry-msgs ros-sensor-msgs ros-nav-msgs ros-shape-msgs ros-stereo-msgs
ros-trajectory-msgs ros-visualization-msgs ros-diagnostic-msgs ros-actionlib-msgs ros-rosgraph-msgs ros-tf2-msgs
ros-map-msgs ros-move-base-msgs ros-pcl-msgs ros-topic-tools-srvs
clang libclang-rt-dev gcc-arm-none-eabi libstdc++-arm-none-eabi-dev g++-arm-linux-gnueabihf qemu-user
gcc g++ pkg-config iproute2 procps tshark iputils-ping iputils-arping iverilog
"}

command -v dpkg-query >/dev/null 2>&1 || { echo "debian.sh: not a Debian system, nothing installed" >&2; exit 0; }

missing=
for package in $packages; do
    case "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" in
        installed) ;;
        *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" != 0 ]; then
    echo "debian.sh: not root, so these Debian packages stay missing:$missing" >&2
    exit 0
fi
echo "debian.sh: installing$missing"
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# shellcheck disable=SC2086 # the list is words on purpose
if ! { apt-get -q update && apt-get -q -y install --no-install-recommends $missing; } >"$log" 2>&1 </dev/null; then
    tail -n 40 "$log" >&2
    echo "debian.sh: apt-get failed" >&2
    exit 1
fi
