#!/usr/bin/env bash
# Is a teleoperator stable with every hand, and what is gained by measuring one?
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"
here=$(dirname "${BASH_SOURCE[0]}")
design=$here/../teleop/position_position.toml

# 1. Two robots coupled by their controllers. Llewellyn's criterion, decided exactly for every frequency: stable with
#    every passive hand and every passive environment, or not.
"$mbk" teleop "$design" --quiet | sed '/First condition/,$d'

# 2. Which stiffness of the slave controller [N/m] is stable? An interval with two ends: too soft also fails.
"$mbk" teleop "$design" --parameter slave.k=0:1000 --json --overwrite --quiet --out "$out/any_hand.json"
"$mbk" teleop "$design" --parameter slave.k=0:1000 --quiet | grep -A 1 'absolutely stable for'

# 3. A measured hand is more than passive: at every frequency it absorbs at least as much energy as a damper of δ N·s/m
#    (excess of passivity). The 95 % lower bound is used here.
"$mbk" simulate relaxed_sinusoidal --overwrite --quiet --out "$out/hand.h5"
"$mbk" measure --handle-mass 0.194 --json --overwrite --quiet --out "$out/hand.json" "$out/hand.h5"

# 4. The modified criterion with that hand: the admissible stiffness range grows at both ends, so the teleoperator can be
#    stiffer and remain provably stable.
"$mbk" teleop "$design" --operator "$out/hand.json" --parameter slave.k=0:1000 --quiet |
  grep -A 1 -E 'With the operator|with that operator for'
"$mbk" teleop "$design" --operator "$out/hand.json" --parameter slave.k=0:1000 --json --overwrite --quiet \
  --out "$out/this_hand.json"
echo "results: $out"
