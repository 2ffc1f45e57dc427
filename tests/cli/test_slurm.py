#!/usr/bin/env python3
"""test_slurm.py PROGRAM - shares on a real Slurm: controller, four nodes and munge as processes of this script, with all their files in a
folder of its own and no service of the system. 64 shares of a sweep, of which 5 are cancelled while they run; what merge says and prints; 200
cases of a test; GNU parallel. Every wait is for a state. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import ctypes
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from processes import free_ports  # noqa: E402
from verdicts import conclude, equal, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/contactplant")
NODES, SHARES, CUT = 4, 64, 5
PATIENCE_S = 1200  # for one state; only a broken cluster takes that long
SWEEP = "contactplant sweep rig --sweep force.frequency=150:260:40 --settle 200 --family force.amplitude=1:20:%d --cores 1" % SHARES
CONF = """ClusterName=contactplant
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={top}/munge.socket
CredType=cred/munge
StateSaveLocation={top}/state
SlurmdSpoolDir={top}/spool.%n
SlurmctldPidFile={top}/slurmctld.pid
SlurmdPidFile={top}/%n.pid
SlurmctldLogFile={top}/slurmctld.log
SlurmdLogFile={top}/%n.log
PlugStackConfig={top}/plugstack.conf
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
MessageTimeout=90
SlurmctldTimeout=600
SlurmdTimeout=600
KillWait=10
ReturnToService=2
{nodes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
servers = []


def serve(name, *words):
    with open(os.path.join(top, name + ".out"), "wb") as f:
        servers.append(subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=f, stderr=f, env=environment, cwd=top))


def ask(*words):
    r = subprocess.run(words, capture_output=True, text=True, env=environment, timeout=PATIENCE_S)
    return r.stdout if r.returncode == 0 else ""


def wait_until(what, is_so):
    begun = time.monotonic()
    while not is_so():
        dead = [p.args[0] for p in servers if p.poll() is not None]
        if dead or time.monotonic() - begun > PATIENCE_S:
            verdict(what, False, "ended: %s; after %d s; %s" % (dead, time.monotonic() - begun, logs()))
            raise SystemExit
        time.sleep(0.05)


def logs():
    text = ""
    for name in sorted(os.listdir(top)):
        if name.endswith((".log", ".out")):
            with open(os.path.join(top, name), errors="replace") as f:
                text += "\n%s: %s" % (name, f.read()[-400:])
    return text


def begin_cluster():
    port = free_ports(NODES + 1, 33000, (socket.SOCK_STREAM,))
    nodes = "\n".join("NodeName=node%d NodeHostname=%s NodeAddr=127.0.0.1 Port=%d CPUs=1 State=UNKNOWN" % (i + 1, socket.gethostname(), port + 1 + i) for i in range(NODES))
    user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
    for name, text in (("slurm.conf", CONF.format(host=socket.gethostname(), port=port, user=user, top=top, nodes=nodes)), ("plugstack.conf", "")):
        with open(os.path.join(top, name), "w") as f:
            f.write(text)
    with open(os.open(os.path.join(top, "munge.key"), os.O_WRONLY | os.O_CREAT, 0o400), "wb") as f:
        f.write(os.urandom(1024))
    os.mkdir(os.path.join(top, "state"))
    serve("munged", "munged", "--foreground", "--force", "--socket=%s/munge.socket" % top, "--key-file=%s/munge.key" % top, "--pid-file=%s/munge.pid" % top,
          "--seed-file=%s/munge.seed" % top, "--log-file=%s/munge.log" % top)
    wait_until("munge listens", lambda: os.path.exists(os.path.join(top, "munge.socket")))
    serve("slurmctld", "slurmctld", "-D", "-f", os.path.join(top, "slurm.conf"))
    for i in range(NODES):
        serve("node%d" % (i + 1), "slurmd", "-D", "-N", "node%d" % (i + 1), "-f", os.path.join(top, "slurm.conf"))
    wait_until("four nodes are idle", lambda: ask("sinfo", "-h", "-N", "-o", "%T").split() == ["idle"] * NODES)
    verdict("a Slurm with four nodes: %s" % ask("sinfo", "--version").strip(), True)


def end_cluster():
    """Jobs first; then the servers; then what they left behind, which is a child of this process by now."""
    if len(servers) == NODES + 2:
        ask("scancel", "--user", str(os.getuid()))
        begun = time.monotonic()
        while ask("squeue", "-h").strip() and time.monotonic() - begun < 60:
            time.sleep(0.1)
    for p in reversed(servers):
        if p.poll() is None:
            p.terminate()
            try:
                p.wait(30)
            except subprocess.TimeoutExpired:
                p.kill()
                p.wait()
    return reap(time.monotonic() + 60)


def reap(until):
    """Waits for what the nodes have started; what has not ended by then is killed. Its numbers."""
    left = []
    while True:
        try:
            pid, _ = os.waitpid(-1, 0 if left else os.WNOHANG)
        except ChildProcessError:
            return left
        if not pid and time.monotonic() > until:
            with open("/proc/self/task/%d/children" % os.getpid()) as f:
                left += [int(child) for child in f.read().split()]
            for child in left:
                os.kill(child, signal.SIGKILL)
        elif not pid:
            time.sleep(0.05)


def tasks():
    """{share: state} of the tasks that are not over."""
    return {int(i): state for i, state in re.findall(r"^(\d+) (\S+)$", ask("squeue", "-h", "-r", "-o", "%K %T"), re.M)}


def read(path):
    with open(path, "rb") as f:
        return f.read()


def run(line):
    return subprocess.run(["sh", "-c", line], capture_output=True, text=True, env=environment, timeout=3 * PATIENCE_S)


