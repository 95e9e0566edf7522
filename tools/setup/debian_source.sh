#!/usr/bin/env bash
# Unpacks the original source archive of a Debian 12 package, whose checksum its description vouches for.
#
# usage: debian_source.sh PACKAGE VERSION FOLDER      FOLDER is created; it holds what the archive has at its top level.
set -euo pipefail
package=${1:?usage: debian_source.sh PACKAGE VERSION FOLDER} version=${2:?} folder=${3:?}
mkdir -p "$folder"
cd "$folder"

# A private source list: the system's own has no deb-src lines and stays as it is. Nor are apt's files of the system
# written, so that packages may be installed meanwhile.
mkdir -p lists/partial
cat > sources.list <<LIST
deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main
LIST
apt_options=(-o "Dir::Etc::sourcelist=$PWD/sources.list" -o Dir::Etc::sourceparts=- -o "Dir::State::lists=$PWD/lists"
  -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=)
apt-get "${apt_options[@]}" update
# The packaging archive may be missing on a mirror (exit code 100); what counts is the orig archive, checked below.
apt-get "${apt_options[@]}" source --download-only "$package=$version*" ||
  apt-get "${apt_options[@]}" source --download-only "$package" || true

orig=$(ls "${package}_${version}"*.orig.tar.*z)
source_sha256=$(awk -v f="$orig" '/^Checksums-Sha256:/ {on=1; next} /^[A-Z]/ {on=0} on && $3 == f {print $1}' \
  "${package}"_*.dsc)
echo "$source_sha256  $orig" | sha256sum --check --strict
tar -xf "$orig"
