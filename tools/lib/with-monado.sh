#!/usr/bin/env bash
# Runs CMD with a simulated headset and no hardware: a Monado service of its own, for the length of CMD. Runs on the
# platform itself (tools/monado brings it there). usage: with-monado.sh null|xvfb CMD…
#   null  no compositor: 2 x 320x240 at 20 Hz, the least load
#   xvfb  the real compositor in a virtual display: 2 x 960x1080 at 72 Hz; DISPLAY is that display
set -euo pipefail
compositor=$1; shift
log=${PROBEWALK_MONADO_LOG:-/dev/null}
fail() { echo "probewalk: $1" >&2; exit 125; }

source "$(dirname "${BASH_SOURCE[0]}")/monado-service.sh"
# Everything started here ends with this script, even when it is killed (pdeathsig).
started=()
stop() {
  [ ${#started[@]} = 0 ] || kill "${started[@]}" 2>/dev/null || true
  for _ in 1 2 3 4 5 6 7 8 9 10; do
    { [ ${#started[@]} = 0 ] || ! kill -0 "${started[@]}" 2>/dev/null; } && break
    sleep 0.1
  done
  [ ${#started[@]} = 0 ] || kill -KILL "${started[@]}" 2>/dev/null || true
  rm -rf "$runtime_dir"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

service=(env XDG_RUNTIME_DIR="$runtime_dir" SIMULATED_ENABLE=1 XRT_NO_STDIN=1 XRT_METRICS_EARLY_FLUSH=1)
case $compositor in
  null) service+=(XRT_COMPOSITOR_NULL=1) ;;
  xvfb)
    # Xvfb finds a free display and tells its number once it answers.
    setpriv --pdeathsig TERM Xvfb -displayfd 3 -noreset -screen 0 1600x900x24 -nolisten tcp 3>"$runtime_dir/display" >/dev/null 2>>"$log" </dev/null &
    started+=($!)
    for _ in $(seq 100); do [ -s "$runtime_dir/display" ] && break; sleep 0.1; done
    [ -s "$runtime_dir/display" ] || fail "Xvfb did not start; see $log"
    export DISPLAY=:$(<"$runtime_dir/display")
    unset WAYLAND_DISPLAY XAUTHORITY
    service+=(XRT_COMPOSITOR_FORCE_XCB=1 XRT_COMPOSITOR_SCALE_PERCENTAGE=150 XRT_COMPOSITOR_DEFAULT_FRAMERATE=72)
    ;;
  *) fail "compositor $compositor is neither null nor xvfb" ;;
esac

"${service[@]}" setpriv --pdeathsig KILL monado-service >>"$log" 2>&1 </dev/null &
monado=$!
started=($monado "${started[@]}")
await_monado $monado "$log"

export XDG_RUNTIME_DIR=$runtime_dir XR_RUNTIME_JSON=$manifest
# In the background, so that a signal to this script reaches CMD at once; bash makes such a command deaf to Ctrl-C.
env --default-signal=INT,QUIT "$@" <&0 &
command=$!
trap 'kill -TERM $command 2>/dev/null' TERM HUP
trap : INT
status=0
while wait $command || status=$?; kill -0 $command 2>/dev/null; do status=0; done
exit $status
