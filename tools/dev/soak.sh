#!/usr/bin/env bash
# soak.sh [--minutes N] [--store sqlite|postgres] [--robots N] [--seed S] [--json FILE]: hours of load
# with reconnects and store outages, and what grew meanwhile.
# soak.sh days [--days N] [--robots N]: days of presence, expiry and retention in seconds, by a manual
# clock.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

need_packages
if [[ "${1:-}" == days ]]; then
  shift
  build_preset release bin/uplink_simulate_days
  exec build/release/bin/uplink_simulate_days "$@"
fi
build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet
export UPLINK_BIN_DIR="$PWD/build/release/bin" PYTHONDONTWRITEBYTECODE=1
exec python3 tests/load/soak.py "$@"
