// SPDX-License-Identifier: GPL-3.0-or-later
// The contract counter must find what has a contract, what lacks one, and who throws.
#include <gtest/gtest.h>

#include "tools/scratch_tree.hpp"

namespace triskin::tests {
namespace {

class Contracts : public ScratchTree {
 protected:
  Ran with_header(const std::string& declarations) {
    write("host/core/base/include/triskin/host/a.hpp", "#pragma once\nnamespace triskin {\n" + declarations + "\n}\n");
    return tool("check_contracts", "--check --list");
  }
};

TEST_F(Contracts, accepts_purpose_and_result) {
  const Ran ran = with_header("/// Number of rows in the table.\nint rows(int table);");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
}

TEST_F(Contracts, refuses_a_function_without_comment) {
  const Ran ran = with_header("// not a contract\nint rows(int table);");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("a.hpp:4: rows: no contract"), std::string::npos) << ran.output;
}

TEST_F(Contracts, refuses_a_length_without_unit) {
  EXPECT_EQ(with_header("/// Grows the outline of a piece.\nvoid grow(double distance);").exit_status, 1);
  EXPECT_EQ(with_header("/// Grows the outline of a piece.\nvoid grow(double distance_mm);").exit_status, 0);
  EXPECT_EQ(with_header("/// Grows the outline by `distance` in mm.\nvoid grow(double distance);").exit_status, 0);
}

TEST_F(Contracts, refuses_a_bool_that_is_not_explained) {
  EXPECT_EQ(with_header("/// Sends one frame.\nbool send(int frame);").exit_status, 1);
  EXPECT_EQ(with_header("/// Sends one frame. False: the queue is full.\nbool send(int frame);").exit_status, 0);
}

TEST_F(Contracts, refuses_a_status_that_is_not_explained) {
  EXPECT_EQ(with_header("/// Sends one frame now.\nStatus send(int frame);").exit_status, 1);
  EXPECT_EQ(with_header("/// Sends one frame now; kBusy: the queue is full.\nStatus send(int frame);").exit_status, 0);
  EXPECT_EQ(with_header("/// Oldest frame received.\nstd::optional<int> receive();").exit_status, 1);
  EXPECT_EQ(with_header("/// Oldest frame received; empty: none came.\nstd::optional<int> receive();").exit_status, 0);
}

TEST_F(Contracts, finds_who_throws_through_helpers_of_the_same_file) {
  write(
      "host/core/base/src/a.cpp",
      "namespace triskin {\nnamespace {\nvoid refuse() { throw 1; }\n}\nint rows(int t) { refuse(); return t; }\n}\n");
  const Ran ran = with_header("/// Number of rows in the table.\nint rows(int table);");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("rows: what it throws"), std::string::npos) << ran.output;
  EXPECT_EQ(with_header("/// Number of rows. Throws InputError: no table.\nint rows(int table);").exit_status, 0);
}

TEST_F(Contracts, counts_only_public_functions_that_are_declared_here) {
  const Ran ran = with_header(
      "class Port {\n public:\n  virtual ~Port() = default;\n  Port(const Port&) = delete;\n"
      "  /// Sends what is queued.\n  virtual void send();\n\n private:\n  void hidden();\n};\n"
      "class Usb : public Port {\n public:\n  void send() override;\n  std::function<int(int)> member;\n};\n"
      "namespace detail {\nvoid inner();\n}\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
  EXPECT_NE(ran.output.find("host/core/base                   1     1"), std::string::npos) << ran.output;
}

TEST_F(Contracts, takes_the_comment_behind_a_body_and_the_one_of_an_overload) {
  const Ran ran = with_header(
      "struct Span {\n  int begin() const { return a; }  ///< first index inside\n  int a = {0};\n"
      "  /// Whether `x` lies inside.\n  bool holds(int x) const;\n  bool holds(long x) const;\n};\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
}

TEST_F(Contracts, counts_a_member_once_that_is_defined_behind_its_class) {
  const Ran ran = with_header(
      "struct Row {\n  /// Sum of the columns.\n  int sum() const;\n};\ninline int Row::sum() const { return 1; }\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
  EXPECT_NE(ran.output.find("host/core/base                   1     1"), std::string::npos) << ran.output;
}

TEST_F(Contracts, ends_with_an_error_where_there_is_nothing_to_count) {
  EXPECT_EQ(tool("check_contracts", "--check").exit_status, 2);
}

}  // namespace
}  // namespace triskin::tests
