#!/usr/bin/env bash
# Builds everything with clang++, warnings as errors, and runs the tests of that build.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/build clang
build/clang/tests/gnomon_tests "~[.]" &
tests=$!
build/clang/tests/gnomon_studies_tests "~[.]~[cli]"
wait "$tests"
