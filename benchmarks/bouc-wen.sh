#!/bin/sh
# The Bouc-Wen benchmark of nonlinearbenchmark.org on its official signals:
#
#     benchmarks/bouc-wen.sh FOLDER
#
# FOLDER has bw_train.h5 (group multisine: u in N and y in m, five periods of 8192 rows at 750 Hz) and bw_test.h5 (groups
# multisine, one period of the steady state, and sinesweep, 153,000 rows from rest). Needs hysid.
set -eu
folder=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The rows with time, and the period of the multisine once before the scored one: the test is in steady state.
hysid -q look "$folder/bw_train.h5" -o train.rows.csv >train.txt
hysid -q look "$folder/bw_test.h5" -o test.rows.csv >test.txt
awk -F, 'NR == 1 { print "t_s,force_N,displacement_m"; next } { printf "%.9f,%s,%s\n", (NR - 2) / 750, $1, $2 }' \
    train.rows.csv >train.csv
awk -F, '
    BEGIN { n = 0; k = 0 }
    NR == 1 { print "record,t_s,force_N,displacement_m"; next }
    $1 == "multisine" { u[n] = $2; y[n++] = $3; next }
    { printf "sinesweep,%.9f,%s,%s\n", (k++) / 750, $2, $3 }
    END {
        for (i = 0; i < 2 * n; i++) printf "multisine,%.9f,%s,%s\n", i / 750, u[i % n], i < n ? "" : y[i - n]
    }' test.rows.csv >both.csv
for record in multisine sinesweep; do
    { head -1 both.csv; grep "^$record," both.csv; } | cut -d, -f2- >"$record.csv"
done

hysid --version
hysid -q fit train.csv --output displacement_m -o model.json --no-report >fit.txt
for record in multisine sinesweep; do
    hysid -q evaluate model.json "$record.csv" --json >"$record.json"
    printf '%s: %.3g m\n' "$record" "$(grep -o '"rmse": *[-0-9.e]*' "$record.json" | head -1 | cut -d: -f2)"
done
