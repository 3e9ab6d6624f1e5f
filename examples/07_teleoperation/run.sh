#!/usr/bin/env bash
# Is a teleoperator stable with every hand, and what does it buy to have measured one?
#   usage: run.sh [FOLDER]    where the files go; without it a new temporary folder
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or named by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"
here=$(dirname "${BASH_SOURCE[0]}")
design=$here/../teleop/position_position.toml

# 1. Two robots whose controllers pull them together. Llewellyn's criterion, decided exactly and for every frequency:
#    stable with every passive hand and every passive environment, or not.
"$mbk" teleop "$design" --quiet | sed '/First condition/,$d'

# 2. Which stiffness of the slave's controller [N/m] keeps it so? An interval with two ends: too soft fails as well.
"$mbk" teleop "$design" --parameter slave.k=0:1000 --json --overwrite --quiet --out "$out/any_hand.json"
"$mbk" teleop "$design" --parameter slave.k=0:1000 --quiet | grep -A 1 'absolutely stable for'

# 3. A hand that was measured is more than passive: at every frequency it takes at least as much energy as a damper of
#    δ N·s/m does (excess of passivity). Its 95 % lower bound counts here.
"$mbk" simulate relaxed_sinusoidal --overwrite --quiet --out "$out/hand.h5"
"$mbk" measure --handle-mass 0.194 --json --overwrite --quiet --out "$out/hand.json" "$out/hand.h5"

# 4. The modified criterion with that hand: the admissible stiffness reaches further on both sides, which is what makes
#    a teleoperator feel crisper without giving up the proof.
"$mbk" teleop "$design" --operator "$out/hand.json" --parameter slave.k=0:1000 --quiet |
  grep -A 1 -E 'With the operator|with that operator for'
"$mbk" teleop "$design" --operator "$out/hand.json" --parameter slave.k=0:1000 --json --overwrite --quiet \
  --out "$out/this_hand.json"
echo "results: $out"
