"""One emulated handheld: qemu with a serial line and a QMP socket. Python's standard library only."""
import ctypes
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time

PROMPT = "BOX DONE"  # the guest's shell prints it and the exit status after every line


def die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Machine:
    """Boots on creation. `arguments`: qemu's; `log`: file for everything the guest prints."""

    def __init__(self, qemu, arguments, log):
        self.folder = tempfile.mkdtemp(prefix="pocketray-box-")
        self.log = log
        serial, qmp = os.path.join(self.folder, "serial"), os.path.join(self.folder, "qmp")
        command = ["nice", "-n", "10", qemu, *arguments, "-display", "none", "-monitor", "none", "-no-reboot", "-nodefaults",
                   "-chardev", f"socket,id=serial,path={serial},server=on,wait=on,logfile={log}",
                   "-serial", "chardev:serial", "-qmp", f"unix:{qmp},server=on,wait=off"]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=open(log + ".qemu", "w"), preexec_fn=die_with_parent)
        self.text, self.mark, self.ended = "", 0, False
        self.news = threading.Condition()
        self.serial = self.dial(serial)
        # A serial socket that nobody reads stops the whole machine after a few hundred bytes.
        threading.Thread(target=self.drain, daemon=True).start()
        self.qmp_socket = self.dial(qmp)
        self.qmp_file = self.qmp_socket.makefile("rw")
        self.qmp_file.readline()
        self.qmp("qmp_capabilities")

    def dial(self, path):
        deadline = time.monotonic() + 30
        while True:
            connection = socket.socket(socket.AF_UNIX)
            try:
                connection.connect(path)
                return connection
            except OSError:
                connection.close()
                if self.process.poll() is not None or time.monotonic() > deadline:
                    raise RuntimeError("qemu did not start: " + open(self.log + ".qemu").read())
                time.sleep(0.02)

    def drain(self):
        while True:
            try:
                data = self.serial.recv(65536)
            except OSError:
                data = b""
            with self.news:
                self.text += data.decode("utf-8", "replace").replace("\r", "")
                self.ended = not data
                self.news.notify_all()
            if not data:
                return

    def qmp(self, name, **arguments):
        self.qmp_file.write(json.dumps({"execute": name, "arguments": arguments}) + "\n")
        self.qmp_file.flush()
        while True:
            answer = json.loads(self.qmp_file.readline())
            if "return" in answer:
                return answer["return"]
            if "error" in answer:
                raise RuntimeError(answer["error"])

    def expect(self, pattern, seconds):
        """Waits for the pattern on the serial line; later calls look only behind it."""
        deadline, expression = time.monotonic() + seconds, re.compile(pattern, re.M)
        with self.news:
            while True:
                match = expression.search(self.text, self.mark)
                if match:
                    self.mark = match.end()
                    return match
                left = deadline - time.monotonic()
                if self.ended or left <= 0:
                    raise TimeoutError(f"no {pattern!r} within {seconds} s; last: {self.text[-600:]!r}")
                self.news.wait(left)

    def run(self, line, seconds=300):  # a machine under load is slow, a healthy one never gets near
        """Runs a line in the guest's shell: exit status and what it printed."""
        begin = self.mark
        data = (line + "\n").encode()
        for i in range(0, len(data), 8):  # a UART's FIFO is 16 bytes deep
            self.serial.sendall(data[i:i + 8])
            time.sleep(0.004)
        match = self.expect(rf"^{PROMPT} (\d+)\n", seconds)
        echoed, _, printed = self.text[begin:match.start()].partition("\n")
        return int(match.group(1)), printed

    def press(self, *keys, ms=120):
        for key in keys:
            self.qmp("send-key", keys=[{"type": "qcode", "data": key}], **{"hold-time": ms})
            time.sleep(ms / 1000 + 0.1)

    def hold(self, key, down):
        self.qmp("input-send-event", events=[
            {"type": "key", "data": {"down": down, "key": {"type": "qcode", "data": key}}}])

    def screen(self):
        """(width, height, RGB bytes) of what the screen shows."""
        path = os.path.join(self.folder, "screen.ppm")
        self.qmp("screendump", filename=path)
        with open(path, "rb") as file:
            data = file.read()
        header = re.match(rb"P6\s+(\d+)\s+(\d+)\s+255\s", data)
        return int(header[1]), int(header[2]), data[header.end():]

    def close(self):
        try:
            self.qmp("quit")
        except (OSError, RuntimeError, ValueError):
            pass
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
