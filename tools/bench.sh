#!/usr/bin/env bash
# Runs the benchmark and writes its report. usage: bench.sh [--quick]; SCENES=a,b and MINUTES=60 limit it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/setup/setup build bpy
tools/build.sh
arguments=("$@")
[ -n "${SCENES:-}" ] && arguments+=(--scenes "$SCENES")
[ -n "${MINUTES:-}" ] && arguments+=(--minutes "$MINUTES")
.venv/bpy45/bin/python3 tools/bench/bench.py "${arguments[@]}"
.venv/bpy45/bin/python3 tools/bench/report.py
