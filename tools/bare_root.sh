#!/usr/bin/env bash
# Prints the path of a Debian 12 root folder with the packages of the hosts, but without development packages, for tests
# of the package. Creates the folder once (about a minute) in the cache folder. Needs root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/setup"
packages=$(sed -e 's/#.*//' debian-blender.txt debian-bpy.txt | awk 'NF {print $1}' | sort -u | paste -sd,)
hash=$(printf '%s' "$packages" | sha256sum | cut -c1-12)
root=${XDG_CACHE_HOME:-$HOME/.cache}/gradus/bare-bookworm-$hash
mkdir -p "$(dirname "$root")"
exec 9>"$root.lock"
flock 9
if [ ! -e "$root/.complete" ]; then
  rm -rf --one-file-system "$root"
  mmdebstrap --quiet --mode=root --variant=apt --include="$packages" bookworm "$root" \
    "deb ${GRADUS_DEBIAN_MIRROR:-http://deb.debian.org/debian} bookworm main" >&2
  touch "$root/.complete"
fi
mkdir -p "$root"/opt/{bpy45,bpy50,bpy52,python} "$root/work"
echo "$root"
