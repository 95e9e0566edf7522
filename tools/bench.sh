#!/usr/bin/env bash
# Runs the benchmark and writes its report. usage: bench.sh [--quick | --host]; SCENES=a,b and MINUTES=60 limit it.
# --host: only export and upload, which --quick leaves out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case " $* " in
  *" --quick "*) tools/setup/setup build bpy ;;
  *) tools/setup/setup build blender bpy ;;
esac
tools/build.sh
[ "${1:-}" = --quick ] || .venv/bpy45/bin/python3 tools/bench/host.py
[ "${1:-}" = --host ] && exit
arguments=("$@")
[ -n "${SCENES:-}" ] && arguments+=(--scenes "$SCENES")
[ -n "${MINUTES:-}" ] && arguments+=(--minutes "$MINUTES")
.venv/bpy45/bin/python3 tools/bench/bench.py "${arguments[@]}"
.venv/bpy45/bin/python3 tools/bench/report.py
