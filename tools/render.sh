#!/usr/bin/env bash
# Sets up, builds and renders; see render.py for the variables, or with --animation render_animation.py. Debian's Blender is installed only if no other one is named.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
script=tools/render.py
[ "${1:-}" != --animation ] || script=tools/render_animation.py
# A mistake is told before anything is built.
[ ! -x /usr/bin/python3 ] || /usr/bin/python3 "$script" --check
[ -n "${BLENDER:-}" ] || tools/setup/setup blender
tools/build.sh library
exec /usr/bin/python3 "$script"
