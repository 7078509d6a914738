# The steps of ./demo and ./check. Sourced from the root of the tree with `steps` set to their number.
shopt -s nullglob

# step N NAME COMMAND...: one line for a step that went well, its whole output for one that did not.
step() {
  local number=$1 name=$2 log began
  shift 2
  log=$(mktemp)
  began=$SECONDS
  printf '[%s/%s] %s ' "$number" "$steps" "$name"
  # The command runs in a subshell of its own: inside a condition, bash would not stop at its first error.
  local status=0
  set +e
  (set -e; "$@") >"$log" 2>&1
  status=$?
  set -e
  if ((status != 0)); then
    echo "... FAILED"
    tail -n 200 "$log"
    rm -f "$log"
    exit 1
  fi
  local seconds=$((SECONDS - began))
  echo "... ok ($((seconds / 60)) min $((seconds % 60)) s)$(grep '^summary: ' "$log" | tail -n 1 | sed 's/^summary:/,/')"
  rm -f "$log"
}

# packages_of SECTION...: the names in these sections of packages.txt.
packages_of() {
  awk -v wanted=" $* " '
    { sub(/#.*/, "") }
    /^\[/ { section = $1; gsub(/[][]/, "", section); next }
    NF && index(wanted, " " section " ") { print $1 }' packages.txt
}

is_installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q 'install ok installed'; }

as_root() { if ((EUID == 0)); then "$@"; else sudo "$@"; fi; }

# install_packages SECTION...: what is missing of these sections. A package of the section `format` may be absent from
# this release of Debian.
install_packages() {
  local wanted missing=() package
  wanted=$(packages_of "$@")
  for package in $wanted; do
    is_installed "$package" || missing+=("$package")
  done
  if ((${#missing[@]} > 0)); then
    as_root apt-get update
    for package in $(packages_of format); do
      if [[ " ${missing[*]} " == *" $package "* ]] && ! apt-cache show "$package" >/dev/null 2>&1; then
        mapfile -t missing < <(printf '%s\n' "${missing[@]}" | grep -vx "$package")
        echo "$package is not in this release of Debian"
      fi
    done
  fi
  echo "summary: $(wc -w <<<"$wanted") packages, ${#missing[@]} installed now"
  ((${#missing[@]} == 0)) && return 0
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

configure() { cmake --preset "$1" "${@:2}"; }

# Users get the program alone; tests and benchmarks, and the packages that they need, are left to ./check. Both build in
# build/release with the same flags, so that the one goes on from what the other has built.
build_program() {
  configure release -DSINEW_BUILD_TESTS=OFF -DSINEW_BUILD_BENCHMARKS=OFF
  cmake --build --preset release --target sinew_program
}

build_everything() {
  configure release
  cmake --build --preset release
  refuse_warnings
}

# Warnings of the compiler stop ./check and nobody else. -Werror would be another command line for every file, so that
# ./demo and ./check would each build anew what the other has built; instead keep_warnings.sh leaves what the compiler
# said beside each object, of builds long ago as well, and here it counts.
refuse_warnings() {
  local object count=0
  while read -r object; do
    # Not those of files that are built no longer.
    ninja -C build/release -t targets all | grep -qF "$object:" || continue
    cat "build/release/$object.warnings"
    count=$((count + 1))
  done < <(cd build/release && find . -name '*.warnings' -printf '%P\n' | sed 's/\.warnings$//')
  ((count == 0)) && return 0
  echo "compiler warnings in $count files"
  return 1
}

run_preset() {
  configure "$1"
  cmake --build --preset "$1"
}

# run_tests PRESET: all its tests. Of each that failed the end of its output comes once more, after those of all others.
run_tests() {
  local status=0
  ctest --preset "$1" -j "$(nproc)" --output-on-failure || status=$?
  ((status == 0)) || print_failed_tests "build/$1/Testing/Temporary"
  return "$status"
}

# print_failed_tests FOLDER: from the logs that ctest leaves in FOLDER.
print_failed_tests() {
  local name
  while IFS=: read -r _ name; do
    echo "--- $name"
    awk -v name="$name" '
      index($0, " Test: ") && substr($0, index($0, ": ") + 2) == name { inside = 1; next }
      $0 == "<end of output>" { inside = 0 }
      inside' "$1/LastTest.log" | tail -n 40
  done <"$1/LastTestsFailed.log"
}

# The tests in which several threads work: those of the executor and of what is given to it, and commands with --threads 2.
run_thread_sanitizer() {
  configure tsan
  cmake --build --preset tsan
  run_tests tsan
}

# A few seconds for every reader: what a change has broken at once. tests/fuzz/README.md has the long runs.
run_fuzzers() {
  configure fuzz
  cmake --build --preset fuzz
  /usr/bin/python3 tests/fuzz/run.py --seconds 5
}

check_format() {
  local files
  if ! command -v clang-format-14 >/dev/null; then
    echo "summary: skipped, this release of Debian has no clang-format-14 (Debian 12 has)"
    return 0
  fi
  mapfile -t files < <(git ls-files '*.h' '*.cpp')
  clang-format-14 --dry-run --Werror "${files[@]}"
}

# What a user does who has sinew installed: find_package(sinew), a model of one's own, identify and diagnose it.
check_installed() {
  local prefix=$PWD/build/installed
  rm -rf "$prefix" build/outside
  cmake --install build/release --prefix "$prefix"
  cmake -S docs/examples/outside -B build/outside -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release
  cmake --build build/outside
  build/outside/pendulum
  build/outside/ball
  check_tank
  "$prefix/bin/sinew" list solvers
}

# The program that a user's model becomes finds the effect that is hidden in its data.
check_tank() {
  local tank=build/outside/tank data=build/outside/tank.h5
  /usr/bin/python3 docs/examples/outside/make_tank_data.py "$data"
  "$tank" list effects --data "$data" >build/outside/effects.txt
  "$tank" identify --data "$data" --out build/outside/run.h5 --quiet
  "$tank" diagnose --data "$data" --out build/outside/diagnosis.h5 --json build/outside/diagnosis.json --quiet
  /usr/bin/python3 - build/outside/diagnosis.json <<'PYTHON'
import json
import sys
with open(sys.argv[1]) as file:
    diagnosis = json.load(file)
causes = [cause["effect"] for cause in diagnosis["causes"]]
sys.exit(0 if causes == ["overflow"] else f"the tank overflows, but the diagnosis names {causes}")
PYTHON
  "$tank" simulate --data "$data" --from build/outside/run.h5 --out build/outside/simulated.h5
  "$tank" compare --data "$data" --solvers ceres,lm --repeats 2 --out build/outside/study.h5 --quiet
  "$tank" report build/outside/run.h5 build/outside/diagnosis.h5 --out-dir build/outside/report
}
