#!/usr/bin/env bash
# postgres.sh VERB STATE [OF]: a private PostgreSQL cluster in a temporary folder, reached by a socket
# in it and by a port of the loopback interface. It touches no other cluster of the machine.
#   start STATE        a fresh one
#   start-light STATE  a fresh one in memory, if the machine has room there, which makes databases and
#                      commits many times faster: for tests, whose data may go with the machine
#   standby STATE OF   a copy that follows the cluster OF, under the name `standby`
#   rejoin STATE OF    the cluster, which does not run any more, becomes a copy that follows OF, where it was
#   promote STATE      the standby takes writes from now on
#   crash STATE        as a crash: nothing is flushed, the log is replayed at the start that follows
#   halt STATE         as a crash, without a start
#   stop STATE         ends it and removes its folder
# STATE is a file that says where it is: `folder`, `port` and `bin`, a line each. Roles beside the
# superuser `postgres`: uplinkd_owner, who migrates, and uplinkd, who serves; over TCP their password
# is their name.
set -euo pipefail

die() {
  printf 'postgres: %s\n' "$*" >&2
  exit 1
}

usage="usage: postgres.sh start|start-light|promote|crash|halt|stop STATE, or postgres.sh standby|rejoin STATE OF"
[[ $# -eq 2 || ($# -eq 3 && ("$1" == standby || "$1" == rejoin)) ]] || die "$usage"
verb="$1"
state="$(realpath -m -- "$2")"
[[ "$verb" != standby && "$verb" != rejoin ]] || of="$(realpath -m -- "${3:-}")"

bindir() {
  local found
  found="$(pg_config --bindir 2>/dev/null || true)"
  if [[ ! -x "$found/initdb" ]]; then
    found="$(find /usr/lib/postgresql -maxdepth 2 -name bin 2>/dev/null | sort -V | tail -n 1)"
  fi
  [[ -x "$found/initdb" ]] || die "no initdb: ./dev setup installs it"
  printf '%s' "$found"
}

# PostgreSQL refuses to run as root.
as_owner() {
  if [[ "$(id -u)" -eq 0 ]]; then
    setpriv --reuid=postgres --regid=postgres --init-groups -- "$@"
  else
    "$@"
  fi
}

value_of() { sed -n "s/^$1=//p" "${2:-$state}"; }

# new_folder: where the cluster will live, in `folder`.
new_folder() {
  folder="$(mktemp -d "${TMPDIR:-/tmp}/uplink-pg.XXXXXX")"
  chmod 755 "$folder"
  [[ "$(id -u)" -ne 0 ]] || chown postgres: "$folder"
  cd "$folder"
}

# serve: starts what lies in $folder/data on a free port, and says where in STATE.
serve() {
  local tries port
  for tries in 1 2 3 4 5 6 7 8; do
    port=$((20000 + RANDOM % 12000))
    if as_owner "$bin/pg_ctl" start -w -t 60 -D "$folder/data" -l "$folder/server.log" \
      -o "-p $port" >/dev/null 2>&1; then
      break
    fi
    [[ "$tries" -lt 8 ]] || die "the server does not start: $(tail -n 3 "$folder/server.log")"
  done
  printf 'folder=%s\nport=%s\nbin=%s\n' "$folder" "$port" "$bin" >"$state.new"
  mv "$state.new" "$state"
}

# A file system in memory on every Linux, and what must be free in it: the log, and the databases of
# the tests that run at once.
readonly memory=/dev/shm
readonly memory_free_kib=$((2 * 1024 * 1024))

start_light() {
  local free
  free="$(df --output=avail -k "$memory" 2>/dev/null | tail -n 1 || true)"
  if [[ -w "$memory" && "${free:-0}" -ge "$memory_free_kib" ]]; then
    TMPDIR="$memory" UPLINK_POSTGRES_CONF="max_wal_size = 256MB" start
  else
    start
  fi
}

start() {
  local bin folder
  bin="$(bindir)"
  new_folder
  as_owner "$bin/initdb" -D "$folder/data" -U postgres --auth-local=trust \
    --auth-host=scram-sha-256 --no-sync -E UTF8 --locale=C.UTF-8 >"$folder/initdb.log" 2>&1 ||
    die "initdb failed: $(tail -n 3 "$folder/initdb.log")"
  # So many test programs at once, each with a few connections.
  as_owner tee -a "$folder/data/postgresql.conf" >/dev/null <<CONF
listen_addresses = '127.0.0.1'
unix_socket_directories = '$folder'
max_connections = 200
shared_buffers = 128MB
logging_collector = off
log_min_messages = warning
log_checkpoints = off
${UPLINK_POSTGRES_CONF:-}
CONF
  serve
  psql -X -q -h "$folder" -p "$(value_of port)" -U postgres -d postgres <<'SQL'
CREATE ROLE uplinkd_owner LOGIN PASSWORD 'uplinkd_owner';
CREATE ROLE uplinkd LOGIN PASSWORD 'uplinkd';
SQL
}

standby() {
  local bin folder
  bin="$(bindir)"
  new_folder
  as_owner "$bin/pg_basebackup" -D "$folder/data" -R -c fast \
    -d "host=$(value_of folder "$of") port=$(value_of port "$of") user=postgres application_name=standby" \
    >"$folder/basebackup.log" 2>&1 || die "pg_basebackup failed: $(tail -n 3 "$folder/basebackup.log")"
  as_owner tee -a "$folder/data/postgresql.conf" >/dev/null <<CONF
unix_socket_directories = '$folder'
CONF
  serve
}

# The folder and the port stay, so that a URL with them finds it again.
rejoin() {
  local bin folder
  bin="$(value_of bin)"
  folder="$(value_of folder)"
  cd "$folder"
  rm -rf "$folder/data"
  # A server that was killed leaves the lock of its socket, and its number may be another process's by
  # now: that counts as a server that runs.
  rm -f "$folder"/.s.PGSQL.*
  as_owner "$bin/pg_basebackup" -D "$folder/data" -R -c fast \
    -d "host=$(value_of folder "$of") port=$(value_of port "$of") user=postgres application_name=standby" \
    >"$folder/basebackup.log" 2>&1 || die "pg_basebackup failed: $(tail -n 3 "$folder/basebackup.log")"
  as_owner tee -a "$folder/data/postgresql.conf" >/dev/null <<CONF
unix_socket_directories = '$folder'
CONF
  as_owner "$bin/pg_ctl" start -w -t 60 -D "$folder/data" -l "$folder/server.log" \
    -o "-p $(value_of port)" >/dev/null 2>&1 ||
    die "the server does not start: $(tail -n 3 "$folder/server.log")"
}

stop() {
  [[ -f "$state" ]] || return 0
  local folder bin
  folder="$(value_of folder)"
  bin="$(value_of bin)"
  rm -f "$state"
  if [[ -d "$folder/data" ]]; then
    (cd "$folder" && as_owner "$bin/pg_ctl" stop -m immediate -D "$folder/data" >/dev/null 2>&1) || true
  fi
  rm -rf "$folder"
}

promote() {
  cd "$(value_of folder)"
  as_owner "$(value_of bin)/pg_ctl" promote -w -t 60 -D "$(value_of folder)/data" >/dev/null ||
    die "the standby is not promoted"
}

halt() {
  cd "$(value_of folder)"
  as_owner "$(value_of bin)/pg_ctl" stop -w -t 60 -m immediate -D "$(value_of folder)/data" >/dev/null ||
    die "the server does not stop"
}

crash() {
  local folder bin
  folder="$(value_of folder)"
  bin="$(value_of bin)"
  cd "$folder"
  as_owner "$bin/pg_ctl" restart -w -t 60 -m immediate -D "$folder/data" -l "$folder/server.log" \
    -o "-p $(value_of port)" >/dev/null || die "the server does not start again"
}

case "$verb" in
  start | start-light | standby)
    stop
    "${verb/-/_}"
    ;;
  rejoin | promote | crash | halt | stop) "$verb" ;;
  *) die "$usage" ;;
esac
