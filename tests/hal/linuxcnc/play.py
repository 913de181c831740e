#!/usr/bin/python3
"""DISPLAY program of a headless LinuxCNC: moves, breaks something, mends it, goes on, for each case of FAULTS; or plays a program.

STRIBECK_FAULTS: names of FAULTS, separated by commas; none: the program runs once. STRIBECK_LOG: what halsampler writes. Prints
number and name of every case after which LinuxCNC could be switched on and moved again. LinuxCNC ends when this does.
"""

import os
import subprocess
import sys
import time

import linuxcnc

# What breaks it, what mends it. The numbers are also in faults.awk.
FAULTS = {
    "nan-feedback": (1, "setp broken.sel 1", "setp broken.sel 0"),
    "frozen-encoder": (2, "setp frozen.sel 1", "setp frozen.sel 0"),
    "jump": (3, "setp jump.in1 1", "setp jump.in1 0"),
    "enable-toggled": (4, "setp toggling.in1 1", "setp toggling.in1 0"),
    "saturated": (5, "sets cutting 300", "sets cutting 0"),
    "nan-command": (6, "setp broken-command.sel 1", "setp broken-command.sel 0"),
}
command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def poll():
    status.poll()
    while errors.poll():
        pass


def wait(done, seconds, what):
    end = time.time() + seconds
    while time.time() < end:
        poll()
        if done():
            return
        time.sleep(0.005)
    sys.exit(f"play.py: waited {seconds} s for {what}")


def hal(*lines):
    subprocess.run(["halcmd", "-f"], input="\n".join(lines) + "\n", text=True, check=True)


def travel(way):
    """Waits until x is so far from here [mm]; not a time, for a computer may be busy."""
    poll()
    begin = status.joint_position[0]
    wait(lambda: abs(status.joint_position[0] - begin) > way, 1200, f"{way} mm")


def run():
    """Switches on and begins the program."""
    command.mode(linuxcnc.MODE_MANUAL)
    command.wait_complete()
    command.state(linuxcnc.STATE_ESTOP_RESET)
    command.wait_complete()
    command.state(linuxcnc.STATE_ON)
    command.wait_complete()
    wait(lambda: status.task_state == linuxcnc.STATE_ON, 600, "machine on")
    if not all(status.homed[:2]):
        command.home(-1)
        wait(lambda: all(status.homed[:2]), 600, "homing")
    command.mode(linuxcnc.MODE_AUTO)
    command.wait_complete()
    command.program_open(os.path.abspath("program.ngc"))
    command.wait_complete()
    command.auto(linuxcnc.AUTO_RUN, 0)
    wait(lambda: status.interp_state != linuxcnc.INTERP_IDLE, 600, "the program to begin")


def median_clocks():
    clocks = {}
    for _ in range(30):
        for line in subprocess.check_output(["halcmd", "-s", "show", "pin", "*.time"], text=True).splitlines():
            word = line.split()
            if len(word) >= 5:
                clocks.setdefault(word[4], []).append(int(word[3]))
    return {name: sorted(values)[len(values) // 2] for name, values in clocks.items()}


wait(lambda: status.joints == 2 and status.task_state == linuxcnc.STATE_ESTOP, 600, "start")
names = [n for n in os.environ.get("STRIBECK_FAULTS", "").split(",") if n]
recorder = subprocess.Popen(["halsampler", "-t", os.environ["STRIBECK_LOG"]])
hal("setp sampler.0.enable 1")
if not names:
    run()
    with open(os.environ["STRIBECK_LOG"] + ".clocks", "w", encoding="utf-8") as file:
        file.writelines(f"{name} {value}\n" for name, value in sorted(median_clocks().items()))
    wait(lambda: status.interp_state == linuxcnc.INTERP_IDLE and status.inpos, 3600, "the program to end")
for name in names:
    number, breaks, mends = FAULTS[name]
    run()
    travel(15)
    hal(f"sets case {number}", breaks)
    if number == 4:
        # The program never stops; it is LinuxCNC's own switch that ends it, 25 mm later.
        travel(25)
        command.state(linuxcnc.STATE_OFF)
    wait(lambda: status.task_state != linuxcnc.STATE_ON, 600, f"{name}: machine off")
    time.sleep(0.05)
    hal(mends)
    time.sleep(0.05)
    hal(f"sets case {number + 10}")
    run()
    travel(15)
    hal("sets case 0")
    print(f"play.py: {number} {name}", flush=True)
    command.state(linuxcnc.STATE_OFF)
    wait(lambda: status.task_state != linuxcnc.STATE_ON, 600, "machine off")
hal("setp sampler.0.enable 0")
time.sleep(0.3)
recorder.terminate()
recorder.wait()
