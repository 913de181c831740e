"""Between stribeck and a running LinuxCNC: one line of JSON in, one line of JSON out, until the input ends.

Runs as "python3 -c TEXT INI". When the input ends, for whatever reason, it stops a motion that this program began.
"""

import ctypes
import json
import os
import signal
import subprocess
import sys
import time

# stribeck kills its children when it dies; this one has to stop the machine first.
ctypes.CDLL(None).prctl(1, 0)
signal.signal(signal.SIGINT, signal.SIG_IGN)

try:
    import linuxcnc
except ImportError as error:
    sys.exit(f"the module linuxcnc of Debian's own Python is missing: {error}")

INI = linuxcnc.ini(sys.argv[1])
if INI.find("EMC", "NML_FILE"):
    linuxcnc.nmlfile = INI.find("EMC", "NML_FILE")
try:
    STATUS, COMMAND, ERRORS = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
    STATUS.poll()
except linuxcnc.error as error:
    sys.exit(f"no LinuxCNC runs: {error}")

PATIENCE = 20.0  # s
recorder = None
began = False  # a motion


def fail(what):
    raise RuntimeError(what)


def poll(done, what):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        STATUS.poll()
        if done():
            return
        time.sleep(0.005)
    fail(f"LinuxCNC does not come to {what}" + "".join(": " + text for text in messages()[:1]))


def complete(what):
    ended = COMMAND.wait_complete(PATIENCE)
    if ended != linuxcnc.RCS_DONE:
        why = "refuses" if ended == linuxcnc.RCS_ERROR else f"has not answered for {PATIENCE:.0f} s"
        fail(f"LinuxCNC {why}: {what}" + "".join(": " + text for text in messages()[:1]))


def taken():
    """Waits until the last command has arrived; its motion has then begun, or a message says why not."""
    poll(lambda: STATUS.echo_serial_number >= COMMAND.serial, "take a command")


def messages():
    out = []
    while True:
        message = ERRORS.poll()
        if not message:
            return out
        if message[0] in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR):
            out.append(message[1].strip())


def halcmd(*words):
    done = subprocess.run(["halcmd", *words], capture_output=True, text=True, check=False)
    if done.returncode:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()
        fail(f"halcmd {' '.join(words)}: {said[-1] if said else 'failed'}")
    return done.stdout


def mode(wanted):
    STATUS.poll()
    if STATUS.task_mode != wanted:
        COMMAND.mode(wanted)
        complete("a change of mode")


def offsets():
    """What stands between the coordinates of a program and those of the machine, in words."""
    found = []
    for name, values in (("work offset", STATUS.g5x_offset), ("G92", STATUS.g92_offset), ("tool length", STATUS.tool_offset)):
        parts = [f"{letter}{value:.6g}" for letter, value in zip("XYZABCUVW", values) if abs(value) > 1e-9]
        if parts:
            found.append(" ".join([name, *parts]))
    if abs(STATUS.rotation_xy) > 1e-9:
        found.append(f"rotation of {STATUS.rotation_xy:.6g} degrees")
    return ", ".join(found)


def state(_):
    STATUS.poll()
    joints = []
    for i in range(STATUS.joints):
        j = STATUS.joint[i]
        joints.append(
            {
                "position": STATUS.joint_actual_position[i],
                "command": STATUS.joint_position[i],
                "following_error": j["ferror_current"],
                "homed": bool(STATUS.homed[i]),
                "fault": bool(j["fault"]),
                "at_limit": any(j[k] for k in ("min_soft_limit", "max_soft_limit", "min_hard_limit", "max_hard_limit")),
            }
        )
    return {
        "ini": os.path.abspath(STATUS.ini_filename) if STATUS.ini_filename else "",
        "ready": STATUS.joints > 0,
        "estop": STATUS.task_state in (linuxcnc.STATE_ESTOP, 0),
        "on": STATUS.task_state == linuxcnc.STATE_ON,
        "moving": not (
            STATUS.interp_state == linuxcnc.INTERP_IDLE
            and STATUS.inpos
            and STATUS.state != linuxcnc.RCS_EXEC
            and not any(STATUS.joint[i]["homing"] or not STATUS.joint[i]["inpos"] for i in range(STATUS.joints))
        ),
        "linear_units": STATUS.linear_units,
        "offsets": offsets(),
        "joints": joints,
        "errors": messages(),
    }


def in_estop():
    STATUS.poll()
    return STATUS.task_state in (linuxcnc.STATE_ESTOP, 0)


def release(_):
    if in_estop():
        COMMAND.state(linuxcnc.STATE_ESTOP_RESET)
        complete("the emergency stop is not released")
        poll(lambda: not in_estop(), "a released emergency stop (is the button still pressed?)")
    return {}


def switch_on(_):
    if in_estop():
        fail("the emergency stop is active: the machine is not switched on")
    if STATUS.task_state != linuxcnc.STATE_ON:
        COMMAND.state(linuxcnc.STATE_ON)
        complete("machine on")
        poll(lambda: STATUS.task_state == linuxcnc.STATE_ON, "machine on")
    return {}


