"""The three emulated handhelds: a CPU class each, 64 or 128 MB of memory, a screen of 320×240, keys and a network card."""
import glob
import os

from guest_image import write_image

HERE = os.path.dirname(os.path.abspath(__file__))
CONSOLE = "console=ttyAMA0 quiet loglevel=3 panic=-1 cryptomgr.notests"
NETWORK = ["-netdev", "user,id=net"]
VIRT = ["-global", "virtio-mmio.force-legacy=false", "-device", "virtio-gpu-device,xres=320,yres=240",
        "-device", "virtio-keyboard-device", *NETWORK, "-device", "virtio-net-device,netdev=net"]
VIRT_MODULES = ("virtio_mmio", "virtio_gpu", "virtio_net", "virtio_input", "evdev")

# name: CPU class of the build, Debian's architecture, qemu and its arguments, memory in MB, format of the framebuffer
MACHINES = {
    "arm926": ("armel", "armel", "qemu-system-arm",
               ["-M", "versatilepb", "-cpu", "arm926", *NETWORK, "-device", "virtio-net-pci,romfile=,netdev=net"],
               64, "rgb565"),
    "cortex-a7": ("armhf", "armhf", "qemu-system-arm", ["-M", "virt", "-cpu", "cortex-a7", *VIRT], 128, "xrgb8888"),
    "aarch64": ("aarch64", "arm64", "qemu-system-aarch64", ["-M", "virt", "-cpu", "cortex-a53", *VIRT], 192, "xrgb8888"),
}


def qemu_of(name):
    return MACHINES[name][2]


def arguments_of(name, folder, image, files):
    """qemu's arguments to boot the machine; writes its file system to `image`, with `files` {path there: file here}."""
    _, architecture, _, board, megabytes, _ = MACHINES[name]
    root = os.path.join(folder, architecture)
    if name == "arm926":
        kernel, modules_folder, modules = os.path.join(folder, "arm926-kernel"), None, ()
        board = [*board, "-dtb", os.path.join(folder, "arm926.dtb")]
    else:
        kernel = glob.glob(os.path.join(root, "boot", "vmlinuz-*"))[0]
        modules_folder, modules = glob.glob(os.path.join(root, "lib", "modules", "*"))[0], VIRT_MODULES
    write_image(image, os.path.join(root, "bin", "busybox"), os.path.join(HERE, "init"), files, modules_folder, modules)
    return [*board, "-m", str(megabytes), "-kernel", kernel, "-initrd", image, "-append", CONSOLE]
