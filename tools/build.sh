#!/usr/bin/env bash
# Builds what is out of date. usage: build.sh [library | tests | package]     default: library and tool
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/setup/setup build

[ -e build/build.ninja ] || cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release >build.log 2>&1 || { cat build.log >&2; exit 1; }
rm -f build.log

case ${1:-} in
  library) targets=(gradus) ;;
  tests) targets=(all) ;;
  *) targets=(gradus) ; grep -q '^build gradus_tool:' build/build.ninja && targets+=(gradus_tool) ;;
esac
ninja -C build "${targets[@]}" | sed -u -e '/Entering directory/d' -e '/Re-checking globbed/d' -e '/no work to do/d' >&2
/usr/bin/python3 tools/bundle.py build/native/libgradus.so addon/gradus/lib
case ${1:-} in
  package) /usr/bin/python3 tools/package.py ;;
  "") echo "build: addon/gradus/lib/libgradus.so and build/native/gradus" ;;
esac
