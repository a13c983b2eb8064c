#!/bin/sh
# broker-files.sh: lays the broker's files out in /etc/mosquitto, for the broker's user alone. Runs at
# each `docker compose up`, in the broker's image, as root. Accounts that you added stay.
set -eu
umask 077

target=/etc/mosquitto
mkdir -p "$target/certs"
cp /mosquitto-files/mosquitto.conf /mosquitto-files/acl "$target/"
cp /authority/broker.crt "$target/certs/server.crt"
cp /authority/broker.key "$target/certs/server.key"
touch "$target/passwords"
mosquitto_passwd -b "$target/passwords" uplinkd "$(head -n 1 /run/secrets/broker_password)"
chown -R mosquitto:mosquitto "$target" /var/lib/mosquitto