def switch_off(_):
    STATUS.poll()
    if STATUS.task_state == linuxcnc.STATE_ON:
        COMMAND.state(linuxcnc.STATE_OFF)
        complete("machine off")
        poll(lambda: STATUS.task_state != linuxcnc.STATE_ON, "machine off")
    return {}


def joint_mode():
    mode(linuxcnc.MODE_MANUAL)
    STATUS.poll()
    if STATUS.motion_mode != linuxcnc.TRAJ_MODE_FREE:
        COMMAND.teleop_enable(0)
        complete("joint mode")
        poll(lambda: STATUS.motion_mode == linuxcnc.TRAJ_MODE_FREE, "joint mode")


def home(_):
    global began
    joint_mode()
    began = True
    COMMAND.home(-1)
    taken()
    return {}


def jog(wanted):
    global began
    joint_mode()
    began = True
    COMMAND.jog(linuxcnc.JOG_INCREMENT, True, wanted["joint"], wanted["speed"], wanted["distance"])
    taken()
    return {}


def run(wanted):
    global began
    mode(linuxcnc.MODE_AUTO)
    COMMAND.reset_interpreter()
    complete("a program")
    COMMAND.program_open(wanted["program"])
    complete("a program")
    began = True
    COMMAND.auto(linuxcnc.AUTO_RUN, 0)
    taken()
    return {}


def stop(_):
    global began
    COMMAND.abort()
    COMMAND.wait_complete(PATIENCE)
    began = False
    return {}


def items(wanted):
    out = []
    for line in halcmd("-s", "show", wanted["kind"], wanted["pattern"]).splitlines():
        word = line.split()
        if len(word) >= 5:
            out.append({"name": word[4], "value": word[3], "signal": word[6] if len(word) > 6 else ""})
    return {"items": out}


def functions(_):
    for line in halcmd("-s", "show", "thread").splitlines():
        word = line.split()
        if len(word) > 4 and "motion-controller" in word:
            return {"functions": word[5:]}
    return {"functions": []}


def hal(wanted):
    for words in wanted["commands"]:
        halcmd(*words)
    return {}


def sampler(number, pin):
    return f"sampler.{number}.{pin}"


def begin_record(wanted):
    global recorder
    number, file = wanted["sampler"], wanted["file"]
    with open(file, "w", encoding="utf-8"):
        pass
    halcmd("setp", sampler(number, "enable"), "0")
    # Rows that nobody read are not part of this record. halsampler ends by itself here: killed while it begins, it keeps HAL locked.
    unread = int(halcmd("getp", sampler(number, "curr-depth")))
    if unread > 0:
        subprocess.run(["halsampler", "-c", str(number), "-n", str(unread), os.devnull], check=False, timeout=PATIENCE)
    halcmd("setp", sampler(number, "overruns"), "0")
    recorder = (number, subprocess.Popen(["halsampler", "-c", str(number), "-t", file]))
    halcmd("setp", sampler(number, "enable"), "1")
    return {}


def wait_empty(number):
    end = time.monotonic() + PATIENCE
    while int(halcmd("getp", sampler(number, "curr-depth"))) > 0:
        if time.monotonic() > end:
            fail("halsampler does not read the sampler")
        time.sleep(0.02)


def end_record(_):
    global recorder
    if recorder is None:
        return {}
    number, process = recorder
    recorder = None
    halcmd("setp", sampler(number, "enable"), "0")
    try:
        wait_empty(number)
        time.sleep(0.1)
    finally:
        process.terminate()
        process.wait()
    lost = int(halcmd("getp", sampler(number, "overruns")))
    if lost:
        fail(f"{lost} rows were lost: the computer is too busy, or the depth of the sampler is too small")
    return {}


def finish(_):
    """Nothing of this program stays: no motion, no recording."""
    global began
    try:
        if began:
            STATUS.poll()
            if STATUS.interp_state != linuxcnc.INTERP_IDLE or not STATUS.inpos:
                COMMAND.abort()
                COMMAND.wait_complete(PATIENCE)
            began = False
        end_record({})
    except (RuntimeError, OSError, linuxcnc.error):
        pass
    return {}


DO = {
    "state": state,
    "ini": lambda wanted: {"values": INI.findall(wanted["section"], wanted["key"])},
    "release": release,
    "on": switch_on,
    "off": switch_off,
    "home": home,
    "jog": jog,
    "run": run,
    "stop": stop,
    "items": items,
    "functions": functions,
    "hal": hal,
    "begin_record": begin_record,
    "end_record": end_record,
    "finish": finish,
}

try:
    for line in sys.stdin:
        try:
            wanted = json.loads(line)
            answer = DO[wanted["do"]](wanted)
        except (RuntimeError, OSError, ValueError, subprocess.SubprocessError, linuxcnc.error) as error:
            answer = {"error": str(error)}
        print(json.dumps(answer), flush=True)
except (BrokenPipeError, KeyboardInterrupt):
    pass
finally:
    finish({})
