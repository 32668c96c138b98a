#!/bin/sh
# ros1_definitions.sh DIR: unpacks, without installing, the Debian packages that hold .msg, .srv or .action files but
# would bring a whole toolchain with them (opencv, rviz, ...). The definitions end up in DIR/usr/share.
# Needs apt lists (apt-get update) but not root.
set -eu
mkdir -p "$1"
out=$(cd "$1" && pwd)

packages="
libactionlib-dev libtf-dev libbond-dev libdynamic-reconfigure-config-init-mutex-dev libnodelet-dev
libpolled-camera-dev librviz-dev ros-opencv-apps
"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
# shellcheck disable=SC2086 # the list is words on purpose
apt-get -q download $packages >log 2>&1 || { cat log >&2; echo "ros1_definitions.sh: apt-get download failed" >&2; exit 1; }
for package in ./*.deb; do
    dpkg-deb -x "$package" unpacked
done
find unpacked/usr/share -type f ! -name '*.msg' ! -name '*.srv' ! -name '*.action' -delete
find unpacked/usr/share -type d -empty -delete
mkdir -p "$out/usr/share"
cp -R unpacked/usr/share/. "$out/usr/share"
