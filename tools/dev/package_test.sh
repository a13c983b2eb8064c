#!/usr/bin/env bash
# package_test.sh: makes the packages, then installs, runs, upgrades, removes and purges them under a real
# systemd (systemd-nspawn) in a root that mmdebstrap made. Needs root. The base root is kept in
# build/package-base. Ends with the line "N passed, N failed".
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

[[ $# -eq 0 ]] || die_usage "package-test takes no arguments"
[[ "$(id -u)" -eq 0 ]] || die "package-test needs root: it boots a system in a root of its own"
need_packages
tools/dev/package.sh
export UPLINK_PACKAGES="$PWD/build/package" UPLINK_PACKAGE_CACHE="$PWD/build/package-base"
# Tests end processes, never the machine: roots in memory are quicker.
[[ -n "${TMPDIR:-}" || ! -w /dev/shm ]] || export TMPDIR=/dev/shm
PYTHONDONTWRITEBYTECODE=1 exec python3 tests/package/run.py
