#!/usr/bin/env bash
# release.sh [--require-sbom]: everything that a release consists of, in build/release-VERSION: packages, a
# tarball of what they install, SBOMs (CycloneDX and SPDX) and SHA256SUMS. Packages and tarball of the same
# tree have the same bytes.
# debsbom comes from PyPI; where it cannot be had the SBOMs are left out, which fails with --require-sbom.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

readonly debsbom="debsbom[cdx,spdx]==0.10.2" cyclonedx="cyclonedx-python-lib[json-validation]"
require_sbom=
case "$#:${1:-}" in
  0:) ;;
  1:--require-sbom) require_sbom=1 ;;
  *) die_usage "release takes --require-sbom alone" ;;
esac

tools/dev/package.sh
version="$(project_version)"
epoch="$(dpkg-parsechangelog -l deploy/debian/changelog -S Timestamp)"
architecture="$(dpkg --print-architecture)"
readonly name="uplinkd-$version" out="$PWD/build/release-$version"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
rm -rf "$out"
mkdir -p "$out"
cp build/package/*.deb build/package/*.changes build/package/*.buildinfo "$out/"

(umask 022 && DESTDIR="$work/$name" cmake --install build/release --prefix /usr --strip >"$work/install.log") || {
  cat "$work/install.log" >&2
  die "cmake --install failed"
}
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$epoch" --mode=u=rwX,go=rX -c "$name" |
  gzip -9n >"$out/$name-linux-$architecture.tar.gz"

check_cyclonedx() {
  "$1/bin/python" -c '
import json, pathlib, sys
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
text = pathlib.Path(sys.argv[1]).read_text()
version = SchemaVersion.from_version(json.loads(text)["specVersion"])
sys.exit(JsonStrictValidator(version).validate_str(text))' "$2"
}

# Of our packages and all that they need, at the versions that they were built with.
make_sbom() {
  local venv="$PWD/build/sbom-venv" at
  if [[ ! -x "$venv/bin/debsbom" ]]; then
    python3 -m venv --clear "$venv" && "$venv/bin/pip" -q install "$debsbom" "$cyclonedx" || return 1
  fi
  python3 tools/dev/sbom_root.py "$work/sbom" "$out"/uplinkd_*.deb "$out"/uplinkd-tools_*.deb || return 1
  at="$(date -u -d "@$epoch" +%FT%T+00:00)"
  "$venv/bin/debsbom" generate -r "$work/sbom" -t cdx -t spdx --validate -o "$out/$name" \
    --distro-name uplinkd --distro-version "$version" --distro-arch "$architecture" --timestamp "$at" \
    --cdx-serialnumber "$(md5sum "$work/sbom/var/lib/dpkg/status" |
      sed -E 's/^(.{8})(.{4}).(.{3}).(.{3})(.{12}).*/\1-\2-4\3-8\4-\5/')" \
    --spdx-namespace "https://uplinkd.example/sbom/$version" &&
    check_cyclonedx "$venv" "$out/$name.cdx.json"
}
if make_sbom >"$work/sbom.log" 2>&1; then
  printf 'SBOM: %s\n' "$(sed -n 's/ packages$/ packages, valid/p' "$work/sbom.log")"
else
  cat "$work/sbom.log" >&2
  rm -f "$out/$name".*.json
  printf 'dev: the SBOM was left out\n' >&2
  [[ -z "$require_sbom" ]] || die "--require-sbom"
fi

(cd "$out" && sha256sum -- * >SHA256SUMS && sha256sum --quiet -c SHA256SUMS && ls -lh)
