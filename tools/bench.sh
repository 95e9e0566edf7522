#!/usr/bin/env bash
# Runs the benchmark and writes its report. usage: bench.sh [--errors | --quick | --compare | --agreement | --animation | --motion | --speed | --designs | --suite | --pictures | --host | --report]; all without one.
#   --errors  error against CPU time; SCENES=a,b MODES=path,auto WIDTH=160 REFERENCE=1024 SEEDS=5 SAMPLES=4,16,64 MINUTES=60 limit it
#   --quick   the same of two scenes, smaller
#   --compare  the errors of two versions among the stored results; OLD=772811d NEW=414ff4f WIDTH=160
#   --agreement  converged images against those of Cycles and Mitsuba; SCENES, WIDTH and REFERENCE as above
#   --animation  flicker against CPU time; SCENES, MODES, REFERENCE, SEEDS, SAMPLES and MINUTES limit it; SIZE=320x180 FRAMES=24 BLUR=1 vary it
#   --motion  motion of components: truth, prediction, flicker, cost; SCENES, REFERENCE, SEEDS, SAMPLES and MINUTES limit it; PARTS=truth,flicker
#             SIZE=320x180 FRAMES=6 vary it, REPEATS=3 of cost, BLUR=1 of truth and cost; LOADED=1 says that the machine has other work: times are not shown
#   --speed   time of a sample in the room; ROOMS=room-1k SPEED_WIDTH=640 REPEATS=3 MINUTES=60 limit it
#   --designs  reconstructions that were published, written anew in Python, against the product's; SCENES and REFERENCE as above
#   --suite   time of the statistical tests and of the reconstructions
#   --pictures  pictures of the project's own scenes by all modes
#   --host    export and upload
#   --report  nothing but the report, from what is stored
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=.venv/bpy45/bin/python3
part=${1:-all}

set_up() {
  tools/setup/setup build bpy "$@"
  tools/setup/setup bench || echo "bench: no Mitsuba here, it is left out" >&2
  tools/build.sh
}
option() { [ -z "$2" ] || arguments+=("$1" "$2"); }

limits() {
  option --scenes "${SCENES:-}"
  option --modes "${MODES:-}"
  option --reference "${REFERENCE:-}"
  option --seeds "${SEEDS:-}"
  option --samples "${SAMPLES:-}"
  option --minutes "${MINUTES:-}"
}
errors() {
  local arguments=("$@")
  limits
  option --width "${WIDTH:-}"
  "$python" tools/bench/bench.py "${arguments[@]}"
}
animation() {
  local arguments=()
  limits
  option --size "${SIZE:-}"
  option --frames "${FRAMES:-}"
  [ -z "${BLUR:-}" ] || arguments+=(--blur)
  "$python" tools/bench/animation.py "${arguments[@]}"
}
motion() {
  local arguments=()
  limits
  option --parts "${PARTS:-}"
  option --repeats "${REPEATS:-}"
  option --size "${SIZE:-}"
  option --frames "${FRAMES:-}"
  [ -z "${BLUR:-}" ] || arguments+=(--blur)
  [ -z "${LOADED:-}" ] || arguments+=(--loaded)
  "$python" tools/bench/motion.py "${arguments[@]}"
}
compare() {
  local arguments=("${OLD:?which versions?}" "${NEW:?which versions?}")
  option --width "${WIDTH:-}"
  "$python" tools/bench/compare.py "${arguments[@]}"
}
agreement() {  # from the references of errors(), where these are there
  local arguments=()
  option --scenes "${SCENES:-}"
  option --width "${WIDTH:-}"
  option --samples "${REFERENCE:-}"
  "$python" tools/bench/agreement.py "${arguments[@]}"
}
speed() {
  local arguments=()
  option --rooms "${ROOMS:-}"
  option --width "${SPEED_WIDTH:-}"
  option --repeats "${REPEATS:-}"
  option --minutes "${MINUTES:-}"
  "$python" tools/bench/speed.py "${arguments[@]}"
}
designs() {
  local arguments=()
  option --scenes "${SCENES:-}"
  option --reference "${REFERENCE:-}"
  OPENBLAS_NUM_THREADS=1 "$python" tools/bench/compare_designs.py "${arguments[@]}"
}
suite() {
  tools/build.sh tests
  "$python" tools/bench/suite.py
  "$python" tools/bench/solve.py
}
host() { "$python" tools/bench/host.py; }
pictures() {
  local arguments=()
  option --scenes "${SCENES:-}"
  "$python" tools/bench/pictures.py "${arguments[@]}"
}
report() { "$python" tools/bench/report.py; }

case $part in
  --errors) set_up; errors; report ;;
  --quick) set_up; errors --quick; report ;;
  --compare) tools/setup/setup bpy; compare ;;
  --agreement) set_up; agreement; report ;;
  --animation) set_up; animation; report ;;
  --motion) set_up; motion; report ;;
  --speed) set_up blender; speed; report ;;
  --designs) set_up; designs ;;
  --suite) set_up; suite; report ;;
  --pictures) set_up; pictures; report ;;
  --host) set_up blender; host ;;
  --report) tools/setup/setup bpy; report ;;
  all) set_up blender; host; suite; speed; errors; animation; MODES= motion; pictures; agreement || differs=1; report; exit "${differs:-0}" ;;
  *) echo "bench.sh: unknown option $part" >&2; exit 1 ;;
esac
