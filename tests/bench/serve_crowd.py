"""CPU time of a server between a well-behaved client's request and its last row beside attackers, over the time alone.
Each attacker connects from a loopback address of its own, from a new one each time, all from one, or all from the
client's; it repeats its kind of request, on one connection or on a new one each time. The client connects before the
attack (--first) or while it lasts.
Usage: serve_crowd.py [--kinds K,K...] [--addresses A,A...] [--clients N] [--attackers N] [--seconds S] [--first] PROGRAM"""
import argparse, errno, multiprocessing, os, selectors, socket, statistics, sys, time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "wire"))
sys.dont_write_bytecode = True
from device import *
from conformance import Server, list_scenes

GOOD = "127.0.7.7"
KINDS = ["views", "views-stay", "frames", "frames-stay", "light-frames", "given-up", "pings", "pings-stay", "fetches",
         "lists", "silent", "no-hello"]
ADDRESSES = ["own", "new", "one", "same"]


def demand(kind, scene, number):
    """What an attacker sends on a connection, and the type of the message that answers it last."""
    if kind.startswith("views"):
        return request(scene, VIEW_QUERY, width=640, height=480, measure=1), VIEW_ENTRY
    if kind.startswith("frames") or kind == "given-up":
        return request(scene, frame=number, width=1024, height=768, stated=0), None
    if kind == "light-frames":
        return request(scene, frame=number, width=160, height=120, stated=0), ROW_CHUNK
    if kind.startswith("pings"):
        return message(PING, struct.pack("<II", number, 65536)) * 8, PONG
    if kind == "fetches":
        return message(SCENE_FETCH, scene + struct.pack("<QI", 0, 65536)) * 8, SCENE_PIECE
    if kind == "lists":
        return message(SCENE_LIST, struct.pack("<H", 0)) * 64, SCENE_ENTRY
    return b"", None


