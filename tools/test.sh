#!/usr/bin/env bash
# Sets up, builds and runs tests. usage: test.sh [--full] all | native | addon, or test.sh regression | stress
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case " $* " in
  *" native "* | *" regression "* | *" stress "*) tools/setup/setup build ;;
  *) tools/setup/setup test ;;
esac
tools/build.sh tests
case " $* " in
  *" --full all "* | *" --full native "*) tools/setup/setup full; tools/build.sh checks --full ;;
  *" all "*) tools/build.sh checks ;;
esac
case " $* " in
  *" regression "*) exec build/tests/gradus_regression_tests --gtest_brief=1 ;;
  *" stress "*) GRADUS_TEST_FULL=1 exec build/tests/gradus_stress_tests --gtest_brief=1 ;;
esac
exec /usr/bin/python3 tools/test.py "$@"
