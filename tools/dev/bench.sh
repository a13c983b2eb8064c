#!/usr/bin/env bash
# bench.sh [relay|decode|connect|memory|scrape|store|fair|hostile|forward|cyberwave|avatar|questions|watch] [--json FILE] [--rounds N] [--seconds N]: benchmarks
# with their comparators in the same run. `store` runs on a private PostgreSQL cluster with the
# settings that it is installed with. `relay` and what it is called with takes `--only SCENARIO` too.
# `forward` takes `--receivers N`, `avatar` `--drones N` and `--only SCENARIO`. `cyberwave` runs on a private cluster too, with brokers of its own,
# and takes `--only joints|events|ack|depth`.
# `hostile` takes `--only ATTACK` and `--server-bin FILE`.
# `fair` takes `--only SCENARIO`, `--store sqlite|postgres`, `--server-bin FILE` and `--robots N`; its
# store lies in TMPDIR.
# `watch` shows what operators' watches cost ingestion: CPU per message and ack p99, with 100 watchers of 50
# robots each and one of all 10,000 beside without. It takes `--robots N`, `--watchers N` and `--each N`.
# `questions` takes `--store sqlite|postgres`, `--robots N`, `--rows N`, `--rate N`, `--asks N` and `--only TEXT`.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

name=relay
if [[ $# -gt 0 && "$1" != --* ]]; then
  name="$1"
  shift
fi
readonly bin="$PWD/build/release/bin" folder="$PWD/build/bench"
commit="$(git -c safe.directory='*' rev-parse --short HEAD)"

# with_database PROGRAM ...: PROGRAM ... --url URL of a migrated database of a private cluster, which
# ends with it.
with_database() {
  local cluster="$folder/postgres.state" at
  [[ ! -f "$cluster" ]] || tools/dev/postgres.sh stop "$cluster"
  rm -rf "$folder"
  mkdir -p "$folder"
  # shellcheck disable=SC2064 # the name is known now, and is gone when the trap runs
  trap "tools/dev/postgres.sh stop '$cluster'" EXIT
  tools/dev/postgres.sh start "$cluster"
  at="$(sed -n 's/^folder=//p' "$cluster")&port=$(sed -n 's/^port=//p' "$cluster")"
  psql -X -q -c 'CREATE DATABASE uplinkd OWNER uplinkd_owner' "postgresql://postgres@/postgres?host=$at"
  "$bin/uplinkctl" store migrate --url "postgresql://uplinkd_owner@/uplinkd?host=$at" \
    --grant-to uplinkd >"$folder/migrate.log"
  "$@" --url "postgresql://uplinkd@/uplinkd?host=$at"
}

bench_store() {
  build_preset release bin/uplink_bench_store bin/uplinkctl
  with_database "$bin/uplink_bench_store" --folder "$folder" --commit "$commit" "$@"
}

bench_cyberwave() {
  build_preset release bin/uplink_bench_cyberwave bin/uplinkctl
  with_database "$bin/uplink_bench_cyberwave" --commit "$commit" "$@"
}

# The second part adds its row to what the first one wrote.
bench_scrape() {
  local json="$folder/scrape.json" arguments=()
  while [[ $# -gt 0 ]]; do
    case "$1" in
      --json)
        [[ $# -ge 2 ]] || die_usage "--json needs a file"
        json="$2"
        shift 2
        ;;
      *)
        arguments+=("$1")
        shift
        ;;
    esac
  done
  mkdir -p "$folder"
  "$bin/uplink_bench_scrape" --commit "$commit" --json "$json" "${arguments[@]}"
  UPLINK_BIN_DIR="$bin" PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/scrape_acks.py --json "$json"
}

# in_temporary PROGRAM ...: with a TMPDIR of its own. The programs that it starts end with it, however
# it ends; so it is ended, and then what it wrote goes.
in_temporary() {
  # Not local: the trap outlives the function.
  cluster="$folder/fair.state" pid=""
  mkdir -p "$folder"
  temporary="$(mktemp -d)"
  [[ ! -f "$cluster" ]] || tools/dev/postgres.sh stop "$cluster"
  clean_up() {
    [[ -z "$pid" ]] || kill "$pid" 2>/dev/null || true
    [[ -z "$pid" ]] || wait "$pid" || true
    rm -rf "$temporary"
    [[ ! -f "$cluster" ]] || tools/dev/postgres.sh stop "$cluster"
  }
  trap clean_up EXIT
  # A cluster that is just being started is waited for, and then stopped.
  trap 'exit 130' INT
  trap 'exit 143' TERM
  case " $* " in
    *" --store postgres "* | *" --store=postgres "*)
      tools/dev/postgres.sh start "$cluster"
      export UPLINK_TEST_POSTGRES="$cluster"
      ;;
  esac
  TMPDIR="$temporary" "$@" &
  pid=$!
  wait "$pid"
  pid=""
}

case "$name" in
  fair)
    need_packages
    build_preset release bin/uplink_bench_fair bin/uplink_bench_bad_robot bin/uplinkd
    in_temporary "$bin/uplink_bench_fair" --commit "$commit" "$@"
    ;;
  hostile)
    need_packages
    build_preset release bin/uplink_bench_hostile bin/uplinkd
    in_temporary "$bin/uplink_bench_hostile" --commit "$commit" "$@"
    ;;
  store)
    need_packages
    bench_store "$@"
    ;;
  cyberwave)
    need_packages
    bench_cyberwave "$@"
    ;;
  relay | connect | memory)
    need_packages
    build_preset release bin/uplink_bench_relay bin/uplinkd
    "$bin/uplink_bench_relay" "$name" --commit "$commit" "$@"
    ;;
  forward)
    need_packages
    build_preset release bin/uplink_bench_forward bin/uplinkd
    "$bin/uplink_bench_forward" --commit "$commit" "$@"
    ;;
  avatar)
    need_packages
    build_preset release bin/uplink_bench_avatar bin/uplinkd
    "$bin/uplink_bench_avatar" --commit "$commit" "$@"
    ;;
  decode)
    need_packages
    build_preset release bin/uplink_bench_decode
    "$bin/uplink_bench_decode" --commit "$commit" "$@"
    ;;
  scrape)
    need_packages
    build_preset release bin/uplink_bench_scrape bin/uplinkd bin/uplinkctl bin/uplink-fleet
    bench_scrape "$@"
    ;;
  questions)
    need_packages
    build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet
    UPLINK_BIN_DIR="$bin" PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/questions/questions.py "$@"
    ;;
  watch)
    need_packages
    build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet
    UPLINK_BIN_DIR="$bin" PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/watch/watch.py --commit "$commit" "$@"
    ;;
  *) die_usage "bench: unknown benchmark: $name (relay, decode, connect, memory, scrape, store, fair, hostile, forward, cyberwave, avatar, questions or watch)" ;;
esac
