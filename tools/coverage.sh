#!/usr/bin/env bash
# Compares features of Blender with Cycles and writes docs/coverage.md. Variables of the environment limit the run:
#   HOSTS=bpy45,3.4  ROWS='ShaderNodeMath*'  AGAIN=1 (render what was rendered before, too)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/setup/setup build bpy blender
tools/build.sh library
export PYTHONPATH=tools
exec /usr/bin/python3 -m coverage ${HOSTS:+--hosts "$HOSTS"} ${ROWS:+--rows "$ROWS"} ${AGAIN:+--again}
