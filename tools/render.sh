#!/usr/bin/env bash
# Sets up, builds and renders; see render.py for the variables. Debian's Blender is installed only if no other one is named.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# A mistake is told before anything is built.
[ ! -x /usr/bin/python3 ] || /usr/bin/python3 tools/render.py --check
[ -n "${BLENDER:-}" ] || tools/setup/setup blender
tools/build.sh library
exec /usr/bin/python3 tools/render.py
