#!/usr/bin/env bash
# mosquitto.sh VERB FOLDER [PKI]: a private mosquitto on a port of the loopback interface, with the
# configuration and the access list of deploy/mosquitto. It touches no other broker of the machine.
#   start FOLDER PKI   a fresh one in FOLDER, whose certificate is PKI's broker.crt
#   stop FOLDER        ends it
# FOLDER/state says where it is: `port` and `pid`, a line each. Its users are uplinkd, and uplink-fleet,
# which may publish for every twin; FOLDER/uplinkd.password and FOLDER/uplink-fleet.password have their
# passwords.
set -euo pipefail

die() {
  printf 'mosquitto: %s\n' "$*" >&2
  exit 1
}

usage="usage: mosquitto.sh start FOLDER PKI, or mosquitto.sh stop FOLDER"
[[ ($# -eq 3 && "$1" == start) || ($# -eq 2 && "$1" == stop) ]] || die "$usage"
verb="$1"
folder="$(realpath -m -- "$2")"
source_folder="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../deploy/mosquitto"
readonly start_seconds=10

value_of() { sed -n "s/^$1=//p" "$folder/state"; }

# It is not a child of this shell: it is gone when its process is.
stop() {
  local pid i
  [[ -f "$folder/state" ]] || return 0
  pid="$(value_of pid)"
  if grep -qaF "$folder/mosquitto.conf" "/proc/$pid/cmdline" 2>/dev/null; then
    kill -TERM "$pid" 2>/dev/null || true
    for ((i = 0; i < start_seconds * 10; i++)); do
      kill -0 "$pid" 2>/dev/null || break
      sleep 0.1
    done
  fi
  rm -f "$folder/state"
}

# The files as they are delivered; paths, port and the process's user are ours.
write_files() {
  local port="$1"
  sed -e "s|^listener 8883$|listener $port 127.0.0.1|" \
    -e "s|/etc/mosquitto/certs/server|$pki/broker|" \
    -e "s|/etc/mosquitto/|$folder/|" \
    -e "s|/var/lib/mosquitto/|$folder/|" "$source_folder/mosquitto.conf" >"$folder/mosquitto.conf"
  printf 'user %s\nlog_dest file %s/mosquitto.log\nlog_type all\n' "$(id -un)" "$folder" \
    >>"$folder/mosquitto.conf"
}

users() {
  local user password
  cp "$source_folder/acl" "$folder/acl"
  cat >>"$folder/acl" <<'ACL'

# The synthetic fleet stands for every twin, and for who maintains environments.
user uplink-fleet
topic write cyberwave/twin/#
topic write cyberwave/joint/#
topic write cyberwave/environment/#
topic write cyberwave/workflow-run/#
topic write cyberwave/ping/#
topic read cyberwave/pong/#
ACL
  : >"$folder/passwords"
  for user in uplinkd uplink-fleet; do
    password="$(openssl rand -hex 16)"
    printf '%s\n' "$password" >"$folder/$user.password"
    mosquitto_passwd -b "$folder/passwords" "$user" "$password"
  done
  chmod 600 "$folder/acl" "$folder/passwords"
}

start() {
  local program tries port pid i
  program="$(command -v mosquitto || true)"
  [[ -n "$program" ]] || program=/usr/sbin/mosquitto
  [[ -x "$program" ]] || die "no mosquitto: ./dev setup installs it"
  umask 077
  mkdir -p "$folder"
  users
  for tries in 1 2 3 4 5 6 7 8; do
    port=$((20000 + RANDOM % 12000))
    write_files "$port"
    : >"$folder/mosquitto.log"
    setsid "$program" -c "$folder/mosquitto.conf" >/dev/null 2>&1 &
    pid=$!
    for ((i = 0; i < start_seconds * 10; i++)); do
      if grep -q ' running' "$folder/mosquitto.log"; then
        printf 'port=%s\npid=%s\n' "$port" "$pid" >"$folder/state"
        return 0
      fi
      kill -0 "$pid" 2>/dev/null || break
      sleep 0.1
    done
    kill -TERM "$pid" 2>/dev/null || true
    [[ "$tries" -lt 8 ]] || die "it does not start: $(tail -n 3 "$folder/mosquitto.log")"
  done
}

case "$verb" in
  start)
    pki="$(realpath -- "$3")"
    stop
    start
    ;;
  stop) stop ;;
esac
