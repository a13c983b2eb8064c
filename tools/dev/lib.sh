# shellcheck shell=bash
# What the verbs of ./dev share. Sourced with the tree's top folder as working directory.

readonly packages_file="${UPLINK_PACKAGES_FILE:-tools/dev/packages.txt}"

die() {
  printf 'dev: %s\n' "$*" >&2
  exit 1
}

# Wrong use, or a verb that this version does not hold.
die_usage() {
  printf 'dev: %s\n' "$*" >&2
  exit 2
}

known_preset() {
  case "$1" in
    release | dev | asan | tsan | fuzz) return 0 ;;
    *) return 1 ;;
  esac
}

# The version of the programs, by the only place where it is set.
project_version() {
  local version
  version="$(sed -n 's/^project(uplinkd VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
  [[ -n "$version" ]] || die "CMakeLists.txt names no version"
  printf '%s\n' "$version"
}

# The packages of the list that are not installed, one a line. Asks dpkg alone: no network.
missing_packages() {
  command -v dpkg-query >/dev/null || die "no dpkg-query: ./dev works on Debian 12"
  comm -23 \
    <(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$packages_file" | sort -u) \
    <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p' | sort -u)
}

need_packages() {
  if [[ -n "$(missing_packages)" ]]; then
    tools/dev/setup.sh
  fi
}

# ThreadSanitizer of g++ 12 cannot place its shadow where newer kernels randomise 32 bits.
tsan_runner() {
  if [[ "$1" == tsan ]] && setarch "$(uname -m)" -R true 2>/dev/null; then
    printf 'setarch\n%s\n-R\n' "$(uname -m)"
  fi
}

# with_progress WHAT NINJA ...: runs ninja; its progress and errors go to standard error.
with_progress() {
  local what="$1"
  shift
  NINJA_STATUS='[[%f/%t]] ' "$@" 2>&1 | tools/dev/build_progress.py "$what"
}

# build_preset PRESET [NINJA TARGET ...]: all targets by default. Output goes to standard error, so
# that a verb's own output stays alone.
build_preset() {
  local name="$1" log="build/$1.configure.log" runner=()
  shift
  mapfile -t runner < <(tsan_runner "$name")
  mkdir -p build
  [[ -f "build/$name/build.ninja" ]] || printf 'build %s: configure\n' "$name" >&2
  if ! cmake --preset "$name" >"$log" 2>&1; then
    cat "$log" >&2
    die "cmake --preset $name failed"
  fi
  with_progress "$name" "${runner[@]}" ninja -C "build/$name" "$@"
}

# Files of the tree, tracked or new, ended by NUL: list_files PATTERN ...
list_files() {
  # The user who runs ./dev trusts this tree, so its owner does not matter.
  git -c safe.directory='*' ls-files -z --cached --others --exclude-standard --deduplicate -- "$@" |
    while IFS= read -r -d '' file; do
      # A file that was removed but not yet committed is still listed.
      [[ ! -f "$file" ]] || printf '%s\0' "$file"
    done
}

cxx_files() {
  list_files '*.h' '*.cc'
}

shell_files() {
  list_files dev .ci/run '*.sh'
}

# Whole seconds of "30s", "2m" or "90".
seconds_of() {
  case "$1" in
    *[!0-9sm]* | '' | s | m) return 1 ;;
    *s) printf '%s\n' "$((10#${1%s}))" ;;
    *m) printf '%s\n' "$((10#${1%m} * 60))" ;;
    *) printf '%s\n' "$((10#$1))" ;;
  esac
}
