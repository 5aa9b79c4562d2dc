#!/usr/bin/env bash
# Installs the packages of a folder in a clean Debian and uses them as somebody who has nothing else would:
# the demo scene, the mesher, the page and Python without a compiler; then the consumer project. As root, with
# a network: try.sh PACKAGES CONSUMER_PROJECT CHROOT
set -euo pipefail
packages=$1 project=$2 chroot=$3

[ ! -d "$chroot/packages" ] || rm -rf "$chroot"  # of an earlier run: it has a compiler
[ -x "$chroot/usr/bin/apt-get" ] || debootstrap --variant=minbase bookworm "$chroot" http://deb.debian.org/debian
mkdir -p "$chroot/packages" "$chroot/project"
cp "$packages"/*.deb "$chroot/packages"
cp -r "$project"/. "$chroot/project"
inside() {  # without anything of the environment outside
  chroot "$chroot" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 \
    HOME=/root "$@"
}
install() { inside sh -c "apt-get install -y -qq --no-install-recommends $* >/dev/null"; }

inside apt-get update -qq
install "/packages/lobe_*.deb /packages/lobe-mesh_*.deb /packages/liblobe-c1_*.deb /packages/python3-lobe_*.deb"
! inside which c++ || { echo "there is a compiler: this shows nothing" >&2; exit 1; }
echo "== the demo scene"
inside lobe check /usr/share/lobe/data/scenes/liver_resection.json
time inside lobe run /usr/share/lobe/data/scenes/liver_resection.json -o /tmp/out
echo "== a mesh of one's own"
inside lobe mesh /usr/share/lobe/data/liver.obj --edge 0.015 -o /tmp/liver.vtu
echo "== the page"
inside timeout --preserve-status --signal=INT 5 lobe view /usr/share/lobe/data/scenes/liver_hands.json --no-open --port 18080
echo "== Python"
inside python3 -c '
import lobe
world = lobe.World(lobe.read_scene("/usr/share/lobe/data/scenes/liver_hands.json"))
assert world.advance(0.01).ok
print(lobe.__version__, lobe.mesh("/usr/share/lobe/data/liver.obj", edge=0.02))'
echo "== the consumer project"
install '/packages/*.deb' g++ cmake make nlohmann-json3-dev
inside cmake -S /project -B /tmp/project -DCMAKE_BUILD_TYPE=Release
inside cmake --build /tmp/project
inside /tmp/project/consumer
