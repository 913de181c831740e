#!/usr/bin/python3
"""DISPLAY program of a headless LinuxCNC: switches on, homes, plays a G-code program and records it with halsampler.

STRIBECK_PROGRAM and STRIBECK_LOG name the files, demo.ngc and run.log if they are not set; LinuxCNC ends when this does.
Not "env python3": the module linuxcnc is that of Debian's own Python.
"""

import atexit
import os
import subprocess
import sys
import time

import linuxcnc

PROGRAM = os.path.abspath(os.environ.get("STRIBECK_PROGRAM", "demo.ngc"))
LOG = os.environ.get("STRIBECK_LOG", "run.log")

command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def wait(done, seconds, what):
    end = time.time() + seconds
    while time.time() < end:
        status.poll()
        message = errors.poll()
        if message:
            text = f"play.py: while waiting for {what}: {message[1].strip()}"
            if message[0] in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR):
                sys.exit(text)
            print(text)
        if done():
            return
        time.sleep(0.01)
    sys.exit(f"play.py: waited {seconds} s for {what}")


def sampling(on):
    subprocess.check_call(["halcmd", "setp", "sampler.0.enable", str(int(on))])


def sampler(pin):
    return int(subprocess.check_output(["halcmd", "getp", "sampler.0." + pin], text=True))


wait(lambda: status.axis_mask != 0 and status.task_state == linuxcnc.STATE_ESTOP, 300, "start")
command.state(linuxcnc.STATE_ESTOP_RESET)
command.wait_complete()
command.state(linuxcnc.STATE_ON)
command.wait_complete()
wait(lambda: status.task_state == linuxcnc.STATE_ON, 300, "machine on")
command.mode(linuxcnc.MODE_MANUAL)
command.wait_complete()
command.home(-1)
wait(lambda: all(status.homed[: status.joints]), 300, "homing")
command.mode(linuxcnc.MODE_AUTO)
command.wait_complete()
command.program_open(PROGRAM)
command.wait_complete()
# halsampler says nothing of a file that it cannot write.
try:
    with open(LOG, "w", encoding="utf-8"):
        pass
except OSError as error:
    sys.exit(f"play.py: {LOG} cannot be written: {error.strerror}")
recorder = subprocess.Popen(["halsampler", "-t", LOG])
atexit.register(recorder.terminate)
sampling(True)
command.auto(linuxcnc.AUTO_RUN, 0)
wait(lambda: status.interp_state != linuxcnc.INTERP_IDLE, 300, "the program to begin")
clocks = {}
for _ in range(30):
    for line in subprocess.check_output(["halcmd", "-s", "show", "pin", "*.time"], text=True).splitlines():
        word = line.split()
        if len(word) >= 5:
            clocks.setdefault(word[4], []).append(int(word[3]))
wait(lambda: status.interp_state == linuxcnc.INTERP_IDLE and status.inpos, 3600, "the program to end")
sampling(False)
# On a busy computer halsampler is behind.
wait(lambda: sampler("curr-depth") == 0, 300, "the end of the record")
time.sleep(0.3)
recorder.terminate()
recorder.wait()
if not os.path.getsize(LOG):
    sys.exit(f"play.py: {LOG} is empty, halsampler wrote nothing")
lost = sampler("overruns")
if lost:
    os.replace(LOG, LOG + ".incomplete")
    sys.exit(f"play.py: {lost} rows were lost, what there is of the record is {LOG}.incomplete (lower STRIBECK_SPEED)")
# Median time of every function, in clocks of the processor.
with open(LOG + ".clocks", "w", encoding="utf-8") as file:
    for name, values in sorted(clocks.items()):
        file.write(f"{name} {sorted(values)[len(values) // 2]}\n")
