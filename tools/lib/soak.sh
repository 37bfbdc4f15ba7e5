#!/usr/bin/env bash
# What tools/soak does, on the platform itself. usage: soak.sh PROBEWALK MINUTES KILLS none|xvfb none|HANDS DIR
# PACK [WALK OPTION…]     HANDS: a program that moves the hands of Monado's remote devices, given their port
set -uo pipefail
probewalk=$1 minutes=$2 kills=$3 display=$4 hands=$5 out=$6; shift 6
lib=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$out" || exit 125
rm -rf walk.log monado.log openxr.txt report display hands config walked.jsonl
fail() { echo "probewalk: $1" >&2; exit 125; }
layers=/usr/share/openxr/1/api_layers/explicit.d
ls $layers/*core_validation* >/dev/null 2>&1 || fail "install openxr-layer-corevalidation"
source "$lib/monado-service.sh"
export XDG_RUNTIME_DIR=$runtime_dir XR_RUNTIME_JSON=$manifest
service='' walk='' screen='' mover=''
stop() {
  for process in $walk $mover $service $screen; do kill "$process" 2>/dev/null; done
  rm -rf "$XDG_RUNTIME_DIR"
}
trap stop EXIT
trap 'exit 130' INT TERM HUP

devices=(SIMULATED_ENABLE=1 SIMULATED_LEFT=simple SIMULATED_RIGHT=simple)
if [ "$hands" != none ]; then
  # Below the ports that the system hands out.
  port=$((20000 + $$ % 12000))
  mkdir -p config/monado
  echo "{\"active\": \"remote\", \"remote\": {\"version\": 0, \"port\": $port, \"view_count\": 2}}" >config/monado/config_v0.json
  devices=(P_OVERRIDE_ACTIVE_CONFIG=remote "XDG_CONFIG_HOME=$out/config")
fi
start_service() {
  rm -f "$XDG_RUNTIME_DIR/monado_comp_ipc"
  env XRT_COMPOSITOR_NULL=1 XRT_NO_STDIN=1 "${devices[@]}" \
    setpriv --pdeathsig KILL monado-service >>monado.log 2>&1 </dev/null &
  service=$!
  await_monado $service "$out/monado.log"
}
said() { grep -c "$1" walk.log; }
# Waits for the walk to say $1 for the $2nd time.
await() {
  for _ in $(seq 600); do
    [ "$(said "$1")" -ge "$2" ] && return
    kill -0 "$walk" 2>/dev/null || return 1
    sleep 0.1
  done
  return 1
}

start_service
unset DISPLAY WAYLAND_DISPLAY XAUTHORITY
if [ "$display" = xvfb ]; then
  # It finds a free display and tells its number once it answers. It is not to begin anew when its last window closes:
  # the next would find nobody.
  setpriv --pdeathsig TERM Xvfb -displayfd 3 -noreset -screen 0 1600x900x24 -nolisten tcp 3>display >/dev/null 2>&1 </dev/null &
  screen=$!
  for _ in $(seq 100); do [ -s display ] && break; sleep 0.1; done
  [ -s display ] || fail "Xvfb did not start"
  export DISPLAY=:$(<display)
fi
# To its standard output: a file of its own the layer begins anew with each instance.
XR_ENABLE_API_LAYERS=XR_APILAYER_LUNARG_core_validation XR_CORE_VALIDATION_EXPORT_TYPE=text \
  "$probewalk" walk "$@" --display headset --validate --report report $([ "$hands" = none ] || echo --record walked.jsonl) >openxr.txt 2>walk.log &
walk=$!
faults=0
fault() { echo "FAULT: $1"; faults=$((faults + 1)); }

if [ "$hands" != none ]; then
  setpriv --pdeathsig TERM "$hands" "$port" >hands 2>&1 </dev/null &
  mover=$!
fi
begun=$SECONDS ends=$((SECONDS + minutes * 60))
await FOCUSED 1 || fault "the walk did not begin"
for ((k = 1; k <= kills; ++k)); do
  at=$((begun + minutes * 60 * k / (kills + 1)))
  while [ $SECONDS -lt $at ] && kill -0 $walk 2>/dev/null; do sleep 0.2; done
  kill -KILL $service; wait $service 2>/dev/null
  await 'goes on: \(offscreen\|window\)' $k || fault "kill $k: the walk did not go on without its headset"
  start_service
  await 'goes on: headset' $k && await FOCUSED $((k + 1)) || fault "kill $k: the headset did not come back"
done
while [ $SECONDS -lt $ends ] && kill -0 $walk 2>/dev/null; do sleep 0.2; done
kill -0 $walk 2>/dev/null || fault "the walk ended by itself"
kill -INT $walk; wait $walk; code=$?
walk=''
if [ "$hands" != none ]; then
  kill $mover; wait $mover || fault "the hands had nobody to move: $(cat hands)"
  mover=''
  jumps=$(sed 's/.*"position_m": *\[\([^]]*\)\].*/\1/' walked.jsonl | awk -F', *' '
    NR > 1 && (($1 - x) ^ 2 + ($2 - y) ^ 2 + ($3 - z) ^ 2) > 0.25 { ++n } { x = $1; y = $2; z = $3 } END { print n + 0 }')
  [ "$jumps" -ge "$minutes" ] || fault "$jumps teleports came of it"
  echo "$(cat hands); $jumps steps of over 0.5 m from one frame to the next"
fi
kill $service; wait $service 2>/dev/null
service=''

[ $code = 5 ] || fault "the walk ended with exit status $code instead of 5 (interrupted)"
vulkan=$(said 'Vulkan validation:')
openxr=$(grep -c 'VALID_ERROR\|VALID_WARNING' openxr.txt)
[ "$vulkan" = 0 ] || fault "the Vulkan validation layer had $vulkan messages; see $out/walk.log"
[ "$openxr" = 0 ] || fault "the OpenXR validation layer had $openxr findings; see $out/openxr.txt"
# A runtime that goes away may be warned of; nothing else.
other=$(grep 'warning:\|error:' walk.log | grep -v 'the OpenXR runtime went away\|Vulkan validation' | sort | uniq -c)
[ -z "$other" ] || fault "the walk complained: $other"
frames=$(($(wc -l <report/frames.csv) - 1))
echo "$minutes min, $frames frames; Vulkan validation messages $vulkan, OpenXR findings $openxr;" \
  "killed $kills times, gone on without headset $(said 'goes on: \(offscreen\|window\)')," \
  "back in it $(said 'goes on: headset'); faults $faults"
[ $faults = 0 ]
