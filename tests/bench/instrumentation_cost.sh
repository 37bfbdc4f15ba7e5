#!/usr/bin/env bash
# instrumentation_cost.sh PACK OUT: what ledger, overlay, mirror and spectator's view cost a walk: the same short walk with
# and without each, in pairs (off on, on off, off on, ...), so that what drifts falls on both alike. Prints the median over
# the pairs of on/off, and its quartiles, for the time from frame to frame and for the processor time of a frame (all the
# process's threads, a software device's included); OUT/cost.json says the same. The spectator's row has eyes of 480x540:
# together as many pixels as the view that it adds. About seven minutes. By hand:
#   probewalk on the PATH (or in BIN), Monado and Xvfb installed
# Settings: PAIRS=6 LEDGER_PAIRS=60 FRAMES=120 EYE=160x180 ROWS="ledger window-overlay headset-overlay mirror spectator"
set -euo pipefail
pack=$(realpath "$1"); mkdir -p "$2"; out=$(realpath "$2")
pairs=${PAIRS:-6} ledger_pairs=${LEDGER_PAIRS:-60} frames=${FRAMES:-120} eye=${EYE:-160x180}
rows=${ROWS:-ledger window-overlay headset-overlay mirror spectator}
bin=${BIN:-$(dirname "$(command -v probewalk)")}
with_monado=$(dirname "$(realpath "$0")")/../../tools/lib/with-monado.sh
export pack out pairs frames eye bin
export XDG_CONFIG_HOME=$out/config  # nobody's remembered settings
rm -f "$out"/*.pairs "$out"/*.row
load_before=$(cut -d' ' -f1 /proc/loadavg)

# MUST_SHOW OPTION…: one walk along the path; prints the mean milliseconds from frame to frame and of processor time. What
# the ledger asks after a frame goes to OUT/questions.
walk_once() {
  local must_show=$1; shift
  rm -rf "$out/run"
  "$bin/probewalk" walk "$pack" --path "$out/walk.jsonl" --frames "$frames" --eye-size "$eye" \
    --report "$out/run" --quiet "$@" 2>"$out/notes" || { cat "$out/notes" >&2; return 1; }
  awk -F, -v must_show="$must_show" -v questions="$out/questions" '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["warmup"] == 0 {
      if (!n++) { wait = $at["wait_end"]; cpu = $at["process_cpu_ns"] }
      last_wait = $at["wait_end"]; last_cpu = $at["process_cpu_ns"]; shown += $at["mirror_presented"]
      if ($at["ledger_end"] > 0) print ($at["ledger_end"] - $at["ledger_begin"]) / 1e3 >>questions
    }
    END {
      if (n < 20) { print "only " n + 0 " frames beyond the warm-up" >"/dev/stderr"; exit 1 }
      if (must_show == "mirror" && !shown) { print "the mirror showed nothing" >"/dev/stderr"; exit 1 }
      printf "%.6f %.6f\n", (last_wait - wait) / 1e6 / (n - 1), (last_cpu - cpu) / 1e6 / (n - 1)
    }' "$out/run/frames.csv"
}

# NAME MUST_SHOW "OPTIONS OFF" "OPTIONS ON" OPTION…
walk_pairs() {
  local name=$1 must_show=$2 off=$3 on=$4 pair without with; shift 4
  : >"$out/questions"
  for ((pair = 1; pair <= pairs; ++pair)); do
    # Split on purpose: they are several words, or none.
    ((pair % 2)) || with=$(walk_once "$must_show" $on "$@")
    without=$(walk_once none $off "$@")
    ((pair % 2 == 0)) || with=$(walk_once "$must_show" $on "$@")
    echo "$without $with" >>"$out/$name.pairs"
  done
  cp "$out/questions" "$out/$name.questions"
}
export -f walk_once walk_pairs

# FILE: the median and the quartiles of its lines, which are numbers.
quartiles() {
  sort -g "$1" | awk '{ v[NR] = $1 } END { for (q = 1; q <= 3; ++q) {
    at = 1 + (NR - 1) * q / 4; low = int(at); high = low < NR ? low + 1 : low
    r[q] = v[low] + (at - low) * (v[high] - v[low]) } print r[2], r[1], r[3] }'
}

# NAME COUNT, then median, low and high of both ratios, then what the frame took without and with, in ms.
row() {
  printf '%-16s %6d  %7.4f (%.4f to %.4f)  %7.4f (%.4f to %.4f)  %8s %8s  %8s %8s\n' "$@"
  local name=$1 count=$2 fm=$3 fl=$4 fh=$5 cm=$6 cl=$7 ch=$8
  printf '{"what": "%s", "pairs": %d, "frame_time": {"ratio": %s, "low": %s, "high": %s}, "cpu_time": {"ratio": %s, "low": %s, "high": %s}, "frame_ms_off": %s, "frame_ms_on": %s, "cpu_ms_off": %s, "cpu_ms_on": %s}\n' \
    "$name" "$count" "$fm" "$fl" "$fh" "$cm" "$cl" "$ch" "$(or_null "$9")" "$(or_null "${10}")" "$(or_null "${11}")" \
    "$(or_null "${12}")" >"$out/$name.row"
}
or_null() { if [ "$1" = - ]; then echo null; else echo "$1"; fi; }

row_of_pairs() {
  local name=$1 frame cpu k ms=()
  awk '{ print $3 / $1 }' "$out/$name.pairs" >"$out/ratios"; frame=$(quartiles "$out/ratios")
  awk '{ print $4 / $2 }' "$out/$name.pairs" >"$out/ratios"; cpu=$(quartiles "$out/ratios")
  for k in 1 3 2 4; do
    cut -d' ' -f$k "$out/$name.pairs" >"$out/ratios"; ms+=("$(quartiles "$out/ratios" | awk '{ printf "%.3f", $1 }')")
  done
  row "$name" "$(wc -l <"$out/$name.pairs")" $frame $cpu "${ms[@]}"
}

# Offscreen, in blocks of 16 frames of one process: `walk --ledger-cost`, which prints what it adds in per cent.
ledger() {
  "$bin/probewalk" walk "$pack" --display offscreen --frames 30 --eye-size "$eye" --ledger-cost "$ledger_pairs" \
    --report "$out/run" >/dev/null 2>"$out/notes" || { cat "$out/notes" >&2; return 1; }
  local numbers
  numbers=$(sed -n 's/.*ledger.s cost.* \([0-9]*\) pairs: \([-+0-9.]*\) % (quartiles \([-+0-9.]*\) to \([-+0-9.]*\) %) of frame time, \([-+0-9.]*\) % (quartiles \([-+0-9.]*\) to \([-+0-9.]*\) %).*/\1 \2 \3 \4 \5 \6 \7/p' "$out/notes" |
    awk '{ printf "%d", $1; for (k = 2; k <= 7; ++k) printf " %.5f", 1 + $k / 100 }')
  [ -n "$numbers" ] || { echo "no cost in the notes:" >&2; cat "$out/notes" >&2; return 1; }
  row ledger $numbers - - - -
}

