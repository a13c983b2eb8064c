#!/bin/sh
# make-secrets.sh: makes a random password in each file of secrets/ that is not there yet. Containers with
# users of their own read the files, so everyone may; the folder is yours alone.
set -eu
cd "$(dirname "$0")/secrets"

chmod 700 .
for name in grafana metrics owner store broker; do
  [ -s "$name.password" ] || head -c 24 /dev/urandom | base64 | tr '+/' '-_' >"$name.password"
  chmod 644 "$name.password"
done
