#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the factory file with a foreign program. Usage: factory_file_test.py OBJCOPY

The hex file is turned into bytes by objcopy and must be the bin file; loader, application and commit record must lie
where docs/flash_layout.md has them, and nowhere else anything may be written: what is filled up with FF would count as
programmed on the chip, and tables could not be stored there."""
import binascii
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BASE, SLOT, RECORD = 0x08000000, 0x08004000, 0x0803F800


def main(objcopy: str) -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        loader, application = bytes(range(256)) * 3, bytes(reversed(range(256))) * 300 + b"\x01\x02\x03"
        (folder / "loader.bin").write_bytes(loader)
        (folder / "application.bin").write_bytes(application)
        pins = ROOT / "firmware/board/stm32g474/boards/nucleo_g474re/triskin/board/board_config.hpp"
        subprocess.run([sys.executable, str(ROOT / "tools/make_factory_file"), str(folder / "loader.bin"),
                        str(folder / "application.bin"), f"{SLOT:#x}", str(folder / "factory"), "1.2.3", str(pins), str(ROOT / "firmware/board/stm32g474")], check=True)
        subprocess.run([objcopy, "-I", "ihex", "-O", "binary", "--gap-fill", "0xFF", str(folder / "factory.hex"),
                        str(folder / "read.bin")], check=True)
        flat, read = (folder / "factory.bin").read_bytes(), (folder / "read.bin").read_bytes()
        assert read == flat, "objcopy reads other bytes from the hex file than the bin file has"
        image = application + b"\xff" * 5
        record = flat[RECORD - BASE:]
        assert flat[:len(loader)] == loader and flat[SLOT - BASE:SLOT - BASE + len(image)] == image
        head = b"COMM" + (1).to_bytes(4, "little") + len(image).to_bytes(4, "little")
        assert record == head + binascii.crc32(head + image).to_bytes(4, "little"), record.hex()
        assert set(flat[SLOT - BASE + len(image):RECORD - BASE]) == {0xFF}
        written = sum(int(line[1:3], 16) for line in (folder / "factory.hex").read_text().splitlines() if line[7:9] == "00")
        assert written == len(loader) + len(image) + len(record), "the hex file writes what is no part"
        manifest = json.loads((folder / "factory.json").read_text())
        assert manifest["version"] == "1.2.3" and {8, 16, 24, 25} <= set(manifest["crystals_MHz"])
        assert manifest["pins"]["CanReceive"] == "PB8", manifest["pins"]
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
