#!/usr/bin/env bash
# Runs the benchmark and writes its report. usage: bench.sh [--quick | --speed | --host]; SCENES=a,b and MINUTES=60 limit it.
# --speed: only the time of a sample in the room (ROOMS=room-1k WIDTH=640 REPEATS=3). --host: only export and upload. --quick leaves both out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=.venv/bpy45/bin/python3
part=${1:-all}
case $part in
  --quick) tools/setup/setup build bpy ;;
  *) tools/setup/setup build blender bpy ;;
esac
tools/build.sh

option() { [ -z "$2" ] || arguments+=("$1" "$2"); }

host() { "$python" tools/bench/host.py; }
speed() {
  local arguments=()
  option --rooms "${ROOMS:-}"
  option --width "${WIDTH:-}"
  option --repeats "${REPEATS:-}"
  option --minutes "${MINUTES:-}"
  "$python" tools/bench/speed.py "${arguments[@]}"
  "$python" tools/bench/speed_report.py
}
errors() {
  local arguments=("$@")
  option --scenes "${SCENES:-}"
  option --minutes "${MINUTES:-}"
  "$python" tools/bench/bench.py "${arguments[@]}"
  "$python" tools/bench/report.py
}

case $part in
  --host) host ;;
  --speed) speed ;;
  --quick) errors --quick ;;
  all) host; speed; errors ;;
  *) echo "bench.sh: unknown option $part" >&2; exit 1 ;;
esac
