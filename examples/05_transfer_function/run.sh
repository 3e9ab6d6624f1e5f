#!/usr/bin/env bash
# One signal from another: a transfer function, and the impedance behind it.
#   usage: run.sh [FOLDER]    where the files go; without it a new temporary folder
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or named by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. An ankle on a machine of one axis. Its reflex is switched off, since with it the joint is not linear.
"$mbk" simulate --show ankle_reflex | sed 's/^gain_Nms.*/gain_Nms_per_rad = 0/' > "$out/ankle.toml"
"$mbk" simulate "$out/ankle.toml" --overwrite --quiet --out "$out/ankle.h5"
"$mbk" info "$out/ankle.h5" | grep -E 'truth_[MBK] '

# 2. An impedance has more zeros than poles, which no model in continuous time can; its inverse can. So: from the torque
#    on the limb (minus the reaction, N·m) to where it moves (rad), two poles and no zero, and turned round. The machine
#    holds the limb, which is a loop: its reference is the instrument (clsrivc). M [kg·m²], B [N·m·s/rad], K [N·m/rad].
"$mbk" tf "$out/ankle.h5" --input=-F --output x --reference xr --method clsrivc --poles 2 --zeros 0 --invert position

# 3. How many poles does a signal need? A table of orders, and the one that the data support: here from the reference
#    of the servo to the position, where nothing acts back.
"$mbk" tf "$out/ankle.h5" --input xr --output x --orders 1:4 | sed -n '1,22p'

"$mbk" tf "$out/ankle.h5" --input=-F --output x --reference xr --method clsrivc --poles 2 --zeros 0 --invert position \
  --json --overwrite --quiet --out "$out/ankle.json"
echo "result: $out"
