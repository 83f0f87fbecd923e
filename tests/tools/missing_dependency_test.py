# SPDX-License-Identifier: GPL-3.0-or-later
"""On a machine where something is missing, the configuration names all of it and the command that installs it.
Usage: missing_dependency_test.py CMAKE SOURCE"""
import subprocess
import sys
import tempfile

cmake, source = sys.argv[1:]


def configure(*options, pkg_config="/usr/bin/pkg-config"):
    with tempfile.TemporaryDirectory() as folder:
        said = subprocess.run([cmake, "-S", source, "-B", folder, "-G", "Ninja", f"-DPKG_CONFIG_EXECUTABLE={pkg_config}", *options],
                              capture_output=True, text=True, check=False)
        return said.returncode, " ".join(said.stderr.split())


# Without fmt and GTest nothing else is said to be missing, and the tests' share is named.
status, said = configure("-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON")
assert status != 0, said
assert "Missing: libfmt-dev, libgtest-dev. Run tools/setup test, which" in said, said
assert "Only the tests need libgtest-dev: -DTRISKIN_TESTS=OFF builds without." in said, said

# A pkg-config that knows no module: what the device side alone needs is two packages, neither cbc nor unicorn.
status, said = configure("-DTRISKIN_TESTS=OFF", "-DTRISKIN_GEOMETRY=OFF", pkg_config="/bin/false")
assert status != 0, said
assert "Missing: pkg-config, libusb-1.0-0-dev, libhidapi-dev. Run tools/setup, which" in said, said
print("what is missing is named with its remedy")
