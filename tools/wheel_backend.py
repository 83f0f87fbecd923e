# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the Python module as a wheel (PEP 517), so that `pip install .` works in a virtual environment. It needs what
docs/packages.md names and nothing from the network. The module is for the interpreter it is built with (TRISKIN_PYTHON,
/usr/bin/python3). With --config-settings=build=FOLDER the module in that build folder is taken as it is."""
import base64
import hashlib
import pathlib
import re
import subprocess
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRESET = "robot"


def get_requires_for_build_wheel(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version = re.search(r"project\(triskin VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    folder = (config_settings or {}).get("build")
    if folder is None:
        folder = ROOT / "build" / PRESET
        subprocess.run(["cmake", "--preset", PRESET], cwd=ROOT, check=True)
        subprocess.run(["cmake", "--build", "--preset", PRESET, "--target", "triskin_library", "triskin_python"], cwd=ROOT, check=True)
    with tempfile.TemporaryDirectory() as stage:
        for component in ("library", "python"):
            subprocess.run(["cmake", "--install", str(folder), "--component", component, "--prefix", stage], check=True)
        stage = pathlib.Path(stage)
        [package] = stage.glob("lib/python*/dist-packages/triskin")
        [library] = [file for file in stage.rglob("libtriskin.so.*") if re.fullmatch(r"libtriskin\.so\.\d+", file.name)]
        return write(pathlib.Path(wheel_directory), version, package, library)


def write(folder, version, package, library):
    """The module finds its library three folders up, in lib of the environment, where `data` goes."""
    [module] = package.glob("_core.*.so")
    python, platform = re.fullmatch(r"_core\.cpython-(\d+)-(.*)-gnu\.so", module.name).groups()
    python, platform = "cp" + python, platform.replace("-", "_").replace("x86_64_linux", "linux_x86_64").replace("aarch64_linux", "linux_aarch64")
    name, info = f"triskin-{version}-{python}-{python}-{platform}.whl", f"triskin-{version}.dist-info"
    files = {**{f"triskin/{file.name}": file.read_bytes() for file in sorted(package.iterdir()) if file.is_file()},
             f"triskin-{version}.data/data/lib/{library.name}": library.read_bytes(),
             f"{info}/METADATA": (f"Metadata-Version: 2.1\nName: triskin\nVersion: {version}\nSummary: Samples of robot skin as numpy arrays\n"
                                  "License: GPL-3.0-or-later\nRequires-Dist: numpy\n").encode(),
             f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: triskin\nRoot-Is-Purelib: false\nTag: {python}-{python}-{platform}\n".encode(),
             f"{info}/licenses/LICENSE": (ROOT / "LICENSE").read_bytes()}
    rows = [f"{path},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},{len(data)}"
            for path, data in files.items()]
    files[f"{info}/RECORD"] = ("\n".join([*rows, f"{info}/RECORD,,"]) + "\n").encode()
    with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            wheel.writestr(path, data)
    return name
