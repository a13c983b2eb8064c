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

# By a file, since everyone on the machine sees a program's arguments.
new="$target/passwords.new"
password="$(head -n 1 /run/secrets/broker_password)"
case "$password" in
  *:*)
    echo 'broker-files.sh: the password of the broker holds a colon, which ends it in the file of passwords' >&2
    exit 1
    ;;
esac
printf 'uplinkd:%s\n' "$password" >"$new"
mosquitto_passwd -U "$new"
[ ! -e "$target/passwords" ] || sed '/^uplinkd:/d' "$target/passwords" >>"$new"
mv "$new" "$target/passwords"

chown -R mosquitto:mosquitto "$target" /var/lib/mosquitto
