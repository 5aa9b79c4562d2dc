#!/usr/bin/env bash
# What the presets windows and arm64 need besides compilers, in build-cross/: headers of the libraries that
# are only headers (headers/), the C and C++ libraries of ARM64 (arm64/), and METIS, pugixml and zlib,
# compiled for that machine (windows-libraries/, arm64-libraries/). All comes from Debian's archive, over the
# network; nothing is installed: prepare.sh windows|arm64
# It needs clang-16, cmake, ninja-build, dpkg-dev; for Windows g++-mingw-w64-x86-64-posix, for ARM64 lld.
set -euo pipefail
machine=${1:-}
[[ $machine =~ ^(windows|arm64)$ ]] || {
  echo "prepare.sh windows|arm64" >&2
  exit 2
}
here=$(dirname "$(realpath "$0")")
folder=$(realpath -m "$here/../../build-cross")
headers=(libeigen3-dev nlohmann-json3-dev libvalijson-dev libcli11-dev doctest-dev)
sources=(metis pugixml zlib)
arm64=(libc6 libc6-dev linux-libc-dev libcrypt1 libgcc-s1 libstdc++6 gcc-12-base libgcc-12-dev libstdc++-12-dev)
mirror=http://deb.debian.org/debian

# apt-get with lists and packages of its own: the system's are not touched.
get() {
  apt-get -qq -o Dir::Etc::SourceList="$folder/apt/sources.list" -o Dir::Etc::SourceParts=- \
    -o Dir::State::Lists="$folder/apt/lists" -o Dir::State::Status="$folder/apt/status" \
    -o Dir::Cache="$folder/apt" -o APT::Architectures::=amd64 -o APT::Architectures::=arm64 \
    -o APT::Sandbox::User= "$@"
}

gather() {
  mkdir -p "$folder"/apt/{lists/partial,headers,arm64} "$folder"/{headers,arm64,sources}
  printf '%s\n' "deb [arch=amd64,arm64] $mirror bookworm main" "deb-src $mirror bookworm main" \
    >"$folder/apt/sources.list"
  : >"$folder/apt/status"
  get update
  (cd "$folder/apt/headers" && get download "${headers[@]}")
  (cd "$folder/apt/arm64" && get download "${arm64[@]/%/:arm64}")
  local part package link source
  for part in headers arm64; do
    for package in "$folder/apt/$part"/*.deb; do dpkg-deb -x "$package" "$folder/$part"; done
  done
  # Links to the system's folders become links to these.
  find "$folder/arm64" -type l -lname '/*' | while read -r link; do
    ln -sfn --relative "$folder/arm64$(readlink "$link")" "$link"
  done
  for source in "${sources[@]}"; do
    rm -rf "$folder/sources/$source"
    (cd "$folder/sources" && get source --download-only "$source" &&
      dpkg-source --no-check -x "${source}"_*.dsc "$source" >/dev/null)
  done
}

compile() {
  cmake -S "$here/libraries" -B "$folder/build-$machine" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$here/$machine.cmake" -DLOBE_SOURCES="$folder/sources" \
    -DCMAKE_INSTALL_PREFIX="$folder/$machine-libraries" >/dev/null
  cmake --build "$folder/build-$machine" --target install >/dev/null
}

[ -f "$folder/gathered" ] || {
  gather
  touch "$folder/gathered"
}
[ -f "$folder/$machine-libraries/lib/libz.a" ] || compile
