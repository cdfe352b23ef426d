#!/usr/bin/env python3
"""Boots emulated handhelds with the static program and checks it on their screen, keys, console, memory and network.

box_test.py POCKETRAY KERNELS MODELS MACHINE=PROGRAM... : this machine's program, the folder that prepare.sh prints, a folder
of models (those missing are skipped) and each handheld's program. Prints one line per check; exit status 1 if one fails."""
import array
import base64
import contextlib
import os
import re
import subprocess
import sys
import tempfile
import time

import png
from machine import Machine
from machines import MACHINES, arguments_of, qemu_of
from shaped_link import ShapedLink

PIXEL_COUNT = 320 * 240
LINK_BITS_PER_SECOND, LINK_DELAY = 19e6, 0.002
FRAME_BYTES_MIN = 25000  # of a first frame: a greeting takes 300 bytes, all rows of cornell 50,000 and more
BUDDHA = "mesh/happy_vrip_res3.ply"


class Failure(Exception):
    pass


def require(condition, text):
    if not condition:
        raise Failure(text)


class Box:
    """A booted handheld with the program, and this machine's program to compare with."""

    def __init__(self, machine, name, desktop, work):
        self.machine, self.name, self.desktop, self.work = machine, name, desktop, work
        self.format = MACHINES[name][5]
        self.slow = name == "arm926"
        self.run, self.press = machine.run, machine.press

    def expected(self, scene, pixels=None, size="320x240", samples=1):
        """This machine's frame, in the framebuffer's pixels unless told. A device solves no radiosity."""
        path = os.path.join(self.work, "expected.raw")
        light = [] if scene.endswith(".pray") else ["--indirect", "ambient"]
        subprocess.run([self.desktop, "render", scene, "--size", size, "--samples", str(samples), *light,
                        "--raw-format", pixels or self.format, "-o", path], check=True, stdout=subprocess.DEVNULL)
        with open(path, "rb") as file:
            return file.read()

    def screen(self):
        """What the screen shows, in the framebuffer's pixels. (qemu's 8 bits begin with the 5 or 6 of RGB565.)"""
        width, height, rgb = self.machine.screen()
        require((width, height) == (320, 240), f"the screen has {width}x{height} pixels")
        red, green, blue = rgb[0::3], rgb[1::3], rgb[2::3]
        if self.format == "rgb565":
            return array.array("H", ((r >> 3) << 11 | (g >> 2) << 5 | b >> 3 for r, g, b in zip(red, green, blue))).tobytes()
        pixels = bytearray(4 * PIXEL_COUNT)
        pixels[0::4], pixels[1::4], pixels[2::4] = blue, green, red
        return bytes(pixels)

    def wait_for_picture(self, expected, seconds):
        """Seconds until the screen shows exactly these bytes."""
        begin = time.monotonic()
        while time.monotonic() < begin + seconds:
            if self.screen() == expected:
                return time.monotonic() - begin
            time.sleep(0.2)
        size = len(expected) // PIXEL_COUNT
        shown = self.screen()
        wrong = sum(shown[i:i + size] != expected[i:i + size] for i in range(0, len(expected), size))
        raise Failure(f"{wrong} pixels differ after {seconds} s; the viewer said: {self.said()!r}")

    def view(self, scene, options="--no-hud", samples="--samples 1"):
        """Shows a scene. Without a number of samples, a picture at rest is refined to 16."""
        self.run(f"rm -f /tmp/view.log /tmp/view.status; (pocketray view {scene} {options} {samples} >/tmp/view.log 2>&1; "
                 "echo $? >/tmp/view.status) &")

    def said(self):
        return self.run("cat /tmp/view.log")[1].strip()

    def wait_for_end(self, seconds=20):
        status, printed = self.run(f"n=0; while [ ! -s /tmp/view.status ] && [ $n -lt {10 * seconds} ]; do usleep 100000; "
                                   "n=$((n + 1)); done; cat /tmp/view.status", seconds + 30)
        require(status == 0 and printed.strip().isdigit(), f"the viewer does not end; it said: {self.said()!r}")
        return int(printed)

    def check_one_line(self, command, status, pattern):
        got, printed = self.run(f"({command}) >/tmp/line 2>&1; status=$?; cat /tmp/line; (exit $status)")
        lines = [line for line in printed.strip().split("\n") if not line.startswith("rendering")]  # progress
        require(got == status, f"exit status {got} instead of {status}: {printed!r}")
        require(len(lines) == 1 and re.search(pattern, lines[0]), f"not one line with {pattern!r}: {printed!r}")


