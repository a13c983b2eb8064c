#!/usr/bin/env bash
# demo.sh [--for 30s] [--robots 50] [--gateways 0] [--store sqlite|postgres] [--seed N]
#         [--cyberwave|--uncrew]:
# a development authority, an uplinkd with the embedded store or a private PostgreSQL cluster, a
# synthetic fleet that breaks off and sends wrong things on purpose, by itself or through gateways, and
# the comparison of what was sent, counted and stored. In place of robots, with --cyberwave a mosquitto
# and twins that publish to it, with --uncrew drones that call.
# Everything lies in build/demo, made afresh; nothing is left running. Fails if anything does not add
# up. Builds first, unless UPLINK_BIN_DIR names the programs.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

# Tests put other folders here.
readonly bin="${UPLINK_BIN_DIR:-$PWD/build/release/bin}"
readonly demo="${UPLINK_DEMO_DIR:-$PWD/build/demo}"
readonly start_seconds=30
# To start, settle and compare.
readonly check_seconds=10
# kRobotsNumber of tools/uplink-fleet/scenario/scenario.h.
readonly robots_max=50000

duration=30s
robots=50
gateways=0
store=sqlite
seed=1
players=robots
cyberwave=
uncrew=
while [[ $# -gt 0 ]]; do
  case "$1" in
    --for | --robots | --gateways | --store | --seed)
      [[ $# -ge 2 ]] || die_usage "$1 needs a value"
      case "$1" in
        --for) duration="$2" ;;
        --robots) robots="$2" ;;
        --gateways) gateways="$2" ;;
        --store) store="$2" ;;
        --seed) seed="$2" ;;
      esac
      shift 2
      ;;
    --cyberwave)
      cyberwave=1
      players=twins
      shift
      ;;
    --uncrew)
      uncrew=1
      players=drones
      shift
      ;;
    *) die_usage "demo: unknown argument: $1" ;;
  esac
done
case "$store" in
  sqlite | postgres) ;;
  *) die_usage "demo: unknown store: $store (sqlite or postgres)" ;;
esac
[[ "$robots" =~ ^[1-9][0-9]{0,4}$ && "$robots" -le "$robots_max" ]] ||
  die_usage "demo: --robots takes a number from 1 to $robots_max"
[[ "$gateways" =~ ^[0-9]{1,4}$ ]] || die_usage "demo: --gateways takes a number from 0 to 9999"
[[ -z "$cyberwave$uncrew" || "$gateways" -eq 0 ]] ||
  die_usage "demo: --gateways are not for --cyberwave and --uncrew"
[[ -z "$cyberwave" || -z "$uncrew" ]] || die_usage "demo: --cyberwave or --uncrew, not both"
[[ "$seed" =~ ^[0-9]{1,18}$ ]] || die_usage "demo: --seed takes a number"
[[ "$duration" =~ ^[1-9][0-9]*(ms|s|m|h)$ ]] || die_usage "demo: --for takes a duration such as 30s"

# Seconds of "30s", as the fleet reads it; one for less.
whole_seconds() {
  local number="${1%%[a-z]*}"
  case "$1" in
    *ms) printf '%s\n' "$((number / 1000 + 1))" ;;
    *s) printf '%s\n' "$number" ;;
    *m) printf '%s\n' "$((number * 60))" ;;
    *h) printf '%s\n' "$((number * 3600))" ;;
  esac
}

# What comes before the run, and how long it takes; nothing if all is there.
#
# Source of the time: a first build of the three programs with an empty ccache took 17 minutes.
preparation() {
  local installs=0 reference="$built"
  [[ -z "${UPLINK_BIN_DIR:-}" ]] || return 0
  installs="$(missing_packages | wc -l)"
  [[ "$installs" -eq 0 ]] || printf 'installs %d Debian packages, then ' "$installs"
  [[ -f "$reference" ]] || reference="$bin/uplink-fleet"
  if [[ ! -f "$reference" ]]; then
    printf 'builds (first build about 20 min on two cores; later seconds), then '
  elif [[ -n "$(find CMakeLists.txt CMakePresets.json cmake metrics proto schema server storage tools \
    -newer "$reference" -type f ! -name '*.sh' ! -name '*.py' ! -name '*.md' -print -quit)" ]]; then
    printf 'builds what changed (seconds to minutes), then '
  fi
}

readonly built="$PWD/build/release/demo.built"
plan="$(preparation)"
printf 'demo: %sruns a server and %d %s for %s, then checks every message; that takes about %d s\n' \
  "$plan" "$robots" "$players" "$duration" "$(($(whole_seconds "$duration") + check_seconds))"
if [[ -z "${UPLINK_BIN_DIR:-}" ]]; then
  need_packages
  mkdir -p "${built%/*}"
  # Sources that change while it builds are newer.
  : >"$built.began"
  build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet
  mv "$built.began" "$built"
fi
for program in uplinkd uplinkctl uplink-fleet; do
  [[ -x "$bin/$program" ]] || die "$bin/$program is not built: ./dev build"
done

server_pid=
stop_server() {
  [[ -n "$server_pid" ]] || return 0
  local pid="$server_pid"
  server_pid=
  kill -TERM "$pid" 2>/dev/null || true
  wait "$pid"
}
readonly cluster="$demo/postgres.state" broker="$demo/broker"
stop_all() {
  stop_server || true
  tools/dev/mosquitto.sh stop "$broker"
  [[ ! -f "$cluster" ]] || tools/dev/postgres.sh stop "$cluster"
}
trap stop_all EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

