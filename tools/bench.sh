#!/usr/bin/env bash
# Runs a part of the benchmark and writes the report. Everything goes to out/bench.
#
# usage: bench.sh all | errors | quick | agreement | pictures | speed | rooms | paths | profiles | reconstruct |
#                 animation | motion | host | designs | animated-designs | compare | report
#
# Variables of the environment limit a part; `make help` says which part reads which:
#   SCENES=a,b  MODES=path,auto  REFERENCE=1024  SEEDS=5  SAMPLES=4,16,64  MINUTES=60  WIDTH=160
#   SIZE=320x180  FRAMES=24  BLUR=1  CHECKED=8 (frames that have a reference)  QUICK=1 (two animations)
#   MEASURES=truth,flicker  REPEATS=3  LOADED=1 (the machine has other work)
#   NAME=kitchen  STORES=a,b  REFERENCES=a,b  CROP=60,60,160,90  DESIGNS=svgf,nfor-frames
#   ROOMS=room-1k  SPEED_WIDTH=640  OLD=commit  NEW=commit
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
part=${1:?which part? see the head of tools/bench.sh}

set_up() {
  tools/setup/setup build bpy "$@"
  tools/setup/setup bench || echo "bench: Mitsuba cannot be installed here and is left out" >&2
  tools/build.sh
}

# Runs a script with an option for each named variable that is set, as in:
# run script.py [--flag] scenes modes width=SPEED_WIDTH
run() {
  local script=$1 arguments=() name variable
  shift
  for name in "$@"; do
    if [[ $name == --* ]]; then
      arguments+=("$name")
      continue
    fi
    variable=${name#*=}
    variable=${variable^^}
    [ -z "${!variable:-}" ] || arguments+=("--${name%%=*}" "${!variable}")
  done
  .venv/bpy45/bin/python3 "tools/bench/$script" "${arguments[@]}"
}

limits=(scenes modes reference seeds samples minutes)
errors() { run stills.py "${limits[@]}" width "$@"; }
agreement() { run agreement.py scenes width samples=REFERENCE; }
pictures() { run pictures.py scenes; }
paths() { run path_tracing.py scenes width=SPEED_WIDTH minutes; }
profiles() { run profiles.py scenes width=SPEED_WIDTH minutes; }
rooms() {
  run speed.py rooms width=SPEED_WIDTH repeats minutes
  run speed.py rooms repeats --starts
}
reconstruct() { run reconstruction_time.py repeats; }
animation() { run animation.py "${limits[@]}" size frames checked ${BLUR:+--blur} ${QUICK:+--quick}; }
motion() { run motion.py "${limits[@]}" size frames measures repeats ${BLUR:+--blur} ${LOADED:+--loaded}; }
without_errors() {
  rooms
  reconstruct
  paths
  profiles
}
speed() {
  without_errors
  SAMPLES=${SAMPLES:-4,8,16,64} \
    MODES=${MODES:-path,path-regularized,gradient-regularized,auto,auto-denoised,cycles,cycles-denoised} errors
}
report() { run report.py; }

case $part in
  all)
    set_up blender
    run host.py
    without_errors
    errors
    animation
    MODES='' motion # it has modes of its own
    pictures
    agreement || differs=1
    report
    exit "${differs:-0}"
    ;;
  errors | agreement | pictures | speed | rooms | paths | profiles | reconstruct | animation | motion)
    set_up
    "$part"
    report
    ;;
  quick) set_up; errors --quick; report ;;
  host) set_up blender; run host.py; report ;;
  animated-designs)
    OPENBLAS_NUM_THREADS=1 run compare_animated_designs.py name stores references frames crop designs
    ;;
  designs) set_up; OPENBLAS_NUM_THREADS=1 run compare_designs.py scenes width reference ;;
  compare)
    .venv/bpy45/bin/python3 tools/bench/compare.py "${OLD:?which commit?}" "${NEW:?which commit?}" \
      ${WIDTH:+--width "$WIDTH"}
    ;;
  report) tools/setup/setup bpy; report ;;
  *) echo "bench.sh: unknown part $part; see its head" >&2; exit 1 ;;
esac
