#!/usr/bin/env bash
# chaos.sh [--kills N] [--store sqlite|postgres] [--seed S] [--canary acks_early|unsynced]: the crash
# campaign.
# chaos.sh --store postgres --servers 2 [--kills N] [--seed S]: with two servers on one PostgreSQL.
# chaos.sh --cyberwave [the same; --canary acks_on_arrival|forgets_deliveries]: with a broker.
# chaos.sh --uncrew [the same; --canary answers_early|forgets_samples]: with drones.
# chaos.sh --failovers N [--seed S] [--canary trusts_reconnect]: a PostgreSQL primary dies N times, and a standby
# that lags takes over.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

need_packages
build_preset release bin/uplinkd bin/uplinkctl bin/uplink_chaos_robots bin/uplinkd_held \
  bin/uplinkd_unsynced bin/uplinkd_acks_early bin/uplinkd_acks_on_arrival bin/uplinkd_forgets_deliveries \
  bin/uplinkd_trusts_reconnect bin/uplinkd_answers_early bin/uplinkd_forgets_samples
export UPLINK_BIN_DIR="$PWD/build/release/bin" PYTHONDONTWRITEBYTECODE=1
exec python3 tests/e2e/chaos_run.py "$@"
