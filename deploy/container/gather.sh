#!/bin/sh
# gather.sh FOLDER PROGRAM ...: lays out a root file system in FOLDER with these programs, the libraries
# that they load, the user that runs them and its folders. Runs in the image's build, as root.
set -eu

image="$1"
shift
user=10001

mkdir -p "$image/usr/bin" "$image/usr/lib" "$image/usr/lib64" "$image/etc/ssl/certs"
for folder in bin lib lib64; do
  ln -s "usr/$folder" "$image/$folder"
done

# ldd names each library by the path under which the loader finds it.
ldd "$@" >/build/ldd
if grep 'not found' /build/ldd; then
  echo 'gather.sh: the image lacks these libraries: name their packages in the Dockerfile' >&2
  exit 1
fi
awk '$2 == "=>" { print $3 } $1 ~ /^\/lib64\// { print $1 }' /build/ldd | sort -u |
  while read -r library; do
    mkdir -p "$image$(dirname "$library")"
    cp -L "$library" "$image$library"
  done
cp "$@" "$image/usr/bin/"

# Names are looked up in files first, then by DNS: the libraries for that are part of libc.
printf 'hosts: files dns\n' >"$image/etc/nsswitch.conf"
printf 'root:x:0:0:root:/:/sbin/nologin\nuplinkd:x:%s:%s:uplinkd:/var/lib/uplinkd:/sbin/nologin\n' \
  "$user" "$user" >"$image/etc/passwd"
printf 'root:x:0:\nuplinkd:x:%s:\n' "$user" >"$image/etc/group"
# For brokers and databases whose certificates a public authority signed.
cp /etc/ssl/certs/ca-certificates.crt "$image/etc/ssl/certs/"
# Where OpenSSL looks for them.
mkdir -p "$image/usr/lib/ssl"
ln -s /etc/ssl/certs/ca-certificates.crt "$image/usr/lib/ssl/cert.pem"

install -D -m 644 /build/uplinkd.toml "$image/etc/uplinkd/uplinkd.toml"
# A volume that is new takes over owner and mode of its folder here.
install -d -m 1777 "$image/tmp"
install -d -o "$user" -g "$user" -m 750 "$image/var/lib/uplinkd"
for folder in tls authority access; do
  install -d -o "$user" -g "$user" -m 700 "$image/etc/uplinkd/$folder"
done
