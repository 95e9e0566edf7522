#!/usr/bin/env bash
# Builds Embree 3.13.5 as a static, position-independent archive with hidden symbols and installs it in the cache.
#
# Why from source: Debian ships Embree only as a shared library, and inside Blender 4 and 5 its rtc* calls would bind to
# Blender's own Embree 4, where every ray silently misses. Only a static archive with hidden symbols is safe there.
#
# usage: embree.sh PREFIX      PREFIX is complete when PREFIX/.complete exists; several checkouts may share it.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
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
"$here/debian_source.sh" embree "$version" source
cd "$(find source -maxdepth 1 -type d -name 'embree*' | head -n 1)"
touch readme.pdf                 # removed from Debian's archive, but named by the install step

# Embree compiles the sources of all kinds of geometry even where the options below switch them off, and with a single
# instruction set it compiles most sources twice, into embree3 and embree_avx2, of which the linker takes the former.
# None of this reaches libgradus.so (a linker map shows it), and it is more than half of the time. A kind of geometry
# that is switched on below needs its sources here again.
cat > unused.cmake <<'LIST'
LIST(REMOVE_ITEM EMBREE_LIBRARY_FILES
  common/rtcore_builder.cpp common/scene_curves.cpp common/scene_line_segments.cpp common/scene_grid_mesh.cpp
  common/scene_points.cpp common/scene_quad_mesh.cpp common/motion_derivative.cpp
  subdiv/bezier_curve.cpp subdiv/bspline_curve.cpp subdiv/catmullrom_curve.cpp
  geometry/curve_intersector_virtual_4v.cpp geometry/curve_intersector_virtual_8v.cpp
  geometry/curve_intersector_virtual_4i.cpp geometry/curve_intersector_virtual_8i.cpp
  geometry/curve_intersector_virtual_4i_mb.cpp geometry/curve_intersector_virtual_8i_mb.cpp
  bvh/bvh_builder_hair.cpp bvh/bvh_builder_hair_mb.cpp)
LIST(FILTER EMBREE_LIBRARY_FILES_AVX2 EXCLUDE REGEX "curve_intersector_virtual|common/scene_|bvh_builder_hair")
LIST(REMOVE_ITEM EMBREE_LIBRARY_FILES_AVX2 ${EMBREE_LIBRARY_FILES})
LIST
lists_are_complete='# replaces all .cpp files with a dummy file'
grep -q "^$lists_are_complete" kernels/CMakeLists.txt
sed -i "/^$lists_are_complete/r unused.cmake" kernels/CMakeLists.txt

# Scenes of medium build quality, with single rays and packets of four, use a part of what is left. The functions below
# make builders and intersectors of the other parts, and the time goes into the templates that they instantiate: spatial
# splits (high quality), Morton codes and two levels (low quality and dynamic scenes), packets of eight, streams. What
# needs one of these needs its functions here again; a builder that is missing is a null pointer.
sed -i 's/return new [^;]*;/return nullptr;/' \
  kernels/bvh/bvh_builder_sah_spatial.cpp kernels/bvh/bvh_builder_morton.cpp kernels/bvh/bvh_builder_twolevel.cpp
cat > unused.h <<'MACROS'
#undef DEFINE_INTERSECTOR8
#undef DEFINE_INTERSECTORN
#define DEFINE_INTERSECTOR8(symbol, intersector) Accel::Intersector8 symbol() { return Accel::Intersector8(); }
#define DEFINE_INTERSECTORN(symbol, intersector) Accel::IntersectorN symbol() { return Accel::IntersectorN(); }
MACROS
macros_are_complete='ray stream filter interface'
grep -q "$macros_are_complete" kernels/common/accel.h
sed -i "/$macros_are_complete/r unused.h" kernels/common/accel.h

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
