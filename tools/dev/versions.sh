#!/usr/bin/env bash
# versions.sh [VERSION] [unittest's arguments]: programs of an older release and of this tree on one store
# (tests/e2e/test_two_versions.py). VERSION: the newest of tests/fixtures/stores by default. Its programs are
# those of UPLINK_OLD_BIN_DIR, of the tarball that ./dev release left in build/release-VERSION, or are built from
# the tag vVERSION, in build/versions.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

version="$(printf '%s\n' tests/fixtures/stores/[0-9]*/ | sort -V | tail -n 1 | xargs basename)"
if [[ "${1:-}" =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]]; then
  version="$1"
  shift
fi
architecture="$(dpkg --print-architecture)"
readonly version tarball="build/release-$version/uplinkd-$version-linux-$architecture.tar.gz"
readonly work="$PWD/build/versions"

git_here() {
  git -c safe.directory='*' "$@"
}

# commit_of BIN_DIR: what these programs say that they were built from.
commit_of() {
  "$1/uplinkd" --version | sed -n 's/.*(commit \([0-9a-f]*\).*/\1/p'
}

unpack() {
  rm -rf "$work/uplinkd-$version"
  mkdir -p "$work"
  tar -C "$work" -xzf "$tarball" "uplinkd-$version/usr/bin" || die "$tarball is no tarball of ./dev release"
  older="$work/uplinkd-$version/usr/bin"
}

# By the tree's own rules, as it was then.
build_from_tag() {
  local source="$work/source-$version"
  [[ -d "$source" ]] || git_here worktree add --quiet --detach "$source" "v$version"
  printf 'dev: building %s from its tag, which takes as long as a first build\n' "$version" >&2
  (cd "$source" && bash -c 'set -euo pipefail && source tools/dev/lib.sh && need_packages &&
    build_preset release bin/uplinkd bin/uplinkctl') || die "v$version could not be built; see $source"
  older="$source/build/release/bin"
}

tag="$(git_here rev-parse --quiet --verify --short=8 "v$version^{commit}" || true)"
[[ -z "$tag" ]] || git_here diff --quiet "$tag" -- "tests/fixtures/stores/$version" ||
  die "tests/fixtures/stores/$version differs from v$version: the stores of a release never change"
older="${UPLINK_OLD_BIN_DIR:-}"
if [[ -z "$older" ]]; then
  if [[ -f "$tarball" ]]; then
    unpack
    # A tarball from before the tag is another program.
    [[ -z "$tag" || "$(commit_of "$older")" == "$tag" ]] || build_from_tag
  elif [[ -n "$tag" ]]; then
    build_from_tag
  else
    die "no programs of $version: there is neither a tag v$version nor $tarball, which ./dev release makes"
  fi
  [[ -n "$tag" ]] ||
    printf 'dev: %s has no tag yet, so the older programs are those that ./dev release made of this tree\n' "$version" >&2
fi
if [[ -z "${UPLINK_BIN_DIR:-}" ]]; then
  need_packages
  build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet
  export UPLINK_BIN_DIR="$PWD/build/release/bin"
fi
printf 'dev: older: %s\ndev: newer: %s\n' "$("$older/uplinkd" --version)" "$("$UPLINK_BIN_DIR/uplinkd" --version)" >&2
[[ -n "${TMPDIR:-}" || ! -w /dev/shm ]] || export TMPDIR=/dev/shm
export UPLINK_OLD_BIN_DIR="$older" PYTHONDONTWRITEBYTECODE=1
PYTHONPATH="$PWD/tests/e2e" exec python3 tests/deploy/run.py test_two_versions "$@"
