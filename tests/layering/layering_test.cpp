// SPDX-License-Identifier: GPL-3.0-or-later
// The layering check must accept this tree and refuse each kind of forbidden include.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/places.hpp"

namespace {

namespace fs = std::filesystem;

int run_check(const fs::path& root, const std::string& links = "") {
  const std::string command = "python3 " + triskin::test::source_folder() + "/tools/check_layering.py " +
                              root.string() + " " + links + " > /dev/null";
  return std::system(command.c_str());
}

class Layering : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "layering.XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
  }
  void TearDown() override { fs::remove_all(root_); }

  int with_file(const std::string& path, const std::string& line) {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << line << '\n';
    return run_check(root_);
  }
  // `links` has lines "target: linked libraries", as the build writes them.
  int with_links(const std::string& links) {
    const fs::path file = root_ / "links.txt";
    std::ofstream(file) << links;
    return run_check(root_, file.string());
  }

 private:
  fs::path root_;
};

TEST_F(Layering, accepts_this_tree) {
  EXPECT_EQ(run_check(triskin::test::source_folder()), 0);
}

TEST_F(Layering, accepts_an_allowed_include) {
  EXPECT_EQ(with_file("firmware/logic/src/a.cpp", "#include \"triskin/drivers/ad7147.hpp\""), 0);
}

TEST_F(Layering, refuses_firmware_that_includes_host) {
  EXPECT_NE(with_file("firmware/app/src/a.cpp", "#include \"triskin/link/link.hpp\""), 0);
}

TEST_F(Layering, refuses_host_that_includes_firmware) {
  EXPECT_NE(with_file("host/device/link/src/a.cpp", "#include \"triskin/logic/sampling/sampler.hpp\""), 0);
}

TEST_F(Layering, refuses_logic_that_includes_a_board) {
  EXPECT_NE(with_file("firmware/logic/src/a.cpp", "#include \"triskin/board/posix.hpp\""), 0);
}

TEST_F(Layering, refuses_an_application_that_includes_the_loader) {
  EXPECT_NE(with_file("firmware/app/src/a.cpp", "#include \"triskin/boot/slot_store.hpp\""), 0);
}

TEST_F(Layering, refuses_a_command_that_reads_a_stream_by_itself) {
  EXPECT_EQ(with_file("host/device/skin/src/a.cpp", "#include \"triskin/session/stream.hpp\""), 0);
  EXPECT_NE(with_file("host/app/cli/src/a.cpp", "#include \"triskin/session/stream.hpp\""), 0);
}

TEST_F(Layering, refuses_a_command_that_discovers_controllers_by_itself) {
  EXPECT_EQ(with_file("host/device/skin/src/a.cpp", "  claims_ = bus_->discover();"), 0);
  EXPECT_NE(with_file("host/app/library/src/a.cpp", "  const auto claims = bus.discover();"), 0);
}

TEST_F(Layering, private_headers_are_for_the_tests_of_their_part) {
  EXPECT_EQ(with_file("host/plan/lattice/src/net.hpp", "#pragma once"), 0);
  EXPECT_EQ(with_file("tests/plan/lattice/a.cpp", "#include \"net.hpp\""), 0);
  EXPECT_NE(with_file("tests/plan/mesh/a.cpp", "#include \"net.hpp\""), 0);
}

TEST_F(Layering, a_test_of_another_part_names_the_place_of_a_private_header) {
  EXPECT_EQ(with_file("host/plan/lattice/src/net.hpp", "#pragma once"), 0);
  EXPECT_EQ(with_file("tests/plan/mesh/a.cpp", "#include \"plan/lattice/src/net.hpp\""), 0);
}

