#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes vmlinux and initramfs.cpio of the test machine from Debian's stock kernel package. Usage: make_image.py OUTPUT_FOLDER"""
import gzip
import lzma
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys

# vcan, ISO-TP, a queue with a bit rate and losses; USB devices over a socket, HID; the file systems of the host.
MODULES = ("vcan vxcan can-raw can-isotp sch-netem vhci-hcd usbhid hid-generic virtio_pci 9pnet_virtio 9p").split()
APPLETS = "sh mount mkdir modprobe cat cut echo ip ln poweroff dd printf chroot cp ls sleep sed tr".split()
HERE = pathlib.Path(__file__).resolve().parent


def run(*command: str, cwd=None) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"make_image: {' '.join(command)} failed: {done.stderr.strip()}")
    return done.stdout


def fetch_kernel(work: pathlib.Path) -> pathlib.Path:
    """Unpacks the kernel that linux-image-amd64 stands for; the package is kept, so that the second run needs no network."""
    packages = sorted(work.glob("linux-image-*.deb"))
    if not packages:
        depends = run("apt-cache", "depends", "linux-image-amd64")
        found = re.search(r"Depends: (linux-image-\S+)", depends)
        if not found:
            sys.exit("make_image: apt knows no linux-image-amd64; run apt-get update")
        run("apt-get", "-qq", "-o", "Acquire::Retries=3", "download", found.group(1), cwd=work)
        packages = sorted(work.glob("linux-image-*.deb"))
    root = work / "kernel"
    if not root.exists():
        run("dpkg", "-x", str(packages[-1]), str(work / "unpacking"))
        (work / "unpacking").rename(root)
    return root


def unpack_vmlinux(image: bytes) -> bytes:
    """Returns the payload of a bzImage (Linux documentation, x86/boot), which QEMU starts much sooner than it unpacks itself."""
    setup_sectors = image[0x1F1] or 4
    offset, length = struct.unpack_from("<II", image, 0x248)
    start = (setup_sectors + 1) * 512 + offset
    payload = image[start : start + length]
    if payload[:6] == b"\xfd7zXZ\0":
        return lzma.LZMADecompressor(lzma.FORMAT_XZ).decompress(payload)
    if payload[:2] == b"\x1f\x8b":
        return gzip.decompress(payload)
    sys.exit("make_image: the kernel is packed with an unknown method; only xz and gzip are known")


def copy_modules(kernel: pathlib.Path, root: pathlib.Path) -> None:
    folder = next((kernel / "lib/modules").iterdir())
    run("depmod", "-b", str(kernel), folder.name)
    depends = {}
    for line in (folder / "modules.dep").read_text().splitlines():
        name, _, needs = line.partition(":")
        depends[name] = needs.split()
    by_name = {pathlib.Path(p).name.split(".")[0].replace("_", "-"): p for p in depends}
    for module in MODULES:
        path = by_name.get(module.replace("_", "-"))
        if path is None:
            sys.exit(f"make_image: the kernel has no module {module}")
        for each in [path, *depends[path]]:
            target = root / "lib/modules" / folder.name / each
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(folder / each, target)
    for name in ("modules.order", "modules.builtin"):
        shutil.copy(folder / name, root / "lib/modules" / folder.name / name)
    run("depmod", "-b", str(root), folder.name)


def main(work: pathlib.Path) -> None:
    work.mkdir(parents=True, exist_ok=True)
    kernel = fetch_kernel(work)
    vmlinux = work / "vmlinux"
    if not vmlinux.exists():
        vmlinux.write_bytes(unpack_vmlinux(next((kernel / "boot").glob("vmlinuz-*")).read_bytes()))
    root = work / "root"
    shutil.rmtree(root, ignore_errors=True)
    for folder in ("bin", "sbin", "dev", "proc", "sys", "run", "tmp", "mnt"):
        (root / folder).mkdir(parents=True)
    shutil.copy("/bin/busybox", root / "bin/busybox")
    for applet in APPLETS:
        (root / "bin" / applet).symlink_to("busybox")
    (root / "sbin/modprobe").symlink_to("../bin/busybox")
    copy_modules(kernel, root)
    shutil.copy(HERE / "init", root / "init")
    os.chmod(root / "init", 0o755)
    names = "\n".join(sorted(str(p.relative_to(root)) for p in root.rglob("*")))
    with open(work / "initramfs.cpio", "wb") as out:
        subprocess.run(["cpio", "-o", "-H", "newc", "--quiet", "--owner", "0:0"], cwd=root, input=names.encode(), stdout=out, check=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