def scenes_on_screen(box):
    box.run("echo 0 >/sys/class/vtconsole/vtcon1/bind")  # so that the last frame stays when the viewer ends
    for scene in ("cube", "cornell", "seesaw", "buddha"):
        on_host = os.path.join(box.work, "buddha.pray") if scene == "buddha" else scene
        if scene == "buddha" and not os.path.exists(on_host):
            print(f"  {box.name}: no {BUDDHA} among the models: skipped", flush=True)
            continue
        box.view("/buddha.pray" if scene == "buddha" else scene, "--no-hud --frames 1")
        status = box.wait_for_end(400)
        require(status == 0, f"{scene}: exit status {status}: {box.said()!r}")
        try:
            box.wait_for_picture(box.expected(on_host), 2)
        except Failure as failure:
            raise Failure(f"{scene}: {failure}")
    box.run("echo 1 >/sys/class/vtconsole/vtcon1/bind")


def keys(box):
    still = box.expected("cube")
    box.view("cube")
    box.wait_for_picture(still, 120)
    for key in ("right", "up", "x", "w"):
        box.press(key, ms=300)
        require(box.screen() != still, f"the key {key} does not move the camera")
        box.press("ret")
        box.wait_for_picture(still, 120)
    box.press("f1")
    time.sleep(1)
    require(box.screen() != still, "F1 shows no overlay")
    box.press("f1")
    box.wait_for_picture(still, 30)
    box.press("f12")
    time.sleep(2 if box.slow else 1)
    status, encoded = box.run("base64 pocketray-0001.png && rm pocketray-0001.png")
    require(status == 0, f"no screenshot: {box.said()!r}")
    picture = png.decode(base64.b64decode(encoded))
    require(picture == (320, 240, box.expected("cube", pixels="rgb888")), "the screenshot is not the picture")
    box.press("esc")
    require(box.wait_for_end() == 0, "Esc does not end the viewer well")


def rotation(box):
    """A picture turned by 90 degrees clockwise: its bottom left is at the top left of the screen. It is refined, too."""
    upright = box.expected("cube", size="240x320", samples=1 if box.slow else 16)
    size = len(upright) // PIXEL_COUNT
    turned = b"".join(upright[((319 - x) * 240 + y) * size:][:size] for y in range(240) for x in range(320))
    box.view("cube", "--no-hud --size 240x320 --rotate 90", "--samples 1" if box.slow else "")
    box.wait_for_picture(turned, 120)
    leave_by_pad(box)


def leave_by_pad(box):
    box.machine.hold("ret", True)
    box.machine.hold("shift_r", True)
    require(box.wait_for_end() == 0, "start and select do not end the viewer well")
    box.machine.hold("shift_r", False)
    box.machine.hold("ret", False)


def picker(box):
    """Without a scene: the scenes of a folder, then the built-in ones that it does not have; all by the pad."""
    before = box.screen()
    box.view("", "--scenes /scenes --no-hud")
    for _ in range(100):
        time.sleep(0.2)
        if box.screen() != before:
            break
    sheet = box.screen()
    require(sheet != before, f"no scenes to choose from: {box.said()!r}")
    for key in ("right", "down", "left", "up"):  # round the top left four of three columns, back to cube.pray
        box.press(key)
        require(box.screen() != sheet, f"the key {key} leads to no other scene")
        sheet = box.screen()
    box.press("x")
    box.wait_for_picture(box.expected(os.path.join(box.work, "cube.pray")), 120)
    leave_by_pad(box)