def is_cut(path):
    """It has a row, and no last line."""
    text = read(path) if os.path.exists(path) else b""
    return text.count(b"\n") > 2 and b"\n# complete" not in text


def cancel_some(job):
    """Cancels CUT tasks of the array while they run, and waits for its end. The shares that were."""
    cut = []
    while len(cut) < CUT:
        state = tasks()
        if not state:
            break
        for i in [i for i, s in state.items() if s == "RUNNING" and i > 2 and is_cut("part%d.csv" % i)]:
            if len(cut) < CUT and (not cut or i - cut[-1] > 3):
                ask("scancel", "%s_%d" % (job, i))
                wait_until("task %d is over" % i, lambda i=i: i not in tasks())
                cut += [i] if is_cut("part%d.csv" % i) else []
    wait_until("the array is over", lambda: not tasks())
    return sorted(cut)


def sweep():
    print("--- %d shares of a sweep" % SHARES, flush=True)
    r = run("sbatch --parsable --array=1-%d --wrap '%s --shard auto --out part$SLURM_ARRAY_TASK_ID.csv'" % (SHARES, SWEEP))
    equal("sbatch", (r.returncode, r.stderr), (0, ""))
    cut = cancel_some(r.stdout.strip())
    equal("tasks cancelled while they ran: %s" % cut, len(cut), CUT)
    merge = "contactplant merge all.csv part*.csv"
    r = run(merge)
    told = "contactplant merge: of %d shares cut: %s; all.csv is not written\n" % (SHARES, ", ".join("%d (part%d.csv)" % (i, i) for i in cut))
    equal("merge names exactly these", (r.returncode, r.stderr == told, os.path.exists("all.csv")), (1, True, False))
    if r.stderr != told:
        print("      " + r.stderr)
    line = r.stdout.split("\n")[0]
    equal("  and prints a line", line.startswith("sbatch --array=%s --wrap " % ",".join(map(str, cut))), True)
    environment["SBATCH_WAIT"] = "1"  # sbatch ends with the array
    r = run(line)
    equal("the second array, by that line: status", (r.returncode, r.stderr), (0, ""))
    r = run(merge)
    equal("merged", (r.returncode, r.stderr), (0, ""))
    run(SWEEP.replace("--cores 1", "") + " --out one.csv")
    equal("  are the bytes of one run: %d" % len(read("one.csv")), read("all.csv") == read("one.csv"), True)


def untimed(path):
    return re.sub(rb' (time|timestamp)="[^"]*"', b"", read(path))


def matrix():
    print("--- 200 cases of a test", flush=True)
    for k in range(4):
        with open("t%d.test" % k, "w") as f:
            f.write("[plant]\nscene = hertz_rig\n[controller]\nbuiltin = keep\n")
            for i in range(50):
                f.write("[case %d]\nrequirement = R-%d\nover = 0.05 s\nmass = %g kg\nexpect %s\n" % (i, (50 * k + i) % 60, 5 + i / 50, "penetration >= 1 m" if i % 17 == 3 else "faults == 0"))
    with open("list.csv", "w") as f:
        f.write("".join("R-%d\n" % i for i in range(61)))
    command = "contactplant test t?.test --requirements list.csv"
    r = run("sbatch --array=1-10 --wrap '%s --shard auto --junit j$SLURM_ARRAY_TASK_ID.xml --json j$SLURM_ARRAY_TASK_ID.json'" % command)
    equal("sbatch told that cases failed", (r.returncode, r.stderr), (1, ""))
    r = run(command + " --junit one.xml --json one.json")
    equal("one run", r.stdout.splitlines()[-2].split(";")[0], "188 ok, 12 failed, 0 untested, 0 with an error")
    for kind in ("xml", "json"):
        r = run("contactplant merge all.%s j*.%s" % (kind, kind))
        equal("%s: merged" % kind, (r.returncode, r.stderr), (0, ""))
        equal("  it is that of one run%s" % (" but for times" if kind == "xml" else ""), untimed("all." + kind) == untimed("one." + kind), True)
    equal("200 cases in 4 suites", (read("all.xml").count(b"<testcase "), read("all.xml").count(b"<testsuite ")), (200, 4))


def parallel():
    print("--- GNU parallel", flush=True)
    line = "contactplant random nayak-random --seeds 12 --over 100"
    r = run("seq 8 | parallel --will-cite -j 2 %s --shard auto/8 --cores 1 --out g{}.csv" % line)
    equal("eight shares", (r.returncode, sorted(f for f in os.listdir(".") if f.startswith("g"))), (0, ["g%d.csv" % i for i in range(1, 9)]))
    run(line + " --out g.one")
    equal("  merge to one run", (run("contactplant merge g.all g*.csv").returncode, read("g.all") == read("g.one")), (0, True))


signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # an interrupted run ends its cluster, too
if ctypes.CDLL(None).prctl(36, 1, 0, 0, 0):  # PR_SET_CHILD_SUBREAPER: steps that a node leaves behind come here
    sys.exit("no subreaper")
with tempfile.TemporaryDirectory(prefix="contactplant_slurm.") as top:
    os.chmod(top, 0o755)
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("SLURM", "SBATCH", "PARALLEL"))}
    environment |= {"PATH": os.path.dirname(program) + ":" + os.environ["PATH"] + ":/usr/sbin:/sbin", "SLURM_CONF": os.path.join(top, "slurm.conf"),
                    "HOME": top, "SBATCH_OUTPUT": os.path.join(top, "task.%A_%a")}
    os.mkdir(os.path.join(top, "work"))
    os.chdir(os.path.join(top, "work"))
    try:
        parallel()
        begin_cluster()
        sweep()
        matrix()
    finally:
        left = end_cluster()
        os.chdir("/")
    verdict("nothing is left behind", not left, left)
conclude()
