#!/bin/sh
# postgres-roles.sh: makes the servers' role beside the owner's. The image of PostgreSQL runs it once, when
# it makes the database.
set -eu

psql -v ON_ERROR_STOP=1 --username "$POSTGRES_USER" --dbname "$POSTGRES_DB" \
  -v password="$(head -n 1 /run/secrets/store_password)" <<'SQL'
CREATE ROLE uplinkd LOGIN PASSWORD :'password';
SQL