window-overlay() {
  Xvfb -displayfd 3 -noreset -screen 0 1280x1024x24 -nolisten tcp 3>"$out/display" >/dev/null 2>&1 & local screen=$!
  for _ in $(seq 100); do [ -s "$out/display" ] && break; sleep 0.1; done
  local status=0
  env -u WAYLAND_DISPLAY DISPLAY=":$(cat "$out/display")" bash -euo pipefail -c \
    'walk_pairs window-overlay none "" --overlay --display window --mirror left' || status=$?
  kill $screen
  return $status
}
headset-overlay() {
  env -u DISPLAY -u WAYLAND_DISPLAY bash "$with_monado" null bash -euo pipefail -c \
    'walk_pairs headset-overlay none "" --headset-overlay --display headset --mirror off --eye-scale 1'
}
mirror() {
  bash "$with_monado" xvfb bash -euo pipefail -c \
    'walk_pairs mirror mirror "--mirror off" "--mirror left" --display headset --eye-scale 1'
}
spectator() {
  bash "$with_monado" xvfb bash -euo pipefail -c \
    'eye=480x540 frames=$((frames / 2))
    walk_pairs spectator mirror "--mirror off" "--mirror spectator" --display headset --eye-scale 1'
}

# The beginning of the tour at a walker's pace, which every walk below plays.
"$bin/probewalk" walk "$pack" --display offscreen --realtime --seconds 10 --eye-size 16x16 \
  --record "$out/walk.jsonl" --quiet 2>"$out/notes" || { cat "$out/notes" >&2; exit 1; }
echo "                          on / off: median (quartiles) of                           ms without, with"
echo "what             pairs  frame time                   processor time               frame              processor"
for name in $rows; do
  $name
  [ ! -s "$out/$name.pairs" ] || row_of_pairs "$name"
done

for name in $rows; do
  [ -s "$out/$name.questions" ] || continue
  read -r p50 _ p75 < <(quartiles "$out/$name.questions")
  echo "the ledger's questions after a frame ($name): median $p50 us, upper quartile $p75 us"
done
json_value() { sed -n "s/^ *\"$1\": *\(.*[^,]\),*\$/\1/p" "$out/run/summary.json" | sed -n 1p; }
{
  printf '{\n"pack": "%s", "eye_size": "%s", "frames_a_walk": %s, "load_before": %s,\n' "$(basename "$pack")" "$eye" \
    "$frames" "$load_before"
  printf '"cpu": %s, "cores": %s, "kernel": %s, "device": %s,\n"rows": [\n' "$(json_value cpu)" "$(json_value cores)" \
    "$(json_value kernel)" "$(json_value name)"
  first=yes
  for name in $rows; do
    [ $first = yes ] || echo ,
    first=no
    printf '  %s' "$(cat "$out/$name.row")"
  done
  printf '\n]\n}\n'
} >"$out/cost.json"
echo "machine: $(json_value cpu), $(json_value cores) cores, $(json_value name); load before $load_before; $out/cost.json"
