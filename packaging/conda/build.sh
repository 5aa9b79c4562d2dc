#!/usr/bin/env bash
set -euo pipefail
# shellcheck disable=SC2086
cmake ${CMAKE_ARGS:-} -G Ninja -S . -B build-conda \
  -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_INSTALL_PREFIX="$PREFIX" \
  -DCMAKE_INSTALL_LIBDIR=lib \
  -DCMAKE_COMPILE_WARNING_AS_ERROR=OFF \
  -DLOBE_BENCHMARKS=OFF \
  -DLOBE_C=ON \
  -DLOBE_CHOLMOD=OFF \
  -DLOBE_EXAMPLES=OFF \
  -DLOBE_MESHING=OFF \
  -DLOBE_PETSC=OFF \
  -DLOBE_PICTURES=OFF \
  -DLOBE_PYTHON=OFF \
  -DLOBE_TESTS=OFF \
  -DLOBE_VIEW=OFF
cmake --build build-conda
cmake --install build-conda
