#!/usr/bin/env bash
# streaming_over_idle.sh PACK OUT [WALK]: what loading rooms costs the frames. The same walk twice: within a part of the
# pack's device memory, so that rooms come and go all the time, and, for comparison, once more through rooms that are all
# there already. The device (lavapipe, one thread) has one core to itself, as a GPU would, all else another. By hand:
#   probewalk on the PATH (or in BIN)
# Settings: SECONDS_LONG=120 BUDGET_PART=10 EYE=160x180; WALK: a path recorded on the pack (default: its tour);
# IDLE_SECONDS=SECONDS_LONG: only so much of the walk is compared, all of it is streamed
set -euo pipefail
pack=$(realpath "$1"); mkdir -p "$2"; out=$(realpath "$2"); walk=${3:+$(realpath "$3")}
seconds=${SECONDS_LONG:-120} part=${BUDGET_PART:-10} eye=${EYE:-160x180}
compared=${IDLE_SECONDS:-$seconds}
bin=${BIN:-$(dirname "$(command -v probewalk)")}
[ "$(nproc)" -ge 2 ] || { echo "this needs two cores" >&2; exit 1; }
export LP_NUM_THREADS=1

# NAME OPTION…: a walk on core 1 whose device's threads are moved to core 0 as they appear.
walk_apart() {
  local name=$1 task; shift
  rm -rf "$out/$name"
  taskset -c 1 "$bin/probewalk" walk "$pack" --display offscreen --realtime --eye-size "$eye" --report "$out/$name" \
    "$@" 2>"$out/$name.notes" & local pid=$!
  for _ in $(seq 100); do
    for task in /proc/$pid/task/*; do
      # Its workers, and those without a name of their own: its queue's thread is among them.
      if grep -qs '^llvmpipe\|^probewalk' "$task/comm" && [ "${task##*/}" != $pid ]; then
        taskset -cp 0 "${task##*/}" >/dev/null 2>&1 || true
      fi
    done
    sleep 0.1
    kill -0 $pid 2>/dev/null || break
  done
  wait $pid || { tail -n 5 "$out/$name.notes"; exit 1; }
}

# FILE FROM_S TO_S: frames between those seconds: number, then p50 and p99 of their milliseconds (as the report counts
# them), and p99 of those that the frame thread spends in streaming.
frames() {
  awk -F, -v from="$2" -v to="$3" '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    { if (!first) first = $at["begin_begin"] }
    { t = ($at["begin_begin"] - first) / 1e9 }
    $at["frame_ns"] > 0 && t >= from && t < to {
      print $at["frame_ns"] / 1e6, $at["streaming_ns"] / 1e6 }' "$1" >"$out/times"
  local n; n=$(wc -l <"$out/times")
  [ "$n" -gt 100 ] || { echo "only $n frames in $1" >&2; exit 1; }
  local p50 p99 streaming
  p50=$(cut -d' ' -f1 "$out/times" | sort -n | sed -n "$((n / 2))p")
  p99=$(cut -d' ' -f1 "$out/times" | sort -n | sed -n "$((n * 99 / 100))p")
  streaming=$(cut -d' ' -f2 "$out/times" | sort -n | sed -n "$((n * 99 / 100))p")
  echo "$n $p50 $p99 $streaming"
}

device_bytes=$("$bin/probewalk" info "$pack" --json | sed -n 's/^  "bytes_device": \([0-9]*\).*/\1/p' | sed -n 1p)
budget=$((device_bytes / part >> 20)); [ $budget -gt 0 ] || budget=1
# One recorded walk for both: first as it is, then twice over, where the second time all rooms are there.
if [ -z "$walk" ]; then
  walk=$out/walk.jsonl
  walk_apart record --seconds "$seconds" --device-budget $budget --record "$walk"
fi
length=$(tail -n 1 "$walk" | sed 's/.*"t_s": *\([0-9.]*\).*/\1/')
awk -v seconds="$compared" '
  { line = $0; match(line, /"t_s": *[0-9.eE+-]+/); t = substr(line, RSTART + 6, RLENGTH - 6) + 0
    if (t > seconds + 0) next
    lines[n] = line; times[n] = t; ++n; print line }
  END { for (k = 0; k < n; ++k) { line = lines[k]
    sub(/"t_s": *[0-9.eE+-]+/, "\"t_s\":" (times[k] + times[n - 1] + 0.02), line); print line } }' "$walk" >"$out/twice.jsonl"
shorter() { awk -v l="$length" -v s="$1" 'BEGIN { print (l < s ? l : s) }'; }
whole=$(shorter "$seconds") once=$(shorter "$compared")
walk_apart streaming --path "$walk" --seconds "$whole" --device-budget $budget
walk_apart idle --path "$out/twice.jsonl"

read -r wn w50 w99 wfr < <(frames "$out/streaming/frames.csv" 2 "$whole")
read -r n50 s50 s99 sfr < <(frames "$out/streaming/frames.csv" 2 "$once")
read -r i50n i50 i99 ifr < <(frames "$out/idle/frames.csv" "$once" 1e9)
echo "          frames   frame p50   frame p99   frame thread in streaming, p99"
printf 'whole     %6d %8.2f ms %8.2f ms %8.3f ms   (%s s of streaming)\n' "$wn" "$w50" "$w99" "$wfr" "$whole"
printf 'streaming %6d %8.2f ms %8.2f ms %8.3f ms   (its first %s s; %d of %d MiB)\n' "$n50" "$s50" "$s99" "$sfr" "$once" $budget $((device_bytes >> 20))
printf 'idle      %6d %8.2f ms %8.2f ms %8.3f ms   (all rooms there)\n' "$i50n" "$i50" "$i99" "$ifr"
awk -v a="$s50" -v b="$i50" -v c="$s99" -v d="$i99" 'BEGIN { printf "ratio            %8.2f    %8.2f\n", a / b, c / d }'
echo "levels loaded: $(grep -c '"name":"load\|"cat":"load' "$out/streaming/trace.json" || true) while streaming"
