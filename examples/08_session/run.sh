#!/usr/bin/env bash
# A session at 1 kHz: check the plan, run it behind the safety gate, measure the recording.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. An experiment is a scenario with limits. This one is twenty seconds of sines on the simulated robot.
cat > "$out/short.toml" <<'TOML'
[recording]
condition = "relaxed, twenty seconds of sines"
rate_hz = 1000
seed = 1

[person]
number = 7                                 # a number, never a name

[robot]
home_mm = [300, -50]
handle_mass_kg = 0.194

[control]
kind = "position"

[perturbation]
kind = "multisine"
peak_deg = 2
period_s = 5
harmonics = [1, 3, 5, 7, 9, 11, 13]
duration_s = 20
moving_in_s = 2

[participant]                              # replace with [device] for your own robot and a real person
kind = "arm"
number = 1
shoulder_mm = [300, -570]

[safety]                                   # the gate: missing keys have the defaults that `mbk run --dry-run` shows
handle_force_N = 20
measured_force_N = 40
excursion_mm = 80
TOML

# 2. Before the participant sits down: duration [s], peaks, and a rehearsal compared with each limit. Nothing moves.
"$mbk" run "$out/short.toml" --dry-run

# 3. Run it. --fast uses a virtual clock and runs as fast as the computer can; without it the trial takes 25 s.
rm -f "$out/p07.h5"
"$mbk" run "$out/short.toml" --fast --no-console --quiet --out "$out/p07.h5"

# 4. The recording states how the trial ended. A new measurement uses only the perturbation, not the move to the start.
"$mbk" info "$out/p07.h5" | grep -E 'ended|samples|rate '
"$mbk" measure --handle-mass 0.194 --json --overwrite --quiet --out "$out/p07.json" "$out/p07.h5"
echo "recording and result: $out"
