# Sourced by what starts a Monado service of its own.
manifest=/usr/share/openxr/1/openxr_monado.json
[ -r "$manifest" ] || { echo "probewalk: $manifest is missing; install libopenxr1-monado and monado-service" >&2; exit 125; }
# The directory's name is short: a socket's path may have 107 characters.
runtime_dir=$(mktemp -d /tmp/pwxr.XXXXXX)
chmod 700 "$runtime_dir"
# It answers once its socket listens (flag __SO_ACCEPTCON).
monado_listens() { grep -q " 00010000 .* $runtime_dir/monado_comp_ipc\$" /proc/net/unix; }
# Waits for it; $1 is the service's process, $2 its log.
await_monado() {
  for _ in $(seq 200); do
    monado_listens && return
    kill -0 "$1" 2>/dev/null || fail "the Monado service ended at once; see $2"
    sleep 0.1
  done
  monado_listens || fail "the Monado service did not answer within 20 s; see $2"
}
