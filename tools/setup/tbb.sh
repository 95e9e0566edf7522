#!/usr/bin/env bash
# Builds oneTBB 2021.8 with ThreadSanitizer and installs it in the cache folder, for the tests that look for data races.
#
# Why from source: how Debian's libtbb passes work between threads is invisible to ThreadSanitizer, which would report
# every hand-over.
#
# usage: tbb.sh PREFIX      PREFIX is complete when PREFIX/.complete exists; builds of several checkouts may share it.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
prefix=${1:?usage: tbb.sh PREFIX}
version=2021.8.0
[ -e "$prefix/.complete" ] && exit 0

mkdir -p "$(dirname "$prefix")"
exec 9>"$prefix.lock"            # two checkouts that build at once: the second waits and then finds it done
flock 9
[ -e "$prefix/.complete" ] && exit 0

work=$(mktemp -d "$prefix.build.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$here/debian_source.sh" onetbb "$version" "$work/source"
cmake -S "$work/source/oneTBB-$version" -B "$work/build" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -g -DNDEBUG" \
  -DCMAKE_INSTALL_PREFIX="$work/install" -DCMAKE_INSTALL_LIBDIR=lib \
  -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON
cmake --build "$work/build"
cmake --install "$work/build"

rm -rf "$prefix"
mv "$work/install" "$prefix"
touch "$prefix/.complete"
