#!/usr/bin/env bash
# Builds what is out of date.
#
# usage: build.sh [library | tests | checks [--full] | package]     default: library and tool
#
# checks: builds that find faults that the tests do not see.
#   build-odr/       objects for link-time optimisation; linking them (ninja -C build-odr gradus) is the test, which
#                    finds types and variables that two sources define differently under one name; each source is
#                    compiled by itself, which shows that it includes what it uses
#   build-sanitize/  some native tests with the sanitizers of addresses and undefined behaviour
# With --full, two others take the place of the second:
#   build-address/   all native tests and the stress tests with the same sanitizers
#   build-thread/    native tests with the sanitizer of threads, and an instrumented TBB
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/setup/setup build

configure() {  # FOLDER OPTION...
  [ -e "$1/build.ninja" ] || cmake -S . -B "$1" -G Ninja "${@:2}" >build.log 2>&1 || { cat build.log >&2; exit 1; }
  rm -f build.log
}
build() {  # FOLDER TARGET...
  ninja -C "$@" | sed -u -e '/Entering directory/d' -e '/Re-checking globbed/d' -e '/no work to do/d' >&2
}

if [ "${1:-}" = checks ]; then
  tbb=${XDG_CACHE_HOME:-$HOME/.cache}/gradus/tbb-2021.8.0-thread/lib/cmake/TBB
  debug=(-DCMAKE_BUILD_TYPE=Debug)
  if [ -n "${2:-}" ]; then
    configure build-address "${debug[@]}" -DCMAKE_CXX_FLAGS_DEBUG=-O1 -DGRADUS_SANITIZE=address
    build build-address gradus_native_tests gradus_stress_tests
    tools/setup/setup checks
    configure build-thread "${debug[@]}" -DCMAKE_CXX_FLAGS_DEBUG=-O1 -DGRADUS_SANITIZE=thread -DTBB_DIR="$tbb"
    build build-thread gradus_native_tests
  else
    # Without optimisation, instrumented sources compile three times as fast, and a few tests run twice as long.
    configure build-sanitize "${debug[@]}" -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DGRADUS_SANITIZE=address
    build build-sanitize gradus_sanitized_tests
  fi
  configure build-odr -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O0 -flto" -DGRADUS_TESTS=OFF \
    -DGRADUS_FLOW=OFF -DGRADUS_UNITY=OFF \
    -DCMAKE_SHARED_LINKER_FLAGS="-O0 -flto=2 -Wodr -Werror=odr -Wlto-type-mismatch -Werror=lto-type-mismatch"
  build build-odr gradus_core
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
