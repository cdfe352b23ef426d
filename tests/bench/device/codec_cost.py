#!/usr/bin/env python3
"""Counts what rows from a server cost: cycles to encode and to decode a pixel, estimated as bench_device.py does, of the
frames after the first.

  codec_cost.py armel build-armel/codec_cost build/pocketray [SCENE]...
"""
import glob
import os
import subprocess
import sys
import tempfile

import bench_device

FRAMES, WIDTH, HEIGHT = 4, 320, 240


def count(machine, program, plugin, folder, symbols, arguments):
    result = bench_device.Count()
    return result, int(bench_device.add_counted(result, machine, program, plugin, folder, symbols, arguments))


def main():
    if len(sys.argv) < 4 or sys.argv[1] not in bench_device.MACHINES:
        sys.exit(__doc__)
    machine, program, host = bench_device.MACHINES[sys.argv[1]], sys.argv[2], sys.argv[3]
    with tempfile.TemporaryDirectory() as folder:
        plugin = bench_device.build_plugin(folder)
        symbols = bench_device.symbols_of(program, machine[2])
        for scene in sys.argv[4:] or ["cornell", "statue"]:
            subprocess.run([host, "render", scene, "--orbit", "1", "--frames", f"0:{FRAMES}", "--size", f"{WIDTH}x{HEIGHT}",
                            "-o", os.path.join(folder, "frame.ppm")], check=True, stdout=subprocess.DEVNULL)
            frames = sorted(glob.glob(os.path.join(folder, "frame-*.ppm")))
            for pixels in ("565", "888"):
                def cost(decodes, files):
                    return count(machine, program, plugin, folder, symbols, [pixels, str(decodes), *files])[0]
                # What reading the frames and coding the first one takes is subtracted.
                read = cost(0, frames[:1] * 2).cycles - cost(0, frames[:1]).cycles
                pixel_count = WIDTH * HEIGHT * (len(frames) - 1)
                encode = (cost(0, frames).cycles - cost(0, frames[:1]).cycles) / pixel_count
                both = (cost(1, frames).cycles - cost(1, frames[:1]).cycles) / pixel_count
                encode_unchanged = read / (WIDTH * HEIGHT)
                size = count(machine, program, plugin, folder, symbols, [pixels, "0", *frames])[1]
                print(f"{sys.argv[1]}, {scene}, RGB{pixels}: {size} bytes a frame, cycles a pixel: {encode:.0f} to encode "
                      f"(of which {encode_unchanged:.0f} to read the file and an unchanged frame), {both - encode:.0f} to decode")


if __name__ == "__main__":
    main()
