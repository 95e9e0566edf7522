#!/usr/bin/env bash
# usage: lint.sh format   rewrites the sources in the project's format
#        lint.sh check    says what differs from it, and what clang-tidy and ruff object to; changes nothing
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/setup/setup dev
mapfile -t cpp < <(git ls-files 'native/*.cpp' 'native/*.h' 'native/*.hpp' 'tests/*.cpp' 'tests/*.h')
ruff=.venv/dev/bin/ruff

case ${1:?usage: lint.sh format | check} in
  format)
    clang-format -i "${cpp[@]}"
    "$ruff" check --quiet --fix .
    "$ruff" format --quiet .
    ;;
  check)
    failed=0
    clang-format --dry-run --Werror "${cpp[@]}" || failed=1
    "$ruff" check . || failed=1
    "$ruff" format --check --quiet . || { echo "ruff format would change files: make format" >&2; failed=1; }
    # clang-tidy needs the compile command of each source, without options that only GCC has.
    cmake -S . -B build-lint -G Ninja -DGRADUS_UNITY=OFF -DGRADUS_TESTS=OFF >/dev/null
    sed -i -E 's/ -mmem(set|cpy)-strategy=[^ ]*//g' build-lint/compile_commands.json
    git ls-files 'native/src/*.cpp' | xargs -P "$(nproc)" -n 4 clang-tidy -p build-lint --quiet 2>/dev/null || failed=1
    exit $failed
    ;;
esac
