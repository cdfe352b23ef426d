"""Resident memory of a server after that many connections, each of which says hello, asks for a view and a small frame,
and leaves; the growth between the first thousand and the last must end.
Usage: serve_memory.py [--connections N,N...] PROGRAM"""
import argparse, os, sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "wire"))
sys.dont_write_bytecode = True
from device import *
from conformance import Server, list_scenes


def resident_kib(server):
    with open("/proc/%d/statm" % server.process.pid) as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--connections", default="0,1000,5000,10000,20000,40000")
    options.add_argument("--bare", action="store_true", help="say hello and leave")
    options.add_argument("program")
    o = options.parse_args()
    server = Server(o.program, memory="64M")
    first = Device(server.address)
    scene = list_scenes(first)["cube"]["hash"]
    first.socket.close()
    count = 0
    for goal in map(int, o.connections.split(",")):
        while count < goal:
            device = Device(server.address)
            if not o.bare:
                device.frame(scene, width=16, height=12)
            device.socket.close()
            count += 1
        print("%6d connections: %d KiB" % (count, resident_kib(server)), flush=True)
    server.end()


if __name__ == "__main__":
    main()
