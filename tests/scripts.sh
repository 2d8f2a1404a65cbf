#!/usr/bin/env bash
# scripts.sh: what stands in bench/ and script/ says what it does when asked for help, and refuses what it does not know,
# before anything is done.
set -uo pipefail
cd "$(dirname "$0")/.."
root=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

# In a system where nothing can be installed, built or downloaded.
mkdir bin
for program in cmake ninja apt-get sudo pip npm node; do
  printf '#!/bin/sh\necho "%s was run" >&2\nexit 1\n' "$program" >bin/$program && chmod +x bin/$program
done
export PATH="$work/bin:$PATH"

count=0
for script in "$root"/bench/* "$root"/bench/peers/run "$root"/script/*; do
  [ -f "$script" ] || continue
  if [ ! -x "$script" ]; then
    grep -q '^# Sourced' "$script" || fail "$script cannot be run"
    continue
  fi
  count=$((count + 1))
  for option in -h --help; do
    timeout 10 "$script" $option >out.txt 2>err.txt </dev/null || fail "$script $option: exit code $?: $(head -c 300 err.txt)"
    [ ! -s err.txt ] && [ "$(wc -l <out.txt)" -ge 3 ] || fail "$script $option says: $(cat out.txt err.txt)"
    grep -q "${script##*/}" out.txt || fail "$script $option: no example: $(cat out.txt)"
  done
  [ "${script##*/}" = test_python ] && continue  # its options are pytest's
  timeout 10 "$script" --no-such-option x >out.txt 2>err.txt </dev/null
  [ $? -eq 2 ] && [ ! -s out.txt ] && grep -q -- "--no-such-option" err.txt && ! grep -q "was run" err.txt ||
    fail "$script --no-such-option: $(cat out.txt err.txt)"
done
[ "$count" -ge 15 ] || fail "$count scripts were found"
[ "$(ls | sort | tr '\n' ' ')" = "bin err.txt out.txt " ] || fail "something was written: $(ls)"

for script in bench/chapter6\ out bench/left_out bench/protocols script/demo script/test; do
  "$root"/$script "$work/nowhere/data" >out.txt 2>err.txt
  [ $? -eq 2 ] && [ "$(cat err.txt)" = "$work/nowhere/data: no such folder" ] || fail "$script without its data: $(cat err.txt)"
done

echo "$count scripts, $failures failed"
[ $failures -eq 0 ]
