#!/usr/bin/env bash
# Runs the tests with the label `programs` again and again while busy processes take the processors:
# repeat.sh BUILD [TIMES [BUSY [NAMES]]], where NAMES is a regular expression of ctest that chooses some of
# them. Prints how often each ran and failed. What failed says why in BUILD/Testing/repeat.
set -euo pipefail
build=${1:?folder of the build} times=${2:-20} busy=${3:-4} names=${4:-.}
for number in "$times" "$busy"; do
  [[ $number =~ ^[0-9]+$ ]] || { echo "repeat: \"$number\" is no number" >&2; exit 2; }
done
logs=$build/Testing/repeat
rm -rf "$logs"
mkdir -p "$logs"

working=()
stop_working() { ((${#working[@]} == 0)) || kill "${working[@]}" 2>/dev/null || true; }
trap stop_working EXIT
for ((i = 0; i < busy; ++i)); do
  (trap - EXIT; while :; do :; done) &
  working+=($!)
done

for ((i = 1; i <= times; ++i)); do
  ctest --test-dir "$build" -L '^programs$' -R "$names" -j2 --timeout 900 --output-on-failure >"$logs/$i.log" 2>&1 || true
  echo "$i of $times: $(grep -E 'tests passed|No tests' "$logs/$i.log" || tail -n 1 "$logs/$i.log")"
done

# Lines such as "3/40 Test  #7: view ......   Passed    1.2 sec", with ***Failed, ***Timeout and others.
awk '
  match($0, /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: /) {
    rest = substr($0, RLENGTH + 1)
    name = rest
    sub(/ .*/, "", name)
    if (rest ~ /\*\*\*Skipped/ || rest ~ /\(Disabled\)/) { ++skipped[name]; next }
    ++ran[name]
    if (rest !~ / Passed /) ++failed[name]
  }
  END {
    for (name in ran) {
      ++tests
      runs += ran[name]
      failures += failed[name]
      if (failed[name]) printf "%s: %d of %d runs failed\n", name, failed[name], ran[name]
    }
    for (name in skipped) printf "%s: skipped %d times\n", name, skipped[name]
    printf "%d tests, %d runs, %d failures\n", tests, runs, failures
    exit failures > 0 || runs == 0
  }' "$logs"/*.log