def console_is_usable(box, how):
    before = box.screen()
    box.run("echo the console draws >/dev/tty1")
    time.sleep(0.5)
    require(box.screen() != before, f"the console does not draw after {how}")
    box.run("rm -f /tmp/typed; (read -r word </dev/tty1; echo $word >/tmp/typed) &")
    time.sleep(0.5)
    box.press("o", "k", "ret")
    time.sleep(0.5)
    require("ok" in box.run("cat /tmp/typed")[1], f"the keyboard does not reach the console after {how}")


def console_survives(box):
    for signal, statuses in (("TERM", (3,)), ("SEGV", (139,)), ("KILL", (137,))):
        box.view("cube")
        time.sleep(3 if box.slow else 1.5)
        box.run(f"kill -{signal} $(pidof pocketray | tr ' ' '\\n' | sort -n | head -n 1)")
        status = box.wait_for_end()
        require(status in statuses, f"after {signal} the exit status is {status}: {box.said()!r}")
        time.sleep(0.5)
        console_is_usable(box, signal)


def memory(box):
    box.check_one_line("pocketray render cube --size 32x24 --memory 500M -o /tmp/a.ppm", 1,
                       r"--memory is 500.0 MiB but the system has only .* free: try --memory \d+K")
    box.check_one_line("pocketray render statue --size 32x24 --memory 2M -o /tmp/a.ppm", 1, "try --memory|--memory [0-9]+M")
    # A full file system in memory: of a file, the old content stays, and one that it holds only the beginning of is refused.
    box.run("mkdir -p /small; mount -t tmpfs -o size=64k none /small; echo kept >/small/a.ppm; "
            "head -c 600 /scenes/cube.pray >/small/cut.pray; truncate -s $(wc -c </scenes/cube.pray) /small/cut.pray; "
            "cat /dev/zero >/small/fill 2>/dev/null")
    box.check_one_line("pocketray render /small/cut.pray --size 32x24 -o /tmp/a.ppm", 1, "damaged")
    box.check_one_line("pocketray render cube --size 64x48 -o /small/a.ppm", 1, "is the disk full")
    require(box.run("cat /small/a.ppm; umount /small")[1].strip() == "kept", "a failed write replaced the old file")
    # What is free is little, as the root file system takes it all.
    box.run("mkdir -p /most; mount -t tmpfs -o size=100% none /most; "
            "free=$(sed -n 's/^MemAvailable: *\\([0-9]*\\).*/\\1/p' /proc/meminfo); "
            "dd if=/dev/zero of=/most/fill bs=64k count=$(((free - 9000) / 64)) 2>/dev/null")
    box.check_one_line("pocketray view statue --no-hud", 1, r"needs .* MiB of memory|has only .* MiB free")
    require(box.run("pocketray render cube --size 32x24 -o /tmp/a.ppm")[0] == 0, "what fits does not run in what is left")
    require(box.run("pocketray render /scenes/cube.pray --size 32x24 -o /tmp/a.ppm")[0] == 0, "a file that fits does not run")
    box.run("umount /most")


def no_framebuffer(box):
    box.run("mv /dev/fb0 /dev/away")
    box.check_one_line("pocketray view cube", 1, "linux needs a framebuffer, /dev/fb0")
    box.run("mv /dev/away /dev/fb0")


class Server:
    """A render server on this machine, behind the link of a handheld."""

    def __init__(self, box, port=0):
        log = os.path.join(box.work, "server.log")
        self.process = subprocess.Popen([box.desktop, "serve", "--listen", f"127.0.0.1:{port}"],
                                        stdout=open(log, "w"), stderr=subprocess.STDOUT)
        for _ in range(600):
            match = re.search(r"^listening on [^ ]*:(\d+)", open(log).read(), re.M)
            if match:
                self.port = int(match[1])
                return
            time.sleep(0.1)
        self.stop()
        raise Failure("the server does not start: " + open(log).read())

    def stop(self):
        self.process.kill()
        self.process.wait()


