#!/usr/bin/env bash
# bake_slurm_test.sh SOURCE_DIR PROBEWALK OUTPUT_DIR
# A bake by a job array of a real slurmctld and slurmd on this machine's loopback: the bytes of one machine, though a task is
# killed in mid-job. Exits with 77 (skipped) where Slurm's daemons are not installed, do not come up, or this user may not
# start them.
set -euo pipefail
source_dir=$1 probewalk=$2 out=$3/slurm
export PATH=$PATH:/usr/sbin:/sbin
for command in slurmctld slurmd sbatch squeue scontrol scancel sinfo; do
  command -v $command >/dev/null || { echo "skipped: no $command; install slurmctld, slurmd and slurm-client"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: slurmd wants root"; exit 77; }

rm -rf "$out"; mkdir -p "$out"/{etc,state,spool,log}
host=$(hostname -s)
port=$((20000 + $$ % 20000))
dd if=/dev/urandom of="$out/etc/slurm.key" bs=64 count=1 status=none; chmod 600 "$out/etc/slurm.key"
cat >"$out/etc/slurm.conf" <<EOF
ClusterName=probewalk
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/slurm
CredType=cred/slurm
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$out/state
SlurmdSpoolDir=$out/spool
SlurmctldPidFile=$out/slurmctld.pid
SlurmdPidFile=$out/slurmd.pid
SlurmctldLogFile=$out/log/slurmctld.log
SlurmdLogFile=$out/log/slurmd.log
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
echo "CgroupPlugin=disabled" >"$out/etc/cgroup.conf"
export SLURM_CONF=$out/etc/slurm.conf

slurmctld -D -i >/dev/null 2>&1 & controller=$!
slurmd -D -N "$host" >/dev/null 2>&1 & daemon=$!
stop() { kill $daemon $controller 2>/dev/null || true; wait $daemon $controller 2>/dev/null || true; }
trap stop EXIT
for _ in $(seq 100); do sinfo -h -o %T 2>/dev/null | grep -q idle && break; sleep 0.2; done
sinfo -h -o %T 2>/dev/null | grep -q idle ||
  { echo "skipped: Slurm did not come up on this machine:"; tail -n 20 "$out"/log/*; exit 77; }

scene=$out/scene.glb
"$probewalk" scene two-rooms -o "$scene" --quiet
options=(--resolution 256 --max-probes 12 --samples 8 --bounces 1)
"$probewalk" bake "$scene" -o "$out/one.probes" "${options[@]}" --quiet

export PROBEWALK=$probewalk
cd "$out"
"$source_dir/tools/bake-slurm" --tasks 4 --wait --output="$out/log/job-%j.txt" -- "$scene" -o "$out/many.probes" \
  "${options[@]}" --threads 1 >"$out/jobs" 2>"$out/bake-slurm.log" & submitted=$!
# The first task that has finished a map is killed the hard way.
victim=
for _ in $(seq 300); do
  if ls "$out"/many.probes.partial/geometry-* >/dev/null 2>&1; then
    victim=$(pgrep -f -- "bake --quiet $scene -o $out/many.probes .* --share [1-4]/4" | head -n 1 || true)
    [ -z "$victim" ] || break
  fi
  sleep 0.02
done
[ -n "$victim" ] || { echo "no task was seen at work"; tail -n 5 "$out"/log/*; exit 1; }
kill -KILL "$victim"
wait $submitted || { echo "the last job failed"; cat "$out/bake-slurm.log"; tail -n 20 "$out"/log/*; exit 1; }
diff -r "$out/one.probes" "$out/many.probes" || { echo "the bytes differ"; exit 1; }
[ ! -e "$out/many.probes.partial" ] || { echo "the state was left behind"; exit 1; }
echo "one task killed, the same bytes"
