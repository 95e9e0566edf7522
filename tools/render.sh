#!/usr/bin/env bash
# Sets up, builds and renders. render.py describes the variables; with --animation, render_animation.py does. Debian's
# Blender is installed unless BLENDER names another one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
script=tools/render.py
[ "${1:-}" != --animation ] || script=tools/render_animation.py
# Reports wrong variables before anything is built.
[ ! -x /usr/bin/python3 ] || /usr/bin/python3 "$script" --check
[ -n "${BLENDER:-}" ] || tools/setup/setup render
tools/build.sh library
exec /usr/bin/python3 "$script"
