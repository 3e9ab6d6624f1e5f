#!/usr/bin/env bash
# One signal from another: a transfer function, and the impedance behind it.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. An ankle on a one-axis machine. Its reflex is switched off, because it makes the joint nonlinear.
"$mbk" simulate --show ankle_reflex | sed 's/^gain_Nms.*/gain_Nms_per_rad = 0/' > "$out/ankle.toml"
"$mbk" simulate "$out/ankle.toml" --overwrite --quiet --out "$out/ankle.h5"
"$mbk" info "$out/ankle.h5" | grep -E 'truth_[MBK] '

# 2. An impedance has more zeros than poles, which a continuous-time model cannot have; its inverse can. So fit from the
#    torque on the limb (minus the reaction, N·m) to its position (rad), two poles and no zero, and invert it. The machine
#    holds the limb in a closed loop, so its reference is the instrument (clsrivc). M [kg·m²], B [N·m·s/rad], K [N·m/rad].
"$mbk" tf "$out/ankle.h5" --input=-F --output x --reference xr --method clsrivc --poles 2 --zeros 0 --invert position

# 3. Select the model order: a table of orders and the one that the data support, here from the servo reference to the
#    position, without feedback.
"$mbk" tf "$out/ankle.h5" --input xr --output x --orders 1:4 | sed -n '1,22p'

"$mbk" tf "$out/ankle.h5" --input=-F --output x --reference xr --method clsrivc --poles 2 --zeros 0 --invert position \
  --json --overwrite --quiet --out "$out/ankle.json"
echo "result: $out"
