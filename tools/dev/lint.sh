#!/usr/bin/env bash
# lint.sh: format, shellcheck, spelling, workflows, the tidy test and clang-tidy, each to its end before the
# verdict.
# clang-tidy skips what it has passed before with the same content (tools/dev/lint/README.md).
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
# shellcheck source=tools/dev/lib.sh
source tools/dev/lib.sh

[[ $# -eq 0 ]] || die_usage "lint takes no arguments"
need_packages

readonly build=build/lint
bad=()

step() {
  local name="$1"
  shift
  printf 'lint: %s\n' "$name" >&2
  "$@" || bad+=("$name")
}

check_format() {
  cxx_files | xargs -0 -r clang-format-14 --dry-run -Werror
}

check_shell() {
  shell_files | xargs -0 -r shellcheck --external-sources
}

# Names in camelCase are no words, nor is what follows the n of an escaped line end.
check_spelling() {
  list_files ':!tests/fuzz/corpus' ':!tests/conformance/vectors' ':!tests/fixtures' |
    xargs -0 -r codespell --quiet-level 3 --ignore-words tools/dev/spelling.txt \
      --ignore-regex '\\n|\b\w*[a-z][A-Z]\w*\b'
}

# actionlint is no package of Debian, and lint downloads nothing.
check_workflows() {
  local tools="${UPLINK_TOOLS_DIR:-$HOME/.cache/uplinkd-tools}/bin"
  if ! PATH="$PATH:$tools" command -v actionlint >/dev/null; then
    printf 'lint: no actionlint, so .github/workflows is left out. This installs it, with Go 1.25 or later:\n' >&2
    printf '  GOBIN=%s go install github.com/rhysd/actionlint/cmd/actionlint@v1.7.12\n' "$tools" >&2
    return
  fi
  # Without a list it looks for workflows where git says that the tree begins.
  PATH="$PATH:$tools" actionlint .github/workflows/*.yml
}

check_clang_tidy() {
  mkdir -p "$build"
  # clang as compiler: the database then holds only flags that clang-tidy knows. Without the
  # precompiled headers of the targets, which g++ or another clang may have written.
  cmake --preset dev -B "$build" -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DUPLINK_LINT=ON >"$build/configure.log" 2>&1 || {
    cat "$build/configure.log" >&2
    return 1
  }
  ninja -C "$build" -t targets all |
    sed -n 's/^\(.*\.\(pb\|capnp\)\.h\): CUSTOM_COMMAND$/\1/p' |
    xargs -r ninja -C "$build" uplink_lint_scope >/dev/null || return 1
  PYTHONDONTWRITEBYTECODE=1 python3 tools/dev/lint/clang_tidy.py "$build"
}

step "format (./dev format repairs it)" check_format
step "shellcheck" check_shell
step "spelling (tools/dev/spelling.txt has the exceptions)" check_spelling
step "workflows" check_workflows
step "tidy" python3 tests/tidy/tidy.py --root .
step "clang-tidy" check_clang_tidy

if [[ ${#bad[@]} -gt 0 ]]; then
  printf 'lint: failed: %s\n' "${bad[@]}" >&2
  exit 1
fi
printf 'lint: clean\n'