[[ ! -f "$cluster" ]] || tools/dev/postgres.sh stop "$cluster"
tools/dev/mosquitto.sh stop "$broker"
rm -rf "$demo"
mkdir -p "$demo"
readonly pki="$demo/pki" log="$demo/uplinkd.log"
{
  "$bin/uplinkctl" pki init --dir "$pki"
  "$bin/uplinkctl" pki server --dir "$pki" --host localhost --host 127.0.0.1
} >"$demo/pki.log"
store_url="sqlite://$demo/uplinkd.db"
if [[ "$store" == postgres ]]; then
  tools/dev/postgres.sh start "$cluster"
  at="$(sed -n 's/^folder=//p' "$cluster")&port=$(sed -n 's/^port=//p' "$cluster")"
  psql -X -q -c 'CREATE DATABASE uplinkd OWNER uplinkd_owner' \
    "postgresql://postgres@/postgres?host=$at"
  "$bin/uplinkctl" store migrate --url "postgresql://uplinkd_owner@/uplinkd?host=$at" \
    --grant-to uplinkd
  store_url="postgresql://uplinkd@/uplinkd?host=$at"
fi
cat >"$demo/uplinkd.toml" <<TOML
[listen]
relay = "127.0.0.1:0"
http = "127.0.0.1:0"

[tls]
certificate_file = "$pki/server.crt"
key_file = "$pki/server.key"
client_ca_file = "$pki/ca.crt"

[store]
url = "$store_url"
TOML

fleet=(--pki "$pki" --gateways "$gateways" --scenario rough)
if [[ -n "$cyberwave" ]]; then
  "$bin/uplinkctl" pki server --dir "$pki" --name broker --host localhost --host 127.0.0.1 \
    >>"$demo/pki.log"
  tools/dev/mosquitto.sh start "$broker" "$pki"
  mqtt="mqtts://localhost:$(sed -n 's/^port=//p' "$broker/state")"
  cat >>"$demo/uplinkd.toml" <<TOML

[mqtt]
url = "$mqtt"
client_id = "uplinkd-demo"
username = "uplinkd"
password_file = "$broker/uplinkd.password"
ca_file = "$pki/ca.crt"

[cyberwave]
topic_prefixes = [""]
TOML
  fleet=(--cyberwave "$mqtt" --mqtt-username uplink-fleet --mqtt-ca "$pki/ca.crt"
    --mqtt-password-file "$broker/uplink-fleet.password")
fi

if [[ -n "$uncrew" ]]; then
  printf '\n[uncrew]\navatar = true\n' >>"$demo/uplinkd.toml"
  fleet+=(--protocol uncrew)
fi

# A session of its own: an interrupt on the terminal is for this script, which drains the server.
setsid "$bin/uplinkd" --config "$demo/uplinkd.toml" >"$log" 2>&1 &
server_pid=$!

# The line `listening relay=ADDRESS http=ADDRESS`: the ports were free when they were bound.
listening=
for ((i = 0; i < start_seconds * 10; i++)); do
  if listening="$(grep -s -m1 -E ' listening .*relay=' "$log")"; then break; fi
  if ! kill -0 "$server_pid" 2>/dev/null; then
    cat "$log" >&2
    die "uplinkd ended before it listened"
  fi
  sleep 0.1
done
[[ -n "$listening" ]] || die "uplinkd did not listen within $start_seconds s: see $log"
address_of() {
  sed -E "s/.* $1=\"?([^ \"]+)\"?.*/\1/" <<<"$listening"
}
relay="$(address_of relay)"
http="$(address_of http)"

printf 'uplinkd: relay at %s, log in %s\n' "$relay" "${log#"$PWD/"}"
[[ -z "$cyberwave" ]] ||
  printf 'mosquitto: twins at %s, log in %s\n' "$mqtt" "${broker#"$PWD/"}/mosquitto.log"
printf 'while it runs: http://%s/api/v1/robots, and there\n' "$http"
printf '  /api/v1/status  /metrics  /metrics/robots  /api/v1/shapes  /api/v1/objects\n'
printf '  /api/v1/faults?active=true  /api/v1/missions?open=true'
if [[ -n "$cyberwave" ]]; then
  printf '  /api/v1/scope-updates\n  /api/v1/quarantine?source=cyberwave'
elif [[ -n "$uncrew" ]]; then
  printf '  /api/v1/operator-requests\n'
  printf '  /api/v1/robot?ruri=rcan://local.rcan/uncrew/uav/synthetic-0001'
else
  printf '\n  /api/v1/robot?ruri=rcan://local.rcan/uplink/synthetic/1.0/robot-0001'
fi
printf '\n  /api/v1/events  /api/v1/messages  /api/v1/presence  /api/v1/quarantine  /api/v1/gaps\n'

fleet_code=0
"$bin/uplink-fleet" --target "$relay" --http "$http" --robots "$robots" --for "$duration" \
  --seed "$seed" "${fleet[@]}" || fleet_code=$?

server_code=0
stop_server || server_code=$?
if [[ "$server_code" -ne 0 ]]; then
  tail -n 20 "$log" >&2
  die "uplinkd ended with $server_code: see $log"
fi
if [[ "$fleet_code" -ne 0 ]]; then
  exit "$fleet_code"
fi
printf 'uplinkd drained and stopped; everything lies in %s\n' "${demo#"$PWD/"}"
