"""The guest's file system as a compressed newc archive, made without root, cpio or depmod."""
import gzip
import os
import re

FOLDERS = ("bin", "dev", "etc", "lib", "lib/modules", "proc", "root", "scenes", "sys", "tmp")


class Archive:
    def __init__(self):
        self.parts, self.count = [], 0

    def add(self, name, mode, data=b"", device=(0, 0)):
        self.count += 1
        encoded = name.encode() + b"\0"
        fields = (self.count, mode, 0, 0, 1, 0, len(data), 0, 0, *device, len(encoded), 0)
        head = b"070701" + b"".join(b"%08X" % field for field in fields) + encoded
        for part in (head, data):
            self.parts += [part, b"\0" * (-len(part) % 4)]

    def write(self, path):
        self.add("TRAILER!!!", 0)
        with gzip.GzipFile(path, "wb", 1, mtime=0) as file:
            file.write(b"".join(self.parts))


def read(path):
    with open(path, "rb") as file:
        return file.read()


def modules_in_order(folder, names):
    """Paths of these modules and all they depend on, in the order of loading. Built-in ones need none."""
    files = {}
    for path, _, found in os.walk(os.path.join(folder, "kernel")):
        files.update({name[:-3].replace("-", "_"): os.path.join(path, name) for name in found if name.endswith(".ko")})
    with open(os.path.join(folder, "modules.builtin")) as file:
        builtin = {os.path.basename(line.strip())[:-3].replace("-", "_") for line in file}
    order = []

    def take(name):
        name = name.replace("-", "_")
        if name in builtin or files.get(name) in order:
            return
        if name not in files:
            raise SystemExit(f"{folder} has no module {name}")
        depends = re.search(rb"\0depends=([^\0]*)\0", read(files[name]))
        for other in depends.group(1).decode().split(",") if depends else []:
            if other:
                take(other)
        order.append(files[name])

    for name in names:
        take(name)
    return order


def write_image(path, busybox, init, files, modules_folder=None, modules=()):
    """`files`: {path in the guest: file here}."""
    archive = Archive()
    for folder in FOLDERS:
        archive.add(folder, 0o40755)
    archive.add("dev/console", 0o20600, device=(5, 1))
    archive.add("dev/null", 0o20666, device=(1, 3))
    archive.add("bin/busybox", 0o100755, read(busybox))
    archive.add("bin/sh", 0o120777, b"busybox")
    archive.add("init", 0o100755, read(init))
    names = []
    for module in modules_in_order(modules_folder, modules) if modules else []:
        names.append(os.path.basename(module))
        archive.add("lib/modules/" + names[-1], 0o100644, read(module))
    archive.add("etc/modules", 0o100644, "".join(name + "\n" for name in names).encode())
    for target, source in files.items():
        archive.add(target, 0o100755, read(source))
    archive.write(path)
