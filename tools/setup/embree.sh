#!/usr/bin/env bash
# Builds Embree 3.13.5 as a static, position-independent archive with hidden symbols and installs it in the cache folder.
#
# Why from source: Debian ships Embree only as a shared library, and inside Blender 4 and 5 its rtc* calls would bind to
# Blender's own Embree 4, where every ray silently misses. Only a static archive with hidden symbols is safe there.
#
# usage: embree.sh PREFIX      PREFIX is complete when PREFIX/.complete exists; builds of several checkouts may share it.
set -euo pipefail

prefix=${1:?usage: embree.sh PREFIX}
version=3.13.5
[ -e "$prefix/.complete" ] && exit 0

mkdir -p "$(dirname "$prefix")"
exec 9>"$prefix.lock"            # two checkouts that build at once: the second waits and then finds it done
flock 9
[ -e "$prefix/.complete" ] && exit 0

work=$(mktemp -d "$prefix.build.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"

# A private source list: the system's own has no deb-src lines and stays as it is.
mkdir -p lists/partial
cat > sources.list <<LIST
deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main
LIST
apt_options=(-o "Dir::Etc::sourcelist=$work/sources.list" -o Dir::Etc::sourceparts=- -o "Dir::State::lists=$work/lists")
apt-get "${apt_options[@]}" update
# The packaging archive may be missing on a mirror (exit code 100); what counts is the orig archive, checked below.
apt-get "${apt_options[@]}" source --download-only "embree=$version*" || apt-get "${apt_options[@]}" source --download-only embree || true

orig=$(ls embree_${version}*.orig.tar.xz)
source_sha256=$(awk -v f="$orig" '/^Checksums-Sha256:/ {on=1; next} /^[A-Z]/ {on=0} on && $3 == f {print $1}' embree_*.dsc)
echo "$source_sha256  $orig" | sha256sum --check --strict
tar -xf "$orig"
cd "$(find . -maxdepth 1 -type d -name 'embree*' | head -n 1)"
touch readme.pdf                 # removed from Debian's archive, but named by the install step

cmake -S . -B build -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$work/install" -DCMAKE_INSTALL_LIBDIR=lib \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_CXX_FLAGS="-fvisibility=hidden" \
  -DEMBREE_STATIC_LIB=ON -DEMBREE_TASKING_SYSTEM=INTERNAL -DEMBREE_ISPC_SUPPORT=OFF -DEMBREE_TUTORIALS=OFF \
  -DEMBREE_MAX_ISA=NONE -DEMBREE_ISA_SSE2=OFF -DEMBREE_ISA_SSE42=OFF -DEMBREE_ISA_AVX=OFF -DEMBREE_ISA_AVX2=ON \
  -DEMBREE_ISA_AVX512=OFF \
  -DEMBREE_GEOMETRY_CURVE=OFF -DEMBREE_GEOMETRY_SUBDIVISION=OFF -DEMBREE_GEOMETRY_GRID=OFF -DEMBREE_GEOMETRY_USER=ON \
  -DEMBREE_GEOMETRY_POINT=OFF -DEMBREE_GEOMETRY_QUAD=OFF -DEMBREE_GEOMETRY_TRIANGLE=ON -DEMBREE_GEOMETRY_INSTANCE=ON \
  -DEMBREE_RAY_MASK=ON -DEMBREE_FILTER_FUNCTION=ON -DEMBREE_BACKFACE_CULLING=OFF \
  -DEMBREE_IGNORE_INVALID_RAYS=OFF -DEMBREE_STATIC_RUNTIME=OFF
cmake --build build
cmake --install build

rm -rf "$prefix"
mv "$work/install" "$prefix"
touch "$prefix/.complete"
