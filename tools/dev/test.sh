#!/usr/bin/env bash
# test.sh PRESET [RING ...] [CTEST ARGUMENTS]: builds a preset, runs the tests of these rings and ends with
# the line "N passed, N failed". Without a ring it runs all but `long`. A test that did not run counts as
# failed; so does a run without tests.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

preset="$1"
shift
rings=()
while [[ $# -gt 0 && "$1" != -* ]]; do
  case "$1" in
    unit | component | e2e | long | all) rings+=("$1") ;;
    *) die_usage "unknown ring: $1 (unit, component, e2e, long or all)" ;;
  esac
  shift
done
case " ${rings[*]:-} " in
  "  ") labels=(-LE '^long$') ;;
  *" all "*) labels=() ;;
  *) labels=(-L "^($(IFS='|' && printf '%s' "${rings[*]}"))\$") ;;
esac

need_packages
build_preset "$preset"

export ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1:detect_leaks=1${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
export LSAN_OPTIONS="suppressions=$PWD/tools/dev/lsan.supp:print_suppressions=0${LSAN_OPTIONS:+:$LSAN_OPTIONS}"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}"
export TSAN_OPTIONS="halt_on_error=1:second_deadlock_stack=1${TSAN_OPTIONS:+:$TSAN_OPTIONS}"
mapfile -t runner < <(tsan_runner "$preset")

# Temporary files in memory, unless TMPDIR names a place: tests end processes, never the machine, and
# what a process wrote outlives it there too. Waiting for a disk was a third of the tests' time.
readonly memory=/dev/shm
readonly memory_free_kib=$((6 * 1024 * 1024))
if [[ -z "${TMPDIR:-}" && -w "$memory" ]]; then
  free="$(df --output=avail -k "$memory" 2>/dev/null | tail -n 1 || true)"
  if [[ "${free:-0}" -ge "$memory_free_kib" ]]; then
    export TMPDIR="$memory"
  fi
fi

# Half a core per slot: a test that computes takes two of them, one that mostly waits takes one (its
# property PROCESSORS).
readonly cores_max=4
cores="$(nproc)"
slots="$((2 * (cores < cores_max ? cores : cores_max)))"

report="$PWD/build/$preset/test-report.xml"
rm -f "$report"
status=0
"${runner[@]}" ctest --test-dir "build/$preset" --parallel "$slots" --output-on-failure --no-tests=error \
  --output-junit "$report" "${labels[@]}" "$@" || status=$?

total=0
passed=0
if [[ -f "$report" ]]; then
  total="$(grep -c '<testcase ' "$report" || true)"
  passed="$(grep -c '<testcase .*status="run"' "$report" || true)"
fi
failed=$((total - passed))
printf '%d passed, %d failed\n' "$passed" "$failed"
[[ "$status" -eq 0 && "$failed" -eq 0 && "$passed" -gt 0 ]]
