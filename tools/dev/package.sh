#!/usr/bin/env bash
# package.sh [--out FOLDER]: Debian packages of the release build, in build/package by default, with what
# lintian says of them. Nothing is compiled beyond `./dev build`; the same tree gives the same bytes.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

out="$PWD/build/package"
while [[ $# -gt 0 ]]; do
  case "$1" in
    --out)
      [[ $# -ge 2 ]] || die_usage "$1 needs a value"
      out="$(realpath -m "$2")"
      shift 2
      ;;
    *) die_usage "package: unknown argument: $1" ;;
  esac
done

need_packages
build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet manual

# The version stands in CMakeLists.txt, and again where dpkg wants it.
version="$(project_version)"
packaged="$(dpkg-parsechangelog -l deploy/debian/changelog -S Version)"
[[ "$packaged" == "$version" || "$packaged" == "$version"-* ]] ||
  die "CMakeLists.txt says $version, deploy/debian/changelog $packaged"

rm -rf "$out"
# dpkg-buildpackage writes beside the folder that it is called in.
mkdir -p "$out/tree"
cp -r deploy/debian "$out/tree/debian"
log="$out/package.log"
# With umask and language of the caller the files would differ.
(
  umask 022
  cd "$out/tree"
  UPLINK_BUILD_DIR="$OLDPWD/build/release" LC_ALL=C.UTF-8 dpkg-buildpackage -us -uc -b
) >"$log" 2>&1 || {
  tail -n 40 "$log" >&2
  die "dpkg-buildpackage failed: see $log"
}
rm -rf "$out/tree"

lintian="$(lintian --allow-root --fail-on error,warning "$out"/*.changes 2>&1)" || {
  printf '%s\n' "$lintian" >&2
  die "lintian found errors or warnings"
}
printf 'lintian: no errors, no warnings\n'
[[ -z "$lintian" ]] || printf '%s\n' "$lintian"
(cd "$out" && du -h -- *.deb)
