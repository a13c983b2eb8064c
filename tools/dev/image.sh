#!/usr/bin/env bash
# image.sh [ENGINE [FLAG ...]]: builds the image uplinkd:VERSION from the release build, with docker, or with
# podman where that is missing. ENGINE and its FLAGs stand before `build`; UPLINK_IMAGE_FLAGS after it. The
# folder that it is built from is build/image.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

readonly context="$PWD/build/image" programs=(uplinkd uplinkctl uplink-fleet)

engine=("$@")
if [[ ${#engine[@]} -eq 0 ]]; then
  for name in docker podman; do
    command -v "$name" >/dev/null && engine=("$name") && break
  done
fi
[[ ${#engine[@]} -gt 0 ]] || die "neither docker nor podman is there: apt-get install podman"

bin="${UPLINK_BIN_DIR:-}"
if [[ -z "$bin" ]]; then
  need_packages
  build_preset release "${programs[@]/#/bin/}"
  bin=build/release/bin
fi
version="$(project_version)"

rm -rf "$context"
mkdir -p "$context/bin"
for program in "${programs[@]}"; do
  # Without debugging information, which is nine tenths of it.
  strip -o "$context/bin/$program" "$bin/$program"
done
cp deploy/container/gather.sh deploy/container/uplinkd.toml "$context/"

flags=(--build-arg "VERSION=$version" -t "uplinkd:$version" -f deploy/container/Dockerfile)
# podman's own format of images has no health check.
[[ "$(basename "${engine[0]}")" != podman ]] || flags+=(--format docker)
read -r -a more <<<"${UPLINK_IMAGE_FLAGS:-}"
"${engine[@]}" build "${flags[@]}" "${more[@]}" "$context"
printf 'dev: built the image uplinkd:%s\n' "$version" >&2
