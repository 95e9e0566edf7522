#!/usr/bin/env bash
# Builds what is out of date. usage: build.sh [library | tests | sanitizers | package]     default: library and tool
# sanitizers: the native tests with address and undefined-behaviour sanitizers, in build-sanitize/.
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

if [ "${1:-}" = sanitizers ]; then
  configure build-sanitize -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O1 -DGRADUS_SANITIZE=ON
  build build-sanitize gradus_native_tests gradus_stress_tests
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
