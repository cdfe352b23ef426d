#!/usr/bin/env python3
"""Goal: a server's memory stops growing, however many clients have come and gone. Method: all places are taken at once from
as many addresses, with a frame each, so that every place's memory has been used; then connections that only say hello and
connections with a frame, from more addresses than the server remembers. The resident memory after 4 N connections is that
after N, up to what the system's counters are off by. As many descriptors are open afterwards as before.

Usage: reconnects.py PROGRAM
"""
import os, socket, sys, time

sys.dont_write_bytecode = True
from conformance import *

PLACES = 8
PAGE = os.sysconf("SC_PAGE_SIZE")
SLACK = 256 << 10  # chosen: Linux counts resident pages per thread, 64 at a time


def resident(server):
    with open("/proc/%d/statm" % server.process.pid) as file:
        return int(file.read().split()[1]) * PAGE


def descriptors(server):
    return len(os.listdir("/proc/%d/fd" % server.process.pid))


def connect(server, number):
    """From one of 300 loopback addresses."""
    create = socket.create_connection
    source = "127.0.%d.%d" % (1 + number % 300 // 200, 2 + number % 200)
    socket.create_connection = lambda where, timeout: create(where, timeout, source_address=(source, 0))
    try:
        return Device(server.address)
    finally:
        socket.create_connection = create


def bare(server, scene, number):
    connect(server, number).socket.close()


def with_frame(server, scene, number):
    device = connect(server, number)
    device.frame(scene, coding=0)
    device.socket.close()


def all_at_once(server, scene, number=0):
    """Takes all places, each with a frame, and leaves them."""
    devices = [connect(server, PLACES * number + i) for i in range(PLACES)]
    for device in devices:
        device.frame(scene, coding=0)
    check(connect(server, PLACES * number).error(b"")[0] == BUSY, "all places are taken")
    for device in devices:
        device.socket.close()


def wait_until_left(server, descriptor_count):
    end = time.time() + 10
    while descriptors(server) > descriptor_count and time.time() < end:
        time.sleep(.01)
    check(descriptors(server) == descriptor_count, "connections that ended are closed")


def main():
    server = Server(os.path.abspath(sys.argv[1]), "--clients", str(PLACES), memory="8M")
    try:
        open_before = descriptors(server)
        probe = Device(server.address)
        scene = list_scenes(probe)["cornell"]["hash"]
        probe.socket.close()
        wait_until_left(server, open_before)
        all_at_once(server, scene)
        for visit, count in ((bare, 250), (with_frame, 100), (all_at_once, 4)):
            sizes = []
            for numbers in (range(count), range(count, 4 * count)):
                for number in numbers:
                    visit(server, scene, number)
                    if visit == all_at_once:
                        wait_until_left(server, open_before)
                wait_until_left(server, open_before)
                sizes.append(resident(server))
            print("%s: %d KiB after %d, %d after %d" % (visit.__name__, sizes[0] >> 10, count, sizes[1] >> 10, 4 * count))
            check(sizes[1] <= sizes[0] + SLACK, "%s: memory stops growing" % visit.__name__)
    finally:
        server.end()
    print("%d failed" % len(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
