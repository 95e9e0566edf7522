#!/usr/bin/env bash
# Sets up, builds and runs tests. usage: test.sh [--full] all | native | addon
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case " $* " in
  *" native "*) tools/setup/setup build ;;
  *) tools/setup/setup test ;;
esac
tools/build.sh tests
case " $* " in
  *" addon "*) ;;
  *" --full "*) tools/build.sh sanitizers ;;
esac
exec /usr/bin/python3 tools/test.py "$@"
