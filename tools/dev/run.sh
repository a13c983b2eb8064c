#!/usr/bin/env bash
# run.sh [UPLINKD ARGUMENTS]: a release uplinkd with the embedded store on the default ports. What
# it needs (a development authority, a certificate, a configuration, the store) lies in build/run.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

need_packages
build_preset release bin/uplinkd bin/uplinkctl

readonly folder="$PWD/build/run"
readonly pki="$folder/pki"
readonly uplinkctl=build/release/bin/uplinkctl
mkdir -p "$folder"
[[ -f "$pki/ca.crt" ]] || "$uplinkctl" pki init --dir "$pki"
[[ -f "$pki/server.crt" ]] ||
  "$uplinkctl" pki server --dir "$pki" --name server --host localhost --host 127.0.0.1
if [[ ! -f "$folder/uplinkd.toml" ]]; then
  cat >"$folder/uplinkd.toml" <<TOML
[tls]
certificate_file = "$pki/server.crt"
key_file = "$pki/server.key"
client_ca_file = "$pki/ca.crt"

[store]
url = "sqlite://$folder/uplinkd.db"
TOML
fi
exec build/release/bin/uplinkd --config "$folder/uplinkd.toml" "$@"
