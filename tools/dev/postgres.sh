#!/usr/bin/env bash
# postgres.sh start STATE | crash STATE | stop STATE: a private PostgreSQL cluster in a temporary folder, reached by
# a socket in it and by a port of the loopback interface. It touches no other cluster of the machine.
# STATE is a file that says where it is: `folder`, `port` and `bin`, a line each. Roles beside the
# superuser `postgres`: uplinkd_owner, who migrates, and uplinkd, who serves; over TCP their password
# is their name.
set -euo pipefail

die() {
  printf 'postgres: %s\n' "$*" >&2
  exit 1
}

[[ $# -eq 2 ]] || die "usage: postgres.sh start|crash|stop STATE"
verb="$1"
state="$(realpath -m -- "$2")"

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

value_of() { sed -n "s/^$1=//p" "$state"; }

start() {
  local bin folder port tries
  bin="$(bindir)"
  folder="$(mktemp -d "${TMPDIR:-/tmp}/uplink-pg.XXXXXX")"
  chmod 755 "$folder"
  [[ "$(id -u)" -ne 0 ]] || chown postgres: "$folder"
  cd "$folder"
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
  for tries in 1 2 3 4 5 6 7 8; do
    port=$((20000 + RANDOM % 12000))
    if as_owner "$bin/pg_ctl" start -w -t 60 -D "$folder/data" -l "$folder/server.log" \
      -o "-p $port" >/dev/null 2>&1; then
      break
    fi
    [[ "$tries" -lt 8 ]] || die "the server does not start: $(tail -n 3 "$folder/server.log")"
  done
  psql -X -q -h "$folder" -p "$port" -U postgres -d postgres <<'SQL'
CREATE ROLE uplinkd_owner LOGIN PASSWORD 'uplinkd_owner';
CREATE ROLE uplinkd LOGIN PASSWORD 'uplinkd';
SQL
  printf 'folder=%s\nport=%s\nbin=%s\n' "$folder" "$port" "$bin" >"$state.new"
  mv "$state.new" "$state"
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

# As a crash: nothing is flushed; the log is replayed at the start.
crash() {
  local folder bin
  folder="$(value_of folder)"
  bin="$(value_of bin)"
  cd "$folder"
  as_owner "$bin/pg_ctl" restart -w -t 60 -m immediate -D "$folder/data" -l "$folder/server.log" \
    -o "-p $(value_of port)" >/dev/null || die "the server does not start again"
}

case "$verb" in
  crash) crash ;;
  start)
    stop
    start
    ;;
  stop) stop ;;
  *) die "usage: postgres.sh start|crash|stop STATE" ;;
esac