class Attacker:
    def __init__(self, index, kind, addresses, server, scene):
        self.index, self.kind, self.addresses, self.server, self.scene = index, kind, addresses, server, scene
        self.stays = kind.endswith("-stay") or kind in ("silent", "fetches", "lists", "given-up")
        self.count = 0
        self.socket = None

    def source(self):
        if self.addresses == "same":
            return GOOD
        if self.addresses == "one":
            return "127.0.1.1"
        n = self.index + (self.count * 64 if self.addresses == "new" else 0)
        return "127.%d.%d.%d" % (1 + n // 62500 % 200, n // 250 % 250, 2 + n % 250)

    def connect(self):
        self.count += 1
        self.number = 0
        self.socket = socket.socket()
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self.socket.bind((self.source(), 0))
            self.socket.setblocking(False)
            self.socket.connect_ex(self.server)
        except OSError:
            pass
        self.bytes, self.answers, self.begun, self.asked = b"", 0, time.time(), 0
        self.out = b"" if self.kind == "no-hello" else hello()
        self.ask()

    def ask(self):
        self.number += 1
        data, self.last = demand(self.kind, self.scene, self.number)
        self.out += data
        self.asked = time.time()

    def close(self):
        self.socket.close()
        self.socket = None

    def step(self):
        if self.socket is None:
            return self.connect()
        try:
            if self.out:
                self.out = self.out[self.socket.send(self.out):]
        except BlockingIOError:
            pass
        except OSError as e:
            if e.errno != errno.ENOTCONN:
                return self.close()
        try:
            while True:
                data = self.socket.recv(1 << 18)
                if not data:
                    return self.close()
                self.bytes += data
        except BlockingIOError:
            pass
        except OSError as e:
            if e.errno != errno.ENOTCONN:
                return self.close()
        answered = False
        while len(self.bytes) >= 8 and len(self.bytes) >= 8 + int.from_bytes(self.bytes[1:4], "little"):
            answered = answered or self.bytes[0] == self.last
            self.bytes = self.bytes[8 + int.from_bytes(self.bytes[1:4], "little"):]
        late = time.time() - self.asked > (.15 if self.kind == "given-up" else .4)
        if not self.stays and (answered or (late and self.kind != "light-frames")):
            return self.close()
        if self.stays and (answered or self.kind == "given-up" and late) and not self.out:
            self.ask()


def attack(kind, addresses, count, server, scene):
    attackers = [Attacker(i, kind, addresses, server, scene) for i in range(count)]
    while True:
        for attacker in attackers:
            attacker.step()
        time.sleep(.001)


def cpu_ns(server):
    return time.clock_gettime_ns((~server.process.pid) << 3 | 2)


class Good(Device):
    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        create = socket.create_connection
        socket.create_connection = lambda where, timeout: create(where, timeout, source_address=(GOOD, 0))
        Device.__init__(self, address)
        socket.create_connection = create
        self.number = 0

    def timed(self, server, scene, height):
        """CPU milliseconds of the server until the last row."""
        begin, rows = cpu_ns(server), 0
        self.number += 1
        self.send(request(scene, frame=self.number, width=height * 4 // 3, height=height, largest=8, time=self.number * .01))
        while rows < height:
            kind, fields = self.receive()
            if kind != ROW_CHUNK:
                raise ConnectionError("answered by %s %s" % (kind, fields[:6]))
            rows += fields[4]
        return (cpu_ns(server) - begin) * 1e-6


def measure(o, kind, addresses):
    server = Server(o.program, "--clients", str(o.clients), *o.options.split(), memory="64M")
    probe = Device(server.address)
    scenes = list_scenes(probe)
    scene, other = scenes[o.scene]["hash"], scenes[o.attack_scene]["hash"]
    probe.socket.close()
    good = Good(server.address)
    alone = statistics.median(good.timed(server, scene, o.height) for _ in range(12))
    if not o.first:
        good.socket.close()
    host, port = server.address.rsplit(":", 1)
    crowd = multiprocessing.Process(target=attack, args=(kind, addresses, o.attackers, (host, int(port)), other))
    crowd.start()
    begin = time.time()
    frames, lost = [], 0
    if not o.first:
        time.sleep(o.wait)
        good = None
    start = time.time()
    while time.time() - start < o.seconds:
        at = time.time() - start
        try:
            good = good or Good(server.address)
            good.socket.settimeout(o.seconds)
            frames.append((at, good.timed(server, scene, o.height) / alone))
        except (OSError, ConnectionError, AssertionError, struct.error) as e:
            lost += 1
            good = None
            time.sleep(.05)
    crowd.kill()
    server.process.kill()
    server.process.wait()
    early = [f for t, f in frames if t < 1]
    late = [f for t, f in frames if t >= 1]
    show = lambda f: "%6.2f %6.2f %6.2f" % (statistics.median(f), statistics.mean(f), max(f)) if f else "     -      -      -"
    print("%-12s %-4s alone %6.1f ms; first second %s (%3d); then median, mean, max %s (%3d); lost %d" %
          (kind, addresses, alone, show(early), len(early), show(late), len(late), lost), flush=True)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--kinds", default=",".join(KINDS))
    options.add_argument("--addresses", default=",".join(ADDRESSES))
    options.add_argument("--clients", type=int, default=8)
    options.add_argument("--attackers", type=int, default=20)
    options.add_argument("--seconds", type=float, default=6)
    options.add_argument("--wait", type=float, default=.5)
    options.add_argument("--height", type=int, default=240)
    options.add_argument("--scene", default="cornell")
    options.add_argument("--attack-scene", default="statue")
    options.add_argument("--options", default="")
    options.add_argument("--first", action="store_true")
    options.add_argument("program")
    o = options.parse_args()
    for kind in o.kinds.split(","):
        for addresses in o.addresses.split(","):
            measure(o, kind, addresses)


if __name__ == "__main__":
    main()
