// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a face and a vertex of a mesh, and a face of a CAD part, cannot be taken for each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <concepts>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "triskin/cad/select_faces.hpp"
#include "triskin/mesh/side.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

using design::BrepFaceIndex;

template <class Index>
concept CanNameAFace = requires(const Surface& surface, Index index) { surface.face_normal(index); };
template <class Index>
concept CanNameAVertex = requires(const Surface& surface, Index index) { surface.vertex_normal(index); };
template <class Index>
concept CanHaveNeighbours = requires(const Surface& surface, Index index) { surface.neighbours(index); };
template <class Index>
concept CanHaveASide = requires(const SideChoice& choice, Index index) { choice.side_of(index); };
template <class Index>
concept CanBeChosen = requires(const cad::Part& part, std::vector<Index> faces) { cad::mesh_of_faces(part, faces); };
template <class Left, class Right>
concept CanCompare = requires(Left left, Right right) { left == right; };
template <class To, class From>
concept CanAssign = requires(To to, From from) { to = from; };

TEST(MeshIndex, ASurfaceTakesNoVertexForAFaceAndNoFaceForAVertex) {
  EXPECT_TRUE(CanNameAFace<FaceIndex>);
  EXPECT_FALSE(CanNameAFace<VertexIndex>);
  EXPECT_FALSE(CanNameAFace<int>);
  EXPECT_TRUE(CanNameAVertex<VertexIndex>);
  EXPECT_FALSE(CanNameAVertex<FaceIndex>);
  EXPECT_FALSE(CanNameAVertex<int>);
  EXPECT_TRUE(CanHaveNeighbours<FaceIndex>);
  EXPECT_FALSE(CanHaveNeighbours<VertexIndex>);
  EXPECT_FALSE(CanHaveNeighbours<int>);
}

TEST(MeshIndex, OnlyAFaceHasASide) {
  EXPECT_TRUE(CanHaveASide<FaceIndex>);
  EXPECT_FALSE(CanHaveASide<VertexIndex>);
  EXPECT_FALSE(CanHaveASide<int>);
}

TEST(MeshIndex, AFaceOfAPartIsNoFaceOfItsMesh) {
  EXPECT_TRUE(CanBeChosen<BrepFaceIndex>);
  EXPECT_FALSE(CanBeChosen<FaceIndex>);
  EXPECT_FALSE(CanBeChosen<int>);
  EXPECT_FALSE((CanCompare<BrepFaceIndex, FaceIndex>));
  EXPECT_FALSE((CanAssign<BrepFaceIndex&, FaceIndex>));
  EXPECT_FALSE((std::is_constructible_v<FaceIndex, BrepFaceIndex>));
}

TEST(MeshIndex, FacesAndVerticesAreNeitherMadeOfNorComparedWithEachOther) {
  EXPECT_FALSE((std::is_constructible_v<VertexIndex, FaceIndex>));
  EXPECT_FALSE((std::is_constructible_v<FaceIndex, VertexIndex>));
  EXPECT_FALSE((CanAssign<FaceIndex&, VertexIndex>));
  EXPECT_FALSE((CanCompare<FaceIndex, VertexIndex>));
  EXPECT_TRUE((CanCompare<FaceIndex, FaceIndex>));
  EXPECT_TRUE((CanCompare<VertexIndex, int>));
}

TEST(MeshIndex, TheAnswersOfASurfaceSayWhatTheyCount) {
  EXPECT_TRUE((std::same_as<decltype(SurfacePoint::face), FaceIndex>));
  EXPECT_TRUE((std::same_as<decltype(BorderPoint::beyond), std::array<VertexIndex, 2>>));
  EXPECT_TRUE((std::same_as<std::remove_cvref_t<decltype(std::declval<const Surface&>().border_loops())>,
                            std::vector<std::vector<VertexIndex>>>));
  EXPECT_TRUE((std::same_as<std::remove_cvref_t<decltype(std::declval<const Surface&>().neighbours(FaceIndex{0}))>,
                            std::array<FaceIndex, 3>>));
}

// Face 0 is right of face 1 in a square whose vertex 3 belongs to face 1 alone.
TEST(MeshIndex, IsReadAndPrintedAsItsInteger) {
  const Surface surface(Mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const FaceIndex upper = surface.closest({0.1, 0.9, 5.0}).face;
  EXPECT_EQ(upper, 1);
  EXPECT_EQ(surface.neighbours(upper), (std::array{FaceIndex{0}, FaceIndex::none(), FaceIndex::none()}));
  EXPECT_EQ(surface.vertex_normal(VertexIndex{3}), Vec3(0, 0, 1));
  EXPECT_EQ(fmt::format("{:>3}", upper), "  1");
  EXPECT_EQ(nlohmann::json(std::vector{upper, FaceIndex::none()}).dump(), "[1,-1]");
}

}  // namespace
}  // namespace triskin::mesh
