#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what an image takes and fails above a ceiling. Usage: check_image_size.py SIZE_PROGRAM ELF FLASH_BYTES RAM_BYTES"""
import pathlib
import subprocess
import sys


def main(size_program: str, elf: str, flash_ceiling: int, ram_ceiling: int) -> int:
    flash = ram = code = 0
    for line in subprocess.run([size_program, "-A", elf], check=True, capture_output=True, text=True).stdout.splitlines():
        fields = line.split()
        if len(fields) != 3 or not fields[2].isdigit():
            continue
        size, address = int(fields[1]), int(fields[2])
        if 0x08000000 <= address < 0x08080000:
            flash += size
        elif 0x10000000 <= address < 0x10008000:  # code in the CCM RAM, loaded from flash
            code += size
            flash += size if fields[0] == ".code" else 0
        elif 0x20000000 <= address < 0x20018000:
            ram += size
            flash += size if fields[0] == ".data" else 0
    name = pathlib.Path(elf).name
    print(f"{name}: flash {flash} of {flash_ceiling} bytes, RAM with stack {ram} of {ram_ceiling} bytes"
          + (f", code in RAM {code} of 32768" if code else ""))
    if flash > flash_ceiling or ram > ram_ceiling:
        print(f"{name}: above its ceiling; make it smaller or raise the ceiling in firmware/board/stm32/image.cmake with a reason",
              file=sys.stderr)
        pathlib.Path(elf).unlink()
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])))
