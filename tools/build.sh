#!/usr/bin/env bash
# Builds what is out of date.
#
# usage: build.sh [library | tests | checks [--full] | package]     default: library and tool
#
# checks: builds that find faults that the tests do not see.
#   build-thread/    some native tests with the sanitizer of threads, and an instrumented TBB. Objects for link-time
#                    optimisation, so that linking them finds types and variables that two sources define differently
#                    under one name. Each source is compiled by itself.
#   build-sanitize/  some native tests with the sanitizers of addresses and undefined behaviour
# With --full, all native tests in the first, and another one takes the place of the second:
#   build-address/   all native tests and the stress tests with the same sanitizers
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/setup/setup build

# Configures a folder that has other options or none. build/ keeps those that a developer gave it.
configure() {  # FOLDER OPTION...
  if [ -e "$1/build.ninja" ]; then
    if [ "$1" = build ] || [ "$(cat "$1/options" 2>/dev/null)" = "${*:2}" ]; then return; fi
    rm -rf "${1:?}"
  fi
  cmake -S . -B "$1" -G Ninja "${@:2}" >build.log 2>&1 || { cat build.log >&2; exit 1; }
  rm -f build.log
  printf '%s' "${*:2}" >"$1/options"
}
build() {  # FOLDER TARGET...
  ninja -C "$@" | sed -u -e '/Entering directory/d' -e '/Re-checking globbed/d' -e '/no work to do/d' >&2
}

if [ "${1:-}" = checks ]; then
  tbb=${XDG_CACHE_HOME:-$HOME/.cache}/gradus/tbb-2021.8.0-thread/lib/cmake/TBB
  debug=(-DCMAKE_BUILD_TYPE=Debug)
  tools/setup/setup checks
  configure build-thread "${debug[@]}" -DCMAKE_CXX_FLAGS_DEBUG="-O1 -flto" -DGRADUS_SANITIZE=thread \
    -DTBB_DIR="$tbb" -DGRADUS_UNITY=OFF \
    -DCMAKE_EXE_LINKER_FLAGS="-O1 -flto=2 -Wodr -Werror=odr -Wlto-type-mismatch -Werror=lto-type-mismatch"
  if [ -n "${2:-}" ]; then
    build build-thread gradus_native_tests
    configure build-address "${debug[@]}" -DCMAKE_CXX_FLAGS_DEBUG=-O1 -DGRADUS_SANITIZE=address
    build build-address gradus_native_tests gradus_stress_tests
  else
    build build-thread gradus_thread_tests
    # Without optimisation, instrumented sources compile three times as fast, and a few tests run twice as long.
    configure build-sanitize "${debug[@]}" -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DGRADUS_SANITIZE=address
    build build-sanitize gradus_sanitized_tests
  fi
  exit
fi

configure build -DCMAKE_BUILD_TYPE=Release

case ${1:-} in
  library) targets=(gradus) ;;
  tests) targets=(all) ;;
  *) targets=(gradus) ; grep -q '^build gradus_tool:' build/build.ninja && targets+=(gradus_tool) ;;
esac
build build "${targets[@]}"
/usr/bin/python3 tools/bundle.py build/native/libgradus.so addon/gradus/lib
case ${1:-} in
  package) /usr/bin/python3 tools/package.py ;;
  "") echo "build: addon/gradus/lib/libgradus.so and build/native/gradus" ;;
esac