def shared_frames(box):
    server = Server(box)
    link = ShapedLink(server.port, LINK_BITS_PER_SECOND, LINK_DELAY)
    address = f"--server 10.0.2.2:{link.port}"
    still = box.expected("cornell")
    try:
        # The first frame: rendered by the device alone, an ARM926 takes half a minute.
        box.view("cornell", f"--no-hud {address}")
        box.run("while [ ! -e /tmp/view.status ] && ! netstat -tn | grep -q ESTABLISHED; do usleep 100000; done", 120)
        box.wait_for_picture(still, 60)
        print(f"  {box.name}: {link.byte_count} bytes of the first frame came from the server", flush=True)
        require(link.byte_count > FRAME_BYTES_MIN, f"only {link.byte_count} bytes passed the link")
        # The server dies within a frame, comes back, and serves again.
        box.machine.hold("right", True)
        time.sleep(0.5)
        server.stop()
        box.machine.hold("right", False)
        box.press("ret")
        time.sleep(1)
        server = Server(box, server.port)
        box.run("n=0; until netstat -tn | grep -q ESTABLISHED || [ $n -gt 400 ]; do usleep 100000; n=$((n + 1)); done", 60)
        time.sleep(2)
        before = link.byte_count
        box.press("right", ms=200)
        box.press("ret")
        box.wait_for_picture(still, 60)
        require(link.byte_count > before + 10000, f"the restarted server sent only {link.byte_count - before} bytes")
        box.press("esc")
        require(box.wait_for_end() == 0, f"the viewer fails: {box.said()!r}")
    finally:
        server.stop()
        link.close()


CHECKS = (no_framebuffer, memory, keys, rotation, picker, console_survives, shared_frames, scenes_on_screen)


def check_machine(name, program, desktop, kernels, work):
    """Number of failed checks."""
    files = {"bin/pocketray": program, "scenes/cube.pray": os.path.join(work, "cube.pray")}
    buddha = os.path.join(work, "buddha.pray")
    if os.path.exists(buddha):
        files["buddha.pray"] = buddha
    log = os.path.join(work, name + ".log")
    arguments = arguments_of(name, kernels, os.path.join(work, name + ".gz"), files)
    failed = 0
    with Machine(qemu_of(name), arguments, log) as machine:
        machine.expect("^BOX READY", 180)
        for check in CHECKS:
            begin = time.monotonic()
            verdict = "passed"
            try:
                check(Box(machine, name, desktop, work))
            except (Failure, TimeoutError) as error:
                verdict = f"FAILED: {error}"
                failed += 1
                with contextlib.suppress(TimeoutError, OSError):  # for the next check
                    machine.run("killall -9 pocketray; umount /most /small; mv /dev/away /dev/fb0; echo")
            print(f"{name:10} {check.__name__:18} {time.monotonic() - begin:5.1f} s  {verdict}", flush=True)
    return failed


def main():
    desktop, kernels, models = sys.argv[1:4]
    machines = [argument.split("=", 1) for argument in sys.argv[4:]]
    failed = 0
    with tempfile.TemporaryDirectory(prefix="pocketray-box-") as work:
        baked = {"cube": "cube", "buddha": os.path.join(models, BUDDHA)}
        for name, scene in baked.items():
            if name == scene or os.path.exists(scene):
                subprocess.run([desktop, "bake", scene, "-o", os.path.join(work, name + ".pray")], check=True,
                               stdout=subprocess.DEVNULL)
        for name, program in machines:
            failed += check_machine(name, program, desktop, kernels, work)
    print(f"test-box: {failed} failed" if failed else "test-box: passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
