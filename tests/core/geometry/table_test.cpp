// SPDX-License-Identifier: GPL-3.0-or-later
// Tables are numbered by one kind of index; integers fit as well, other kinds do not compile.
#include "triskin/geometry/table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <type_traits>
#include <vector>

#include "triskin/layout/index.hpp"

namespace triskin::geometry {
namespace {

using Face = layout::Index<struct FaceTag>;
using Vertex = layout::Index<struct VertexTag>;
using Faces = Table<Face, Triple<int>>;
using Vertices = Table<Vertex, std::string>;

template <class Container, class Key>
constexpr bool takes = requires(Container table, Key key) { table[key]; };

static_assert(takes<Faces, Face> && takes<const Faces, Face> && takes<Faces, int> && takes<Faces, std::size_t>);
static_assert(!takes<Faces, Vertex> && !takes<Vertices, Face> && !takes<Faces, double>);
static_assert(takes<Table<int, int>, Face> && takes<Triple<int>, Face>);
// A copy of a whole vector has to be asked for; one that is given away is taken.
static_assert(!std::is_convertible_v<const std::vector<int>&, Table<int, int>>);
static_assert(std::is_convertible_v<std::vector<int>, Table<int, int>>);

TEST(Table, finds_the_corners_of_a_face_without_casts) {
  const Vertices vertices{"a", "b", "c", "d"};
  Faces faces;
  faces.push_back({0, 1, 2});
  faces.push_back({1, 3, 2});
  EXPECT_EQ(vertices[faces[Face(1)][1]], "d");
  EXPECT_EQ(vertices[faces[0][2]], "c");
  faces[Face(1)][0] = 3;
  EXPECT_EQ(faces[1], Triple<int>(3, 3, 2));
  EXPECT_EQ(faces.end_key(), Face(2));
}

TEST(Table, holds_flags_as_a_vector_does) {
  Table<Face, bool> seen(3, false);
  seen[Face(1)] = true;
  EXPECT_EQ(std::ranges::count(seen, true), 1);
  EXPECT_TRUE(seen[1]);
}

TEST(Triple, starts_at_zero_and_unpacks) {
  EXPECT_EQ(Triple<double>(), Triple<double>(0.0, 0.0, 0.0));
  const auto [x, y, z] = Triple<int>(4, 5, 6);
  EXPECT_EQ(100 * x + 10 * y + z, 456);
}

#ifndef NDEBUG
TEST(TableDeathTest, ends_the_program_outside_its_bounds) {
  Table<int, int> table(2);
  EXPECT_DEATH((void)table[2], "");
  EXPECT_DEATH((void)table[-1], "");
  Triple<int> triple;
  EXPECT_DEATH((void)triple[3], "");
}
#endif

}  // namespace
}  // namespace triskin::geometry
