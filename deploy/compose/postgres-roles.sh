#!/bin/sh
# postgres-roles.sh: makes the servers' role beside the owner's. The image of PostgreSQL runs it once, when
# it makes the database.
set -eu

# psql reads the password itself: everyone on the machine sees a program's arguments.
psql -v ON_ERROR_STOP=1 --username "$POSTGRES_USER" --dbname "$POSTGRES_DB" <<'SQL'
\set password `head -n 1 /run/secrets/store_password`
CREATE ROLE uplinkd LOGIN PASSWORD :'password';
SQL
