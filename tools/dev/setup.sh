#!/usr/bin/env bash
# Installs the packages of tools/dev/packages.txt that are missing. Costs nothing when none is.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

[[ $# -eq 0 ]] || die_usage "setup takes no arguments"
mapfile -t missing < <(missing_packages)
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi
printf 'dev: installing %s\n' "${missing[*]}" >&2

as_root=()
if [[ "$(id -u)" -ne 0 ]]; then
  command -v sudo >/dev/null ||
    die "these packages are missing and there is no sudo; as root, run: apt-get install ${missing[*]}"
  as_root=(sudo)
fi

# Some packages (prometheus) would start a daemon; maintainer scripts ask this file first.
readonly policy=/usr/sbin/policy-rc.d
if [[ ! -e "$policy" ]]; then
  trap '"${as_root[@]}" rm -f "$policy"' EXIT
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$policy" >/dev/null
  "${as_root[@]}" chmod 755 "$policy"
fi

apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" >&2
}

install_missing() {
  apt install --no-install-recommends "${missing[@]}"
}

if ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then
  apt update
fi
# Lists that are there may name versions that the mirror no longer has.
install_missing || { apt update && install_missing; } || die "apt-get could not install the packages"

# The tests need only prometheus' checker, not its service.
for package in "${missing[@]}"; do
  if [[ "$package" == prometheus ]] && command -v systemctl >/dev/null; then
    "${as_root[@]}" systemctl disable --now prometheus.service >/dev/null 2>&1 ||
      printf 'dev: prometheus.service could not be disabled; it is not needed\n' >&2
  fi
done

mapfile -t missing < <(missing_packages)
[[ ${#missing[@]} -eq 0 ]] || die "still missing: ${missing[*]}"
