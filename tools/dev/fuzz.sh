#!/usr/bin/env bash
# fuzz.sh [TARGET] [--for 60s]: runs the fuzzers on a copy of their corpus; all of them share the
# time. fuzz_canary holds a fault on purpose: the run fails if its fuzzer does not find it.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

readonly canary=fuzz_canary
readonly canary_seconds=60
readonly out=build/fuzz/run

wanted=
seconds=60
while [[ $# -gt 0 ]]; do
  case "$1" in
    --for)
      [[ $# -ge 2 ]] || die_usage "--for needs a duration such as 60s"
      seconds="$(seconds_of "$2")" || die_usage "not a duration: $2"
      shift 2
      ;;
    -*) die_usage "unknown flag: $1" ;;
    *)
      [[ -z "$wanted" ]] || die_usage "one target or none"
      wanted="fuzz_${1#fuzz_}"
      shift
      ;;
  esac
done

need_packages
mkdir -p build
cmake --preset fuzz >build/fuzz.configure.log 2>&1 || {
  cat build/fuzz.configure.log >&2
  die "cmake --preset fuzz failed"
}
mapfile -t targets < <(ninja -C build/fuzz -t targets all | sed -n 's|^bin/\(fuzz_[a-z0-9_]*\): .*|\1|p' | sort)
[[ ${#targets[@]} -gt 0 ]] || die "the tree has no fuzz target"
if [[ -n "$wanted" ]]; then
  printf '%s\n' "${targets[@]}" | grep -Fxq -- "$wanted" ||
    die_usage "no such target: $wanted (there are: ${targets[*]})"
  targets=("$wanted")
fi
build_preset fuzz "${targets[@]/#/bin/}"

export ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"

# run_one TARGET SECONDS: the fuzzer's status; its output in $out/TARGET/log.
run_one() {
  local fuzzer="$1" limit="$2" folder="$out/$1" seeds
  rm -rf "$folder"
  mkdir -p "$folder/corpus" "$folder/artifacts"
  for seeds in "tests/fuzz/corpus/$fuzzer" "tests/fuzz/corpus/${fuzzer#fuzz_}"; do
    [[ ! -d "$seeds" ]] || cp -r "$seeds/." "$folder/corpus/"
  done
  "build/fuzz/bin/$fuzzer" "$folder/corpus" -max_total_time="$limit" -timeout=10 \
    -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="$folder/artifacts/" >"$folder/log" 2>&1
}

plain=0
for target in "${targets[@]}"; do
  [[ "$target" == "$canary" ]] || plain=$((plain + 1))
done
share="$seconds"
[[ "$plain" -eq 0 ]] || share=$((seconds / plain))
[[ "$share" -gt 0 ]] || share=1

bad=0
for target in "${targets[@]}"; do
  if [[ "$target" == "$canary" ]]; then
    if run_one "$target" "$canary_seconds"; then
      printf '%-24s NOT FOUND: the fault that it holds; these fuzzers find nothing\n' "$target"
      bad=1
    elif compgen -G "$out/$target/artifacts/crash-*" >/dev/null; then
      printf '%-24s found its fault, as it must\n' "$target"
    else
      tail -n 20 "$out/$target/log"
      printf '%-24s FAILED without a crash of its own\n' "$target"
      bad=1
    fi
  elif run_one "$target" "$share"; then
    runs="$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$target/log")"
    printf '%-24s %s runs in %ss, nothing found\n' "$target" "${runs:-?}" "$share"
  else
    tail -n 60 "$out/$target/log"
    printf '%-24s FOUND A FAULT: %s\n' "$target" "$(find "$out/$target/artifacts" -type f | head -n 1)"
    bad=1
  fi
done
exit "$bad"
