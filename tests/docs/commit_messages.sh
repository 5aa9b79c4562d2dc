#!/usr/bin/env bash
# What the hook for commit messages takes and refuses: commit_messages.sh HOOK
set -euo pipefail
hook=$1 file=$(mktemp)
trap 'rm -f "$file"' EXIT
faults=0
expect() {  # status, changed files, message
  printf '%b\n' "$3" >"$file"
  local status=0
  LOBE_CHANGED=$2 bash "$hook" "$file" 2>/dev/null || status=$?
  [ "$status" -eq "$1" ] || { echo "status $status, not $1: $3"; faults=$((faults + 1)); }
}
expect 0 docs/scene.md 'Describe the keys of a scene'
expect 0 lib/lobe/fem/svk.h 'Compute the strain once\n\nForces take 4 % less time.'
expect 0 lib/lobe/fem/svk.h 'fixup! Compute the strain once'
expect 1 lib/lobe/fem/svk.h 'Compute the strain once'
expect 1 lib/lobe/fem/svk.h 'Compute the strain once\n\n  \n# a comment of git'
expect 1 docs/scene.md 'Describe the keys of a scene; a table of defaults'
expect 1 docs/scene.md 'Describe the keys of a scene, all of their defaults and each u'
expect 1 docs/scene.md 'describe the keys of a scene'
expect 1 docs/scene.md 'Describe the keys of a scene.'
expect 1 docs/scene.md ''
[ "$faults" -eq 0 ]
