#!/usr/bin/env bash
# bench.sh [store] [--json FILE] [--rounds N] [--seconds N]: benchmarks with their comparators in the
# same run, on a private PostgreSQL cluster with the settings that it is installed with.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

name="${1:-store}"
[[ $# -eq 0 ]] || shift
[[ "$name" == store ]] || die_usage "bench: unknown benchmark: $name (store)"
need_packages
build_preset release bin/uplink_bench_store bin/uplinkctl
readonly bin="$PWD/build/release/bin" folder="$PWD/build/bench"
readonly cluster="$folder/postgres.state"
[[ ! -f "$cluster" ]] || tools/dev/postgres.sh stop "$cluster"
rm -rf "$folder"
mkdir -p "$folder"
trap 'tools/dev/postgres.sh stop "$cluster"' EXIT
tools/dev/postgres.sh start "$cluster"
at="$(sed -n 's/^folder=//p' "$cluster")&port=$(sed -n 's/^port=//p' "$cluster")"
psql -X -q -c 'CREATE DATABASE uplinkd OWNER uplinkd_owner' "postgresql://postgres@/postgres?host=$at"
"$bin/uplinkctl" store migrate --url "postgresql://uplinkd_owner@/uplinkd?host=$at" --grant-to uplinkd \
  >"$folder/migrate.log"
"$bin/uplink_bench_store" --url "postgresql://uplinkd@/uplinkd?host=$at" --folder "$folder" \
  --commit "$(git -c safe.directory='*' rev-parse --short HEAD)" "$@"
