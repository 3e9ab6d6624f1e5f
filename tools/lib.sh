# shellcheck shell=bash
# What the scripts in tools/ share. Sourcing it moves to the root of the repository.
set -euo pipefail
export LC_ALL=C.UTF-8
# shellcheck disable=SC2034  # for the scripts that take a path
caller_directory=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."

die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# microseconds: the clock, as a whole number
microseconds() { printf '%s' "${EPOCHREALTIME//[.,]/}"; }

# epoch: artefacts bear the time of the commit, so that who builds them again gets the same
epoch() { export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}; }

# licence_texts FOLDER: the texts to which the licences of Debian's packages refer by their place
licence_texts() {
  mkdir -p "$1"
  cp --dereference /usr/share/common-licenses/{LGPL-2.1,GPL-3,GPL-2,MPL-2.0,CC0-1.0} "$1/"
}

# step WHAT COMMAND...: one line when it goes well, with the time if that was more than a second; otherwise the end
# of what the command said, where the rest is, and the command's exit code.
step() {
  local what=$1 start log code tenths duration=''
  shift
  log=build/log/${what// /_}.log
  mkdir -p build/log
  printf '%-36s ' "$what"
  start=$(microseconds)
  # In a shell of its own, where the first command of a function that fails ends it; behind || none would.
  set +e
  (
    set -e
    "$@"
  ) >"$log" 2>&1
  code=$?
  set -e
  tenths=$((($(microseconds) - start) / 100000))
  if ((tenths > 10)); then duration=" ($((tenths / 10)).$((tenths % 10)) s)"; fi
  if ((code == 0)); then
    echo "done$duration"
    return
  fi
  echo "FAILED$duration"
  {
    echo "the last lines of $PWD/$log:"
    tail -n 30 "$log" | sed 's/^/  /'
  } >&2
  exit "$code"
}

# build PRESET [TARGET...]: configures and builds it, or only these targets
build() {
  local launcher=()
  if command -v ccache >/dev/null; then
    # Precompiled headers are read by their content, not by their time.
    export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
    launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  step "configuring $1" cmake --preset "$1" "${launcher[@]}"
  local targets=()
  if (($# > 1)); then targets=(--target "${@:2}"); fi
  step "building $1" cmake --build --preset "$1" --parallel "$(nproc)" "${targets[@]}"
}

# sources: every C++ file of the project, also those that are not committed yet
sources() {
  git ls-files --cached --others --exclude-standard -- '*.h' '*.cpp' | while read -r file; do
    if [[ -e $file ]]; then echo "$file"; fi
  done | sort -u
}
