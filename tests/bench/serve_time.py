"""Time that real servers take for a frame as the camera orbits, from its request to its last byte, over loopback to a
client that decodes nothing. Programs and numbers of threads are compared interleaved, with the first pair.
A PROGRAM may have others in front: "mpirun -n 2 build-mpi/pocketray".
Usage: serve_time.py [--scene NAME] [--threads N,N...] [--frames N] PROGRAM..."""
import argparse, math, os, shlex, statistics, struct, sys, time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "wire"))
sys.dont_write_bytecode = True
from device import *
from conformance import Server, list_scenes


WARM_FRAMES = 3


def orbited(camera, degrees):
    (ex, ey, ez), (tx, ty, tz) = camera["eye"], camera["target"]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return dict(camera, eye=(tx + c * (ex - tx) + s * (ez - tz), ey, tz - s * (ex - tx) + c * (ez - tz)))


def timed(device, scene, frame, camera, exposure):
    """Milliseconds to the first row and to the last, and bytes."""
    data = request(scene["hash"], frame=frame, stated=1, camera=camera, exposure=exposure, width=320, height=240,
                   largest=8)
    begin, rows, size, first = time.perf_counter(), 0, 0, None
    device.send(data)
    while rows < 240:
        kind, fields = device.receive()
        assert kind == ROW_CHUNK, "rows answer a request"
        first = first or time.perf_counter()
        rows, size = rows + fields[4], size + len(fields) + 8
    return (first - begin) * 1e3, (time.perf_counter() - begin) * 1e3, size


def view(device, name):
    """Scene, camera and exposure."""
    scene = list_scenes(device)[name]
    v = struct.unpack("<11fIffII6f", device.ask(request(scene["hash"], VIEW_QUERY), VIEW_ENTRY)[16:])
    return scene, dict(eye=v[0:3], target=v[3:6], up=v[6:9], fov=v[9], extent=v[10], projection=v[11]), v[12]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--scene", default="cornell")
    options.add_argument("--threads", default="0")
    options.add_argument("--frames", type=int, default=40)
    options.add_argument("programs", nargs="+")
    o = options.parse_args()
    pairs = [(program, threads) for program in o.programs for threads in o.threads.split(",")]
    servers, devices, views, times = [], [], [], [[] for _ in pairs]
    for program, threads in pairs:
        *under, path = shlex.split(program)
        servers.append(Server(path, "--coherence", "off", threads=threads, under=under))
        devices.append(Device(servers[-1].address))
        views.append(view(devices[-1], o.scene))
    for frame in range(1, WARM_FRAMES + o.frames + 1):
        for device, (scene, camera, exposure), frames in zip(devices, views, times):
            took = timed(device, scene, frame, orbited(camera, frame), exposure)
            if frame > WARM_FRAMES:
                frames.append(took)
    for (program, threads), frames in zip(pairs, times):
        first, last, size = (statistics.median(f[i] for f in frames) for i in range(3))
        ratio = statistics.median(a[1] / b[1] for a, b in zip(frames, times[0]))
        print("%s, %s thread%s: %.2f ms to the first row, %.2f to the last, %.3f of the first; %.1f kB" %
              (program, threads, "s"[threads == "1":], first, last, ratio, size / 1e3))
    for server in servers:
        server.end()


if __name__ == "__main__":
    main()
