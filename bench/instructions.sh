#!/bin/bash
# Counts umbra4's instructions with valgrind: a regression shows on a machine whose times are noise.
#
#   bench/instructions.sh            prints the table
#   bench/instructions.sh --record   also writes it to bench/instructions.md
#   bench/instructions.sh --check    fails where a count is more than 3 % above the recorded one
#
# Scenes are looked for in target/scenes, or in $UMBRA4_SCENES (bench/fetch-scenes.sh fetches them). Where valgrind or AVX2 is
# missing nothing is counted, and that is said; with UMBRA4_VALGRIND=required it is an error.
# valgrind does not report AVX-512, so that it is the AVX2 kernels that are counted, on any machine that has AVX2.
set -euo pipefail

mode=${1:-}
case $mode in
"" | --record | --check) ;;
*)
    echo "usage: $0 [--record | --check]" >&2
    exit 2
    ;;
esac

directory=$(cd "$(dirname "$0")" && pwd)
record=$directory/instructions.md
target=${CARGO_TARGET_DIR:-$directory/../target}
scenes=${UMBRA4_SCENES:-$target/scenes}
size=192
most=1.03

without() { # REASON
    if [ "${UMBRA4_VALGRIND:-}" = required ]; then
        echo "instructions cannot be counted, and UMBRA4_VALGRIND=required: $1" >&2
        exit 1
    fi
    echo "SKIPPED: instructions are not counted: $1"
    exit 0
}
command -v valgrind >/dev/null || without "valgrind is missing"
grep -qw avx2 /proc/cpuinfo 2>/dev/null || without "the processor has no AVX2"

(cd "$directory/.." && cargo build --locked --quiet --release --package umbra4-bench)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

count() { # SCENE SAMPLES CONTENDER: a line of the table
    local own=$scratch/$1-$2-$3
    if ! valgrind --tool=callgrind --toggle-collect='*measured_section*' --callgrind-out-file=/dev/null \
        "$target/release/umbra4-bench" compare --single-run --scenes "$scenes" --scene "$1" --size "$size" \
        --samples "$2" --contenders "$3" >"$own.out" 2>"$own.err"; then
        cat "$own.out" "$own.err" >&2
        return 1
    fi
    local instructions receivers
    instructions=$(sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$own.err")
    receivers=$(sed -n 's/.*; \([0-9]*\) receivers of .*/\1/p' "$own.out")
    if [ -z "$instructions" ] || [ -z "$receivers" ]; then
        echo "no count in the output of valgrind, or no receivers in that of the benchmark" >&2
        cat "$own.out" "$own.err" >&2
        return 1
    fi
    echo "| $1 | $2² | $3 | $receivers | $((instructions / receivers)) |" >"$own.line"
}

table=$scratch/table
{
    echo "| scene | samples | contender | receivers | instructions a receiver |"
    echo "|---|--:|---|--:|--:|"
} | tee "$table"
counting=() lines=()
# One thread each, and counts do not mind who else is running: as many at once as there are processors.
for scene in dragon48k sponza; do
    for samples in 8 32 64; do
        for contender in umbra4 umbra4-fast; do
            if [ ${#counting[@]} -ge "$(nproc)" ]; then
                wait "${counting[0]}"
                counting=("${counting[@]:1}")
            fi
            count "$scene" "$samples" "$contender" &
            counting+=($!)
            lines+=("$scratch/$scene-$samples-$contender.line")
        done
    done
done
for job in "${counting[@]}"; do wait "$job"; done
cat "${lines[@]}" | tee -a "$table"

case $mode in
--record)
    {
        echo "# Instructions"
        echo
        echo "Counted by \`bench/instructions.sh --record\` with $(valgrind --version), and compared with by"
        echo "\`bench/instructions.sh --check\`. Code of $(rustc --version | cut -d' ' -f1,2), AVX2 kernels, ${size}×${size} image, one"
        echo "thread; snap, index and masks together. Another compiler may give other counts: record them anew with it."
        echo
        cat "$table"
    } >"$record"
    ;;
--check)
    # Fields of a table's line: 2 scene, 3 samples, 4 contender, 5 receivers, 6 instructions a receiver.
    awk -F ' *[|] *' -v most="$most" '
        !/²/ { next }
        { key = $2 ", " $3 ", " $4 }
        NR == FNR { count[key] = $6; receivers[key] = $5; next }
        !(key in count) { print key ": nothing is recorded"; bad = 1; next }
        { compared++ }
        receivers[key] != $5 { print key ": " $5 " receivers, recorded were " receivers[key]; bad = 1; next }
        $6 > most * count[key] { print key ": " $6 " instructions a receiver, recorded were " count[key]; bad = 1 }
        $6 * most < count[key] { print key ": " $6 " instructions a receiver, fewer than the " count[key] " recorded; record them" }
        END {
            for (key in count) recorded++
            if (compared != recorded || !compared) { print compared + 0 " of " recorded + 0 " recorded counts compared"; bad = 1 }
            exit bad
        }
    ' "$record" "$table"
    echo "no count is more than 3 % above the recorded one"
    ;;
esac
