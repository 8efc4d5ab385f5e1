#!/bin/sh
# Instructions and bytes of a step of exported models on a Cortex-M4 and a Cortex-M7, counted by an emulator.
# Needs hysid, arm-none-eabi-gcc with newlib (gcc-arm-none-eabi, libnewlib-arm-none-eabi) and qemu-system-arm.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

hysid -q generate rate-dependent-actuator -o actuator.csv
for model in pnn prandtl-ishlinskii preisach xpnn+ duhem-nn; do
    case $model in
    pnn | xpnn+) quick="--starts 1 --epochs 20" ;;
    *) quick= ;;
    esac
    # shellcheck disable=SC2086
    hysid -q fit actuator.csv --model "$model" $quick -o fitted.json --no-report --force >fit.txt
    for precision in f32 f64; do
        hysid -q export fitted.json --to c --precision "$precision" -o code --name model --force
        timed=
        if grep -q "time_step);" code/model.h; then timed=-DTIMED; fi
        for processor in \
            "cortex-m4 fpv4-sp-d16 mps2-an386" \
            "cortex-m7 fpv5-d16 mps2-an500"; do
            # shellcheck disable=SC2086
            set -- $processor
            # shellcheck disable=SC2086
            arm-none-eabi-gcc -O2 -std=gnu99 -ffp-contract=off -mthumb -mcpu="$1" -mfpu="$2" -mfloat-abi=hard \
                -nostartfiles --specs=nosys.specs -Wl,-T"$here/link.ld" -Icode $timed "$here/count.c" code/model.c \
                -o model.elf -lm 2>linker.txt || { cat linker.txt >&2; exit 1; }
            printf '%s %s %s: ' "$model" "$precision" "$1"
            qemu-system-arm -M "$3" -nographic -semihosting-config enable=on,target=native -icount shift=0 \
                -kernel model.elf
        done
    done
done
