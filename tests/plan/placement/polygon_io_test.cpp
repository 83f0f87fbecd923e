// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons as programs write them: what they mean by RFC 7946 and OGC 06-103r4, and which words a refusal has.
#include "triskin/placement/polygon_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "triskin/base/error.hpp"

namespace triskin::placement {
namespace {

using testing::HasSubstr;

struct Accepted {
  std::string text;
  std::size_t vertices, holes;
};
struct Refused {
  std::string text, reason;
};

constexpr const char* kName = "outline.txt";

void expect_accepted(const std::vector<Accepted>& cases) {
  for (const Accepted& c : cases) {
    SCOPED_TRACE(c.text);
    Polygon polygon;
    ASSERT_NO_THROW(polygon = parse_polygon(c.text, kName));
    EXPECT_EQ(polygon.outer.size(), c.vertices);
    EXPECT_EQ(polygon.holes.size(), c.holes);
    EXPECT_THAT(polygon.outer, testing::Contains(Vec2(0, 0)));
  }
}

void expect_refused(const std::vector<Refused>& cases) {
  for (const Refused& c : cases) {
    SCOPED_TRACE(c.text);
    try {
      (void)parse_polygon(c.text, kName);
      ADD_FAILURE() << "was accepted";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::AllOf(testing::StartsWith(kName), HasSubstr(c.reason)));
    }
  }
}

const std::string kRing = "0 0, 100 0, 100 80, 0 80, 0 0";
const std::string kCoordinates = "[[[0,0],[100,0],[100,80],[0,80],[0,0]]]";
const std::string kJsonPolygon = R"({"type":"Polygon","coordinates":)" + kCoordinates + "}";
const std::string kFeature = R"({"type":"Feature","properties":null,"geometry":)" + kJsonPolygon + "}";

TEST(PolygonFiles, wkt_has_many_forms_of_one_polygon) {
  expect_accepted({
      {"polygon((" + kRing + "))", 4, 0},
      {"SRID=4326;POLYGON((" + kRing + "))", 4, 0},
      {"POLYGON Z ((0 0 1, 100 0 1, 100 80 1, 0 80 1, 0 0 1))", 4, 0},
      {"POLYGON ZM((0 0 1 2, 100 0 1 2, 100 80 1 2, 0 80 1 2, 0 0 1 2))", 4, 0},
      {"POLYGONZ((0 0 1, 100 0 1, 100 80 1, 0 80 1, 0 0 1))", 4, 0},
      {"MULTIPOLYGON(((" + kRing + ")))", 4, 0},
      {"\xEF\xBB\xBFPOLYGON((" + kRing + "));\r\n", 4, 0},
      {"POLYGON((0 0, 1e2 0, 1.0E+2 .8e2, 0 80., 0 0))", 4, 0},
      {"POLYGON((0 0, 100 0, 100 0, 100 80, 0 80, 0 0))", 4, 0},
      {"POLYGON((" + kRing + "),(0 40, 20 30, 20 50, 0 40))", 4, 1},
  });
}

TEST(PolygonFiles, wkt_that_is_not_one_polygon_is_refused_by_name) {
  expect_refused({
      {"POLYGON EMPTY", "EMPTY"},
      {"MULTIPOLYGON(((" + kRing + ")),((200 0, 300 0, 300 80, 200 0)))", "exactly one polygon"},
      {"POLYGON((0 0, 100 0, 100 80, 0 80))", "vertex 3: the ring is open"},
      {"POLYGON((0 0, 100 0 7, 100 80, 0 0))", "a point has 3 numbers, not 2"},
      {"POLYGON((" + kRing + ")) POLYGON((" + kRing + "))", "unexpected text after the polygon"},
      {"LINESTRING(0 0, 1 1)", "expected POLYGON"},
  });
}

TEST(PolygonFiles, rings_that_bound_no_area_are_refused_with_ring_and_place) {
  expect_refused({
      {"POLYGON((0 0, 100 80, 100 0, 0 80, 0 0))", "crosses the edge after vertex 2 of the outer ring"},
      {"POLYGON((0 0, 100 0, 150 0, 100 0, 100 80, 0 80, 0 0))", "touches itself at (100, 0)"},
      {"POLYGON((" + kRing + "),(" + kRing + "))", "lie on each other"},
      {"POLYGON((" + kRing + "),(200 0, 210 0, 210 10, 200 0))", "hole 0 lies outside the outer ring"},
      {"POLYGON((" + kRing + "),(0 40, 50 80, 50 40, 0 40))", "cut the polygon in two at"},
  });
}

TEST(PolygonFiles, geojson_may_wrap_one_polygon) {
  expect_accepted({
      {kJsonPolygon, 4, 0},
      {kFeature, 4, 0},
      {R"({"type":"FeatureCollection","features":[)" + kFeature + "]}", 4, 0},
      {R"({"type":"GeometryCollection","geometries":[)" + kJsonPolygon + "]}", 4, 0},
      {R"({"type":"MultiPolygon","coordinates":[)" + kCoordinates + "]}", 4, 0},
      {R"({"type":"Polygon","bbox":[0,0,1,1],"coordinates":[[[0,0,5],[100,0,5],[100,80,5],[0,0,5]]]})", 3, 0},
  });
}

TEST(PolygonFiles, geojson_that_is_not_one_polygon_is_refused_by_name) {
  expect_refused({
      {R"({"type":"FeatureCollection","features":[)" + kFeature + "," + kFeature + "]}", "exactly one polygon"},
      {R"({"type":"Feature","geometry":null,"properties":{}})", "the feature has no geometry (null)"},
      {R"({"type":"LineString","coordinates":[[0,0],[1,1]]})", "holds a LineString; a Polygon is needed"},
      {R"({"type":"Polygon","coordinates":[[["0","0"],[100,0],[100,80],["0","0"]]]})",
       "outer ring, vertex 0: must be two numbers"},
      {R"({"type":"Polygon","coordinates":[[[0,0],[100,0],[100,80],[0,80]]]})", "vertex 3: the ring is open"},
      {R"({"type":"Polygon","coordinates":[],"coordinates":)" + kCoordinates + "}", "appears twice"},
  });
}

}  // namespace
}  // namespace triskin::placement
