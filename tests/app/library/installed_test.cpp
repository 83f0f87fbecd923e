// SPDX-License-Identifier: GPL-3.0-or-later
// Uses the installed package as others do: a C compiler with pkg-config, a CMake project, Python.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "flashed_sim.hpp"
#include "support/page_block.hpp"
#include "support/places.hpp"

namespace triskin {
namespace {

namespace fs = std::filesystem;
using test::FlashedSim;

const fs::path kHere = fs::path(test::source_folder()) / "tests/app/library";

// Returns the exit status and the output.
std::pair<int, std::string> shell(const FlashedSim& sim, const std::string& line) {
  const fs::path out = sim.folder() / "out";
  const int status = std::system(("(" + line + ") > '" + out.string() + "' 2>&1").c_str());
  return {WEXITSTATUS(status), read_file(out)};
}

fs::path install(const FlashedSim& sim) {
  const fs::path prefix = sim.folder() / "installed";
  const auto [status, text] =
      shell(sim, "cmake --install '" TRISKIN_BUILD "' --component library --prefix '" + prefix.string() + "'");
  EXPECT_EQ(status, 0) << text;
  return prefix;
}

constexpr const char* kWanted = "8 modules, 0 lost, module 5 taxel 3 pressed\n";

TEST(Installed, a_C_program_finds_it_by_pkg_config) {
  const FlashedSim sim;
  const std::string prefix = install(sim), lib = prefix + "/" TRISKIN_LIBDIR, program = sim.folder() / "program";
  const auto [built, text] =
      shell(sim, "PKG_CONFIG_PATH='" + lib +
                     "/pkgconfig' sh -c \"" TRISKIN_C_COMPILER " -std=c11 -Wall -Wextra -pedantic -Werror '" +
                     (kHere / "read_touch.c").string() + "' -o '" + program +
                     "' \\$(pkg-config --cflags --libs triskin) -lm\"");
  ASSERT_EQ(built, 0) << text;
  const auto [status, said] = shell(
      sim, "LD_LIBRARY_PATH='" + lib + "' '" + program + "' '" + sim.design_file() + "' '" + sim.scene_file() + "'");
  EXPECT_EQ(status, 0) << said;
  EXPECT_EQ(said, kWanted);
}

// The source is docs/examples/read_samples.cpp, which the pages show.
TEST(Installed, the_first_example_prints_the_pressed_taxel) {
  const FlashedSim sim("[]", true);
  const std::string prefix = install(sim), lib = prefix + "/" TRISKIN_LIBDIR, program = sim.folder() / "read_samples";
  const auto [built, text] =
      shell(sim, "PKG_CONFIG_PATH='" + lib +
                     "/pkgconfig' sh -c \"" TRISKIN_CXX_COMPILER " -std=c++17 -Wall -Wextra -pedantic -Werror '" +
                     test::source_folder() + "/docs/examples/read_samples.cpp' -o '" + program +
                     "' \\$(pkg-config --cflags --libs triskin)\"");
  ASSERT_EQ(built, 0) << text;
  const auto [status, said] = shell(sim, "LD_LIBRARY_PATH='" + lib + "' '" + program + "' '" + sim.design_file() +
                                             "' sim '" + sim.scene_file() + "'");
  EXPECT_EQ(status, 0) << said;
  EXPECT_NE(said.find("module 12 taxel 3 at ("), std::string::npos) << said;
  // The scene presses no other module.
  for (std::size_t at = 0, end = 0; (end = said.find('\n', at)) != std::string::npos; at = end + 1)
    EXPECT_EQ(said.compare(at, 16, "module 12 taxel "), 0) << said.substr(at, end - at);
}

TEST(Installed, a_CMake_project_finds_it_by_find_package) {
  const FlashedSim sim;
  const std::string prefix = install(sim), build = sim.folder() / "build";
  const auto [built, text] = shell(sim, "cmake -S '" + kHere.string() + "/project' -B '" + build +
                                            "' -DCMAKE_C_COMPILER='" TRISKIN_C_COMPILER "' -DCMAKE_PREFIX_PATH='" +
                                            prefix + "' && cmake --build '" + build + "'");
  ASSERT_EQ(built, 0) << text;
  const auto [status, said] =
      shell(sim, "'" + build + "/read_touch' '" + sim.design_file() + "' '" + sim.scene_file() + "'");
  EXPECT_EQ(status, 0) << said;
  EXPECT_EQ(said, kWanted);
}

// The Debian packages contain these files besides the program.
TEST(Installed, the_program_comes_with_pages_rules_and_completion) {
  const FlashedSim sim;
  const fs::path prefix = sim.folder() / "installed";
  const auto [status, text] =
      shell(sim, "cmake --install '" TRISKIN_BUILD "' --component program --prefix '" + prefix.string() + "'");
  ASSERT_EQ(status, 0) << text;
  const auto [said, version] = shell(sim, fmt::format("'{}' --version", (prefix / "bin/triskin").string()));
  EXPECT_EQ(said, 0) << version;
  for (const char* file : {"share/man/man1/triskin.1.gz", "share/man/man1/triskin-verify.1.gz",
                           "share/man/man1/triskin-repair.1.gz", "share/bash-completion/completions/triskin",
                           "lib/udev/rules.d/70-triskin.rules", "share/triskin/ros/triskin_msgs/package.xml"})
    EXPECT_TRUE(fs::exists(prefix / file)) << file;
  const fs::path doc = prefix / "share/doc" / TRISKIN_PACKAGE;
  for (const char* file : {"copyright", "changelog.gz", "docs/start.md", "examples/from_bare_boards.sh"})
    EXPECT_TRUE(fs::exists(doc / file)) << file;
}

#ifdef TRISKIN_PYTHON
TEST(Installed, Python_reads_a_served_simulation) {
  const FlashedSim sim("[]", true);
  if (std::system(TRISKIN_PYTHON " -c 'import numpy' > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "numpy is not installed; run tools/setup test";
  const auto [status, said] =
      shell(sim, "PYTHONPATH='" TRISKIN_PYTHON_FOLDER "' '" TRISKIN_PYTHON "' '" + (kHere / "read_test.py").string() +
                     "' '" + test::program_file() + "' '" + sim.design_file() + "' '" + sim.scene_file() + "'");
  EXPECT_EQ(status, 0) << said;
}

// The library comes with the wheel: nothing else of the environment knows of this build.
TEST(Installed, a_wheel_is_imported_in_a_virtual_environment) {
  const FlashedSim sim;
  const std::string venv = (sim.folder() / "venv").string();
  if (shell(sim, TRISKIN_PYTHON " -m venv --system-site-packages '" + venv + "'").first != 0)
    GTEST_SKIP() << "python3-venv is not installed; run tools/setup test";
  const auto [made, text] =
      shell(sim, "'" + venv + "/bin/pip' install --no-index --no-deps --config-settings=build='" TRISKIN_BUILD "' '" +
                     test::source_folder() + "'");
  ASSERT_EQ(made, 0) << text;
  const auto [status, said] = shell(sim, "cd / && '" + venv +
                                             "/bin/python' -c \"import triskin; print(triskin.__file__); "
                                             "print(triskin.simulate('" +
                                             sim.design_file() + "').modules)\"");
  EXPECT_EQ(status, 0) << said;
  EXPECT_TRUE(said.starts_with(venv)) << said;
  EXPECT_TRUE(said.ends_with("\n8\n")) << said;
}

// check_wheel.py uses the installed wheel without the tree.
void check_wheel(const char* part, const char* said) {
  const FlashedSim sim;
  if (std::system(TRISKIN_PYTHON " -m venv --help > /dev/null 2>&1 && " TRISKIN_PYTHON
                                 " -c 'import ensurepip, matplotlib, pandas' 2> /dev/null") != 0)
    GTEST_SKIP() << "python3-venv, python3-matplotlib or python3-pandas is not installed; run tools/setup test";
  const auto [status, text] =
      shell(sim, fmt::format("'{}' '{}' '{}' '{}' '{}' '{}' {}", TRISKIN_PYTHON, (kHere / "check_wheel.py").string(),
                             test::source_folder(), TRISKIN_BUILD, test::program_file(), sim.design_file(), part));
  EXPECT_EQ(status, 0) << text;
  EXPECT_TRUE(text.ends_with(said)) << text;
}

TEST(Installed, twelve_examples_run_from_the_wheel) {
  check_wheel("examples", "12 examples\n");
}

TEST(Installed, mypy_and_pyright_find_the_types_of_the_wheel_and_a_wrong_use) {
  const bool mypy = std::system("mypy --version > /dev/null 2>&1") == 0;
  const bool pyright = fs::exists(fs::path(test::source_folder()) / "build/npm/node_modules/pyright");
  if (!mypy && !pyright) GTEST_SKIP() << "neither mypy nor pyright is installed; run tools/setup test";
  check_wheel("types", mypy && pyright ? "asked mypy and pyright\n" : mypy ? "asked mypy\n" : "asked pyright\n");
}

TEST(Installed, the_notebook_runs) {
  if (std::system(TRISKIN_PYTHON " -c 'import nbclient, ipykernel' > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "python3-nbclient or python3-ipykernel is not installed; run tools/setup test";
  check_wheel("notebook", "the notebook runs\n");
}

// Debian's Python looks there, and packagers move it all by DESTDIR.
TEST(Installed, the_module_goes_where_the_Python_of_the_system_looks) {
  const FlashedSim sim;
  const std::string moved = (sim.folder() / "moved").string();
  const auto [status, text] =
      shell(sim, "DESTDIR='" + moved + "' cmake --install '" TRISKIN_BUILD "' --component python --prefix /usr/local");
  ASSERT_EQ(status, 0) << text;
  const auto [looked, folder] =
      shell(sim, TRISKIN_PYTHON " -c \"import sys; print(*[p for p in sys.path if p.startswith('/usr/local/lib')])\"");
  ASSERT_EQ(looked, 0) << folder;
  const auto [found, list] = shell(sim, "ls '" + moved + folder.substr(0, folder.find_first_of(" \n")) + "'");
  EXPECT_EQ(found, 0) << list;
  EXPECT_EQ(list, "triskin\n");
}

// Runs the script of the docs, from a surface to a plot.
TEST(Installed, the_hour_of_a_researcher_ends_with_a_plot) {
  const FlashedSim sim;
  if (std::system(TRISKIN_PYTHON " -c 'import numpy' > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "numpy is not installed; run tools/setup test";
  const fs::path folder = sim.folder() / "hour";
  fs::create_directories(folder);
  const auto [status, said] =
      shell(sim, "PYTHONPATH='" TRISKIN_PYTHON_FOLDER "' '" TRISKIN_PYTHON "' '" +
                     (fs::path(test::source_folder()) / "docs/examples/researcher_hour.py").string() + "' '" +
                     test::program_file() + "' '" + folder.string() + "'");
  EXPECT_EQ(status, 0) << said;
  const auto wanted = test::page_block("library.md", "[researcher_hour.py]");
  ASSERT_EQ(wanted.size(), 6U);
  EXPECT_EQ(test::missing_line(wanted, said), "") << said;
  const auto drawn = [&](const char* name) {
    return fs::exists(folder / name) && fs::file_size(folder / name) > 5'000;
  };
  EXPECT_TRUE(drawn("touch.svg") || drawn("touch.png")) << said;
}

// There are 30,840 taxels on 161 controllers in two served simulations.
TEST(Installed, Python_reads_161_controllers_for_a_minute) {
  const FlashedSim sim;
  const std::string one = sim.folder() / "one.json", two = sim.folder() / "two.json";
  design::write_design(one, test::strip(1296, 16));
  design::write_design(two, test::strip(1274, 16));
  const auto [status, said] =
      shell(sim, "PYTHONPATH='" TRISKIN_PYTHON_FOLDER "' '" TRISKIN_PYTHON "' '" + (kHere / "read_long.py").string() +
                     "' '" + test::program_file() + "' 60 '" + one + "' '" + two + "'");
  EXPECT_EQ(status, 0) << said;
  std::printf("%s", said.c_str());
}
#endif

}  // namespace
}  // namespace triskin