TEST_F(Layering, a_header_that_no_other_part_uses_is_private) {
  EXPECT_NE(with_file("host/plan/mesh/include/triskin/mesh/bvh.hpp", "#pragma once"), 0);
  EXPECT_EQ(with_file("host/plan/lattice/src/a.cpp", "#include \"triskin/mesh/bvh.hpp\""), 0);
  EXPECT_NE(with_file("host/plan/mesh/include/triskin/mesh/box.hpp", "#pragma once"), 0);
  EXPECT_EQ(with_file("host/plan/mesh/include/triskin/mesh/bvh.hpp", "#include \"triskin/mesh/box.hpp\""), 0);
}

TEST_F(Layering, refuses_vendor_headers_outside_the_board) {
  EXPECT_NE(with_file("firmware/logic/src/a.cpp", "#include <stm32g474xx.h>"), 0);
}

TEST_F(Layering, refuses_geometry_that_knows_devices) {
  EXPECT_NE(with_file("host/plan/lattice/src/a.cpp", "#include \"triskin/wire/uds.hpp\""), 0);
}

TEST_F(Layering, refuses_a_checker_that_uses_a_solver) {
  EXPECT_NE(with_file("host/plan/check/src/a.cpp", "#include \"triskin/routing/routing.hpp\""), 0);
}

TEST_F(Layering, refuses_an_upward_arrow_inside_the_geometry) {
  EXPECT_EQ(with_file("host/plan/lattice/src/a.cpp", "#include \"triskin/mesh/surface.hpp\""), 0);
  EXPECT_NE(with_file("host/plan/mesh/src/a.cpp", "#include \"triskin/lattice/grow_lattice.hpp\""), 0);
}

// A table with a cycle is refused, even if no include uses it yet.
TEST_F(Layering, refuses_a_circle_in_the_table) {
  const std::string tool = triskin::test::source_folder() + "/tools/check_layering.py";
  std::ifstream file(tool);
  std::string table((std::istreambuf_iterator<char>(file)), {});
  const std::string row = R"(Part("host/plan/mesh", "mesh", ")";
  const std::size_t at = table.find(row);
  ASSERT_NE(at, std::string::npos);
  table.insert(at + row.size(), "lattice ");
  const fs::path changed = fs::temp_directory_path() / "check_layering_with_a_circle.py";
  std::ofstream(changed) << table;
  EXPECT_NE(
      std::system(("python3 " + changed.string() + " " + triskin::test::source_folder() + " > /dev/null").c_str()), 0);
  fs::remove(changed);
}

TEST_F(Layering, refuses_relative_includes) {
  EXPECT_NE(with_file("shared/include/triskin/core/a.hpp", "#include \"../../../host/x.hpp\""), 0);
}

TEST_F(Layering, refuses_a_device_side_that_includes_the_simulation) {
  EXPECT_NE(with_file("host/device/link/src/a.cpp", "#include \"triskin/hardware/scene.hpp\""), 0);
}

TEST_F(Layering, scans_tools) {
  EXPECT_NE(with_file("tools/machine/src/a.cpp", "#include \"triskin/logic/sampling/sampler.hpp\""), 0);
}

TEST_F(Layering, refuses_a_library_outside_its_part) {
  EXPECT_EQ(with_file("host/plan/mesh/src/a.cpp", "#include <CGAL/Surface_mesh.h>"), 0);
  EXPECT_NE(with_file("host/core/design/src/a.cpp", "#include <CGAL/Surface_mesh.h>"), 0);
}

TEST_F(Layering, refuses_an_include_prefix_in_two_parts) {
  EXPECT_NE(with_file("shared/include/triskin/boot/a.hpp", ""), 0);
}

TEST_F(Layering, follows_links_through_other_targets) {
  EXPECT_EQ(with_links("triskin_deploy: triskin_session\ntriskin_session: triskin_link\ntriskin_link: triskin_base\n"),
            0);
  EXPECT_NE(with_links(
                "triskin_deploy: triskin_session\ntriskin_session: triskin_hardware\ntriskin_hardware: triskin_base\n"),
            0);
  EXPECT_NE(with_links("triskin_deploy: triskin_session\ntriskin_session: CGAL::CGAL\n"), 0);
}

}  // namespace
