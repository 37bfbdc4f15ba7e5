#!/usr/bin/env bash
# web_server_walk.sh PACK OUT: walks for minutes in real time through a pack that nginx serves over a slow line on which
# some requests fail, within a part of the pack's device memory, and prints what was late. By hand:
#   probewalk on the PATH, slow_link beside it (or in BIN), nginx installed
# Settings: SECONDS_LONG=300 RATE_MB_S=20 LATENCY_MS=50 FAILING=1% BUDGET_PART=10 EYE=320x360 WALK=FILE (a recorded path;
# without one the pack's tour)
set -euo pipefail
pack=$(realpath "$1"); mkdir -p "$2"; out=$(realpath "$2")
seconds=${SECONDS_LONG:-300} rate=${RATE_MB_S:-20} latency=${LATENCY_MS:-50} failing=${FAILING:-1%} part=${BUDGET_PART:-10}
eye=${EYE:-320x360}
bin=${BIN:-$(dirname "$(command -v probewalk)")}
nginx=$(command -v nginx || echo /usr/sbin/nginx)
rm -rf "$out/cache" "$out/nginx"; mkdir -p "$out/nginx/temp"
server_port=$((20000 + $$ % 20000)) port=$((20001 + $$ % 20000))

cat >"$out/nginx/nginx.conf" <<CONF
daemon off; master_process off; worker_processes 1;
pid $out/nginx/nginx.pid; error_log $out/nginx/error.log;
events { worker_connections 256; }
http {
  split_clients \$request_id \$fails { $failing yes; * ''; }
  log_format brief '\$status \$uri \$http_range \$body_bytes_sent'; access_log $out/nginx/access.log brief;
  client_body_temp_path $out/nginx/temp/b; proxy_temp_path $out/nginx/temp/p; fastcgi_temp_path $out/nginx/temp/f;
  uwsgi_temp_path $out/nginx/temp/u; scgi_temp_path $out/nginx/temp/s;
  server {
    listen 127.0.0.1:$server_port;
    location / { alias $pack/; if (\$fails) { return 503; } }
    location = /pack.json { alias $pack/pack.json; }
  }
}
CONF
"$nginx" -p "$out/nginx" -c "$out/nginx/nginx.conf" 2>"$out/nginx/out" & nginx_pid=$!
mkfifo "$out/nginx/stay"
"$bin/slow_link" $port $server_port "$rate" "$latency" <"$out/nginx/stay" & link_pid=$!
exec 9>"$out/nginx/stay"
trap 'exec 9>&-; kill $nginx_pid $link_pid 2>/dev/null || true' EXIT
for each in $server_port $port; do
  for _ in $(seq 50); do (exec 3<>/dev/tcp/127.0.0.1/$each) 2>/dev/null && break; sleep 0.1; done
done

# The line, measured: time to the first byte, and the rate of one big file.
fetch() { # PATH: prints ms to the first byte, ms in all, bytes
  exec 3<>/dev/tcp/127.0.0.1/$port
  local begin first end bytes
  begin=$(date +%s%N)
  printf 'GET %s HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n' "$1" >&3
  IFS= read -r -n 1 <&3; first=$(date +%s%N)
  bytes=$(wc -c <&3); end=$(date +%s%N)
  exec 3>&-
  echo "$(((first - begin) / 1000000)) $(((end - begin) / 1000000)) $bytes"
}
biggest=$(ls -S "$pack/chunks" | sed -n 1p)  # not head: it would end ls, which pipefail takes for a failure
read -r first _ _ < <(fetch /nothing)
read -r _ all bytes < <(fetch "/chunks/$biggest")
echo "line: first byte after $first ms; $bytes bytes in $all ms"

device_bytes=$("$bin/probewalk" info "$pack" --json | sed -n 's/^  "bytes_device": \([0-9]*\).*/\1/p' | sed -n 1p)
budget=$((device_bytes / part >> 20)); [ $budget -gt 0 ] || budget=1
echo "pack: $((device_bytes >> 20)) MiB on the device; budget $budget MiB"
"$bin/probewalk" walk "http://127.0.0.1:$port" --display offscreen --realtime --seconds "$seconds" \
  ${WALK:+--path "$WALK"} --eye-size "$eye" --device-budget $budget --cache "$out/cache" --report "$out/report" \
  2>"$out/notes" ||
  { tail -n 5 "$out/notes"; exit 1; }

number() { sed -n "s/^ *\"$1\": \([^,]*\),*\$/\1/p" "$out/report/summary.json" | sed -n 1p; }
for key in frames missed coarse_frame_fraction need_to_resident_n need_to_resident_p50_ns need_to_resident_p99_ns \
  frame_thread_p99_ns device_bytes_max device_budget_bytes chunks requests failed_requests damaged bytes; do
  echo "$key: $(number $key)"
done
echo "answers that nginx gave: $(cut -d' ' -f1 "$out/nginx/access.log" | sort | uniq -c | tr -s ' \n' ' ')"
echo "notes:"; cat "$out/notes"
