// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines of drawing programs. Areas are those of the shapes by their formulas; chords lie inside an arc by at most
// the tolerance, so that an area lacks less than length times tolerance.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>

#include "triskin/base/error.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::placement {
namespace {

using ::testing::HasSubstr;
constexpr double kPi = std::numbers::pi, kTolerance_mm = 0.01;

std::string dxf(const std::string& entities, const std::string& unit = "4", const std::string& tables = "") {
  return "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n" + unit + "\n0\nENDSEC\n" + tables + "0\nSECTION\n2\nENTITIES\n" +
         entities + "0\nENDSEC\n0\nEOF\n";
}
std::string svg(const std::string& inside, const std::string& head = R"(width="100mm" viewBox="0 0 100 100")") {
  return "<?xml version=\"1.0\"?><svg xmlns=\"http://www.w3.org/2000/svg\" " + head + ">" + inside + "</svg>";
}
double area_of(const std::string& text) {
  return polygon_area(parse_polygon(text, "drawing"));
}
std::string error_of(const std::string& text) {
  try {
    (void)parse_polygon(text, "drawing");
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}
void expect_area(const std::string& text, double area_mm2, double length_mm) {
  EXPECT_NEAR(area_of(text), area_mm2, kTolerance_mm * length_mm) << text;
}

// A bulge of 1 is a half circle to the right of a side that runs counter-clockwise: outside.
TEST(DxfOutline, arcs_bulges_and_circles) {
  const double r = 50.0;
  expect_area(dxf("0\nCIRCLE\n10\n5\n20\n7\n40\n50\n"), kPi * r * r, 2 * kPi * r);
  expect_area(dxf("0\nLWPOLYLINE\n90\n2\n70\n1\n10\n0\n20\n0\n42\n1\n10\n100\n20\n0\n42\n1\n"), kPi * r * r,
              2 * kPi * r);
  const std::string d = "0\nLINE\n10\n0\n20\n50\n11\n0\n21\n-50\n";
  expect_area(dxf("0\nARC\n10\n0\n20\n0\n40\n50\n50\n270\n51\n90\n" + d), kPi * r * r / 2, kPi * r);
  expect_area(dxf("0\nELLIPSE\n10\n0\n20\n0\n11\n60\n21\n0\n40\n0.5\n"), kPi * 60 * 30, 300);
  expect_area(
      dxf("0\nPOLYLINE\n66\n1\n70\n1\n0\nVERTEX\n10\n0\n20\n0\n42\n1\n0\nVERTEX\n10\n100\n20\n0\n42\n1\n0\nSEQEND\n"),
      kPi * r * r, 2 * kPi * r);
}

// The quarter circle as a rational curve of degree 2: weights 1, cos 45°, 1.
TEST(DxfOutline, rational_spline) {
  const std::string spline =
      "0\nSPLINE\n70\n4\n71\n2\n72\n6\n73\n3\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n41\n1\n41\n0."
      "7071067811865476\n41\n1\n"
      "10\n50\n20\n0\n10\n50\n20\n50\n10\n0\n20\n50\n";
  expect_area(dxf(spline + "0\nLINE\n10\n0\n20\n50\n11\n0\n21\n0\n0\nLINE\n10\n0\n20\n0\n11\n50\n21\n0\n"),
              kPi * 2500 / 4, 80);
}

TEST(DxfOutline, units_layers_and_mirrored_planes) {
  const std::string square =
      "0\nLWPOLYLINE\n8\nA\n90\n4\n70\n1\n10\n0\n20\n0\n10\n4\n20\n0\n10\n4\n20\n4\n10\n0\n20\n4\n";
  EXPECT_DOUBLE_EQ(area_of(dxf(square, "1")), 16 * 25.4 * 25.4);
  EXPECT_DOUBLE_EQ(area_of(dxf(square, "5")), 1600.0);
  EXPECT_DOUBLE_EQ(area_of(dxf(square, "6")), 16e6);
  EXPECT_THAT(error_of(dxf(square, "7")), HasSubstr("$INSUNITS 7 is no unit of a part"));
  const std::string other = "0\nCIRCLE\n8\nB\n10\n900\n20\n0\n40\n5\n";
  for (const char* state : {"70\n0\n62\n-7\n", "70\n1\n62\n7\n"}) {
    const std::string layers = std::string("0\nSECTION\n2\nTABLES\n0\nLAYER\n2\nB\n") + state + "0\nENDSEC\n";
    EXPECT_DOUBLE_EQ(area_of(dxf(square + other, "4", layers)), 16.0);
  }
  EXPECT_THAT(error_of(dxf(square + other)), HasSubstr("2 outlines"));
  const Polygon mirrored = parse_polygon(dxf("0\nCIRCLE\n10\n100\n20\n0\n40\n5\n230\n-1\n"), "m");
  for (const Vec2& p : mirrored.outer) EXPECT_NEAR(p.x(), -100.0, 5.001);
}

TEST(DxfOutline, layers_in_any_case_defpoints_and_lines_of_no_length_are_left_out) {
  const std::string square =
      "0\nLWPOLYLINE\n8\n0\n90\n4\n70\n1\n10\n0\n20\n0\n10\n4\n20\n0\n10\n4\n20\n4\n10\n0\n20\n4\n";
  const std::string layers = "0\nSECTION\n2\nTABLES\n0\nLAYER\n2\nJig\n70\n0\n62\n-7\n0\nENDSEC\n";
  EXPECT_DOUBLE_EQ(area_of(dxf(square + "0\nCIRCLE\n8\nJIG\n10\n900\n20\n0\n40\n5\n", "4", layers)), 16.0);
  EXPECT_DOUBLE_EQ(area_of(dxf(square + "0\nCIRCLE\n8\nDefpoints\n10\n900\n20\n0\n40\n5\n")), 16.0);
  EXPECT_DOUBLE_EQ(area_of(dxf(square + "0\nLINE\n8\n0\n10\n2\n20\n2\n11\n2\n21\n2\n")), 16.0);
}

TEST(DxfOutline, curves_that_leave_their_plane_are_refused) {
  for (const char* curve :
       {"0\nLINE\n10\n0\n20\n0\n30\n0\n11\n50\n21\n0\n31\n9\n",
        "0\nPOLYLINE\n66\n1\n70\n9\n0\nVERTEX\n10\n0\n20\n0\n30\n0\n0\nVERTEX\n10\n9\n20\n0\n30\n5\n0\nSEQEND\n"})
    EXPECT_THAT(error_of(dxf(curve)), HasSubstr("lies in a plane that is tilted")) << curve;
  expect_area(dxf("0\nLWPOLYLINE\n38\n7\n90\n2\n70\n1\n10\n0\n20\n0\n42\n1\n10\n100\n20\n0\n42\n1\n"), kPi * 2500,
              2 * kPi * 50);
}

TEST(Outline, parts_are_named_with_their_command) {
  for (const auto& [part, what] :
       {std::pair{"solid a\nfacet normal 0 0 1\n", "is a mesh (STL); \"triskin design\" covers a part"},
        std::pair{"v 0 0 0\nv 1 0 0\n", "is a mesh (OBJ); \"triskin design\""},
        std::pair{"ISO-10303-21;\nHEADER;\n", "is a part in STEP; \"triskin design\""},
        std::pair{"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\n",
                  "is an IFC building model; export the outline as DXF or SVG"}})
    EXPECT_THAT(error_of(part), HasSubstr(what));
}

TEST(DxfOutline, says_what_is_wrong) {
  EXPECT_THAT(error_of(dxf("0\nLINE\n10\n0\n20\n0\n11\n50\n21\n0\n0\nLINE\n10\n50\n20\n0\n11\n50\n21\n50\n")),
              HasSubstr("the outline is open"));
  EXPECT_THAT(error_of(dxf("0\nINSERT\n2\nB\n10\n0\n20\n0\n")), HasSubstr("INSERT is not read; explode it"));
  EXPECT_THAT(error_of(dxf("0\nTEXT\n1\nhello\n")), HasSubstr("holds no curve that is read, but TEXT"));
  EXPECT_THAT(error_of(dxf("0\nCIRCLE\n10\n0\n20\n0\n")), HasSubstr("line 15: CIRCLE lacks its group 40"));
  const std::string whole = dxf("0\nCIRCLE\n10\n0\n20\n0\n40\n9\n");
  for (std::size_t cut = 12; cut + 5 < whole.size(); cut += 3)
    EXPECT_NE(error_of(whole.substr(0, cut)), "accepted") << cut;
}

TEST(SvgOutline, shapes_and_their_units) {
  EXPECT_NEAR(area_of(svg(R"(<rect x="10" y="10" width="50" height="40"/>)")), 2000.0, 1e-9);
  expect_area(svg(R"(<circle cx="50" cy="50" r="40"/>)"), kPi * 1600, 2 * kPi * 40);
  expect_area(svg(R"(<rect width="60" height="40" rx="10"/>)"), 60 * 40 - (4 - kPi) * 100, 200);
  EXPECT_NEAR(area_of(svg(R"(<polygon points="0,0 50,0 50,50"/>)")), 1250.0, 1e-9);
  // Without a viewBox a unit is a pixel, 96 of them an inch; with one the width gives the scale.
  EXPECT_NEAR(area_of(svg(R"(<rect width="96" height="96"/>)", "")), 25.4 * 25.4, 1e-9);
  EXPECT_NEAR(area_of(svg(R"(<rect width="10" height="10"/>)", R"(width="4in" viewBox="0 0 40 40")")), 25.4 * 25.4,
              1e-9);
}

TEST(SvgOutline, size_follows_width_height_and_their_fit) {
  const std::string square = R"(<rect width="100" height="100"/>)";
  const std::string head = R"(width="150mm" height="120mm" viewBox="0 0 100 100")";
  EXPECT_NEAR(area_of(svg(square, head)), 120.0 * 120.0, 1e-9);
  EXPECT_NEAR(area_of(svg(square, head + R"( preserveAspectRatio="none")")), 150.0 * 120.0, 1e-9);
  EXPECT_THAT(error_of(svg(square, head + R"( preserveAspectRatio="xMidYMid slice")")), HasSubstr("slice"));
  for (const char* size : {"", R"(width="100%" height="100%" )", R"(width="auto" )"})
    EXPECT_THAT(error_of(svg(square, size + std::string(R"(viewBox="0 0 100 100")"))), HasSubstr("how large it is"));
}

TEST(SvgOutline, what_is_not_painted_is_left_out) {
  const std::string outer = R"(<rect width="50" height="40"/>)";
  for (const char* paint : {R"(fill="none" stroke="none")", R"(style="fill-opacity:0;stroke:none")",
                            R"(style="opacity:0%")", R"(style="display : none !important")", R"(visibility="hidden")",
                            R"(fill="none")", R"(fill="transparent")", R"(fill-opacity="0")", R"(fill="#0000")",
                            R"(fill="#12345600")", R"x(fill="rgba(9, 9, 9, 0)")x", R"x(fill="rgb(9 9 9 / 0%)")x"})
    EXPECT_NEAR(area_of(svg(outer + R"(<rect x="10" y="10" width="9" height="9" )" + paint + "/>")), 2000.0, 1e-9)
        << paint;
  // Nothing is seen of this drawing, but something is meant.
  EXPECT_NEAR(area_of(svg(R"(<rect width="50" height="40" fill="none"/>)")), 2000.0, 1e-9);
  for (const char* paint : {R"(fill="none" stroke="red")", R"(fill="#1230" stroke="#000f")", R"x(fill="rgb(0,0,0)")x"})
    EXPECT_NEAR(area_of(svg(R"(<rect width="50" height="40" )" + std::string(paint) + "/>")), 2000.0, 1e-9) << paint;
  EXPECT_NEAR(area_of(svg(R"(<g fill="none" stroke="none"><rect width="50" height="40" stroke="red"/></g>)")), 2000.0,
              1e-9);
}

TEST(SvgOutline, a_sheet_leaves_out_what_it_does_not_paint) {
  const auto area_with = [](const std::string& sheet, const std::string& attributes) {
    return area_of(svg("<style>" + sheet +
                       R"(</style><rect width="50" height="40" style="fill:red"/><rect x="10" y="10" )"
                       R"(width="10" height="10" )" +
                       attributes + "/>"));
  };
  // The outline has 2000 mm²; a square in it that is painted is a hole of 100 mm².
  EXPECT_NEAR(area_with(".h{fill:none;stroke:none}", R"(class="x h")"), 2000.0, 1e-9);
  EXPECT_NEAR(area_with(".h{fill:none;stroke:none}", R"(class="hh")"), 1900.0, 1e-9);
  EXPECT_NEAR(area_with("/* a */ circle, #k { display : none }", R"(id="k")"), 2000.0, 1e-9);
  EXPECT_NEAR(area_with("@charset \"UTF-8\"; @font-face{src:x} @media print{rect{display:none}} #k{visibility:hidden}",
                        R"(id="k")"),
              2000.0, 1e-9);
  // The more special selector counts, then the later one; a style of the element before both, unless they are marked.
  EXPECT_NEAR(area_with("#k{opacity:1} rect.h{opacity:0} .h{opacity:0}", R"(id="k" class="h")"), 1900.0, 1e-9);
  EXPECT_NEAR(area_with(".h{opacity:0} .h{opacity:1}", R"(class="h")"), 1900.0, 1e-9);
  EXPECT_NEAR(area_with(".h{opacity:0}", R"(class="h" style="opacity:1")"), 1900.0, 1e-9);
  EXPECT_NEAR(area_with(".h{opacity:0 !important}", R"(class="h" style="opacity:1")"), 2000.0, 1e-9);
  // Visibility is handed down, and a shape may take it back.
  EXPECT_NEAR(area_of(svg(R"(<g visibility="hidden"><rect width="50" height="40" visibility="visible"/></g>)")), 2000.0,
              1e-9);
}

TEST(Outlines, say_and_take_the_unit) {
  const std::string square = "0\nLWPOLYLINE\n90\n4\n70\n1\n10\n0\n20\n0\n10\n6\n20\n0\n10\n6\n20\n5\n10\n0\n20\n5\n";
  const std::string no_unit = "0\nSECTION\n2\nENTITIES\n" + square + "0\nENDSEC\n0\nEOF\n";
  EXPECT_THAT(parse_polygons(no_unit, "a.dxf").remark, HasSubstr("names no unit"));
  const Outlines inches = parse_polygons(no_unit, "a.dxf", 25.4);
  EXPECT_EQ(inches.remark, "");
  EXPECT_NEAR(polygon_area(inches.polygons.at(0)), 6 * 5 * 25.4 * 25.4, 1e-9);
  EXPECT_EQ(parse_polygons(dxf(square), "a.dxf").remark, "");
  const std::string rectangle = R"(<rect width="60" height="50"/>)";
  EXPECT_THAT(parse_polygons(svg(rectangle, R"(width="100" height="80" viewBox="0 0 100 80")"), "a.svg").remark,
              HasSubstr("96 an inch"));
  EXPECT_EQ(parse_polygons(svg(rectangle), "a.svg").remark, "");
  EXPECT_NEAR(polygon_area(parse_polygons(svg(rectangle, R"(viewBox="0 0 100 80")"), "a.svg", 1.0).polygons.at(0)),
              3000.0, 1e-9);
  const std::string metres = "POLYGON((0 0, 0.15 0, 0.15 0.12, 0 0))";
  EXPECT_NEAR(polygon_area(parse_polygons(metres, "a.wkt", 1000.0).polygons.at(0)), 9000.0, 1e-9);
}

TEST(Outlines, degrees_of_a_map_are_no_millimetres) {
  const auto triangle = [](double x, double y, double size) {
    return fmt::format(R"({{"type":"Polygon","coordinates":[[[{0},{1}],[{2},{1}],[{0},{3}],[{0},{1}]]]}})", x, y,
                       x + size, y + size);
  };
  for (const auto& [x, y, size] :
       {std::array{9.18, 45.46, 0.02}, std::array{-122.5, 37.7, 0.1}, std::array{5.0, 45.0, 10.0}})
    EXPECT_THAT(error_of(triangle(x, y, size)), HasSubstr("degrees of longitude and latitude"));
  // A triangle at the origin, one as large as a module, and one beyond the poles.
  for (const auto& [x, y, size] :
       {std::array{0.0, 0.0, 10.0}, std::array{50.0, 50.0, 31.0}, std::array{100.0, 100.0, 5.0}})
    EXPECT_NEAR(area_of(triangle(x, y, size)), 0.5 * size * size, 1e-9);
}

TEST(SvgOutline, what_would_be_half_read_is_refused) {
  const std::string square = R"(<rect class="a" width="50" height="40"/>)";
  for (const char* rule : {"transform:scale(2)", "clip-path:circle(9px)", "fill:var(--f)", "width:calc(1px + 2px)"})
    EXPECT_THAT(error_of(svg("<style>/* b */ .a{fill:none;" + std::string(rule) + "}</style>" + square)),
                HasSubstr("style sheet sets"))
        << rule;
  for (const auto& [sheet, what] :
       {std::pair{"@import url(a.css);", "is in another file"},
        std::pair{"g .a{display:none}", "the selector \"g .a\""},
        std::pair{"@media (max-width:9px){.a{display:none}}", "under the condition \"@media (max-width:9px)\""}})
    EXPECT_THAT(error_of(svg("<style>" + std::string(sheet) + "</style>" + square)), HasSubstr(what)) << sheet;
  EXPECT_THAT(error_of("<?xml-stylesheet href=\"a.css\"?><svg/>"), HasSubstr("is in another file"));
  EXPECT_NEAR(area_of(svg("<style>.a{fill:none;stroke:#000;display:inline}</style>" + square)), 2000.0, 1e-9);
  EXPECT_THAT(error_of(svg(R"x(<rect width="50" height="40" style="transform:scale(2)"/>)x")),
              HasSubstr("its style sets \"transform: scale(2)\""));
  const std::string clipped = R"x(<g clip-path="url(#c)"><rect width="50" height="40"/></g>)x";
  const auto clip = [](const char* width) {
    return fmt::format(R"x(<clipPath id="c"><rect width="{}" height="100"/></clipPath>)x", width);
  };
  EXPECT_NEAR(area_of(svg(clip("100") + clipped)), 2000.0, 1e-9);  // as large as the drawing
  EXPECT_THAT(error_of(svg(clip("30") + clipped)), HasSubstr("cut by a clip-path"));
  EXPECT_THAT(error_of(svg(R"x(<rect width="50" height="40" mask="url(#m)"/>)x")), HasSubstr("cut by a mask"));
  EXPECT_THAT(error_of("<!DOCTYPE svg [<!ENTITY w \"150\">]><svg/>"), HasSubstr("SVG with entities"));
}

TEST(SvgOutline, paths) {
  EXPECT_NEAR(area_of(svg(R"(<path d="M10 10h50v40h-50z"/>)")), 2000.0, 1e-9);
  EXPECT_NEAR(area_of(svg(R"(<path d="m10,10 50,0 0,40 -50,0z"/>)")), 2000.0, 1e-9);
  // Two half circles; then the flags of arcs without blanks between them.
  expect_area(svg(R"(<path d="M10,50 A40,40 0 0 1 90,50 A40,40 0 0 1 10,50 Z"/>)"), kPi * 1600, 2 * kPi * 40);
  expect_area(svg(R"(<path d="M10,50a40,40 0 01 80,0a40,40 0 01-80,0Z"/>)"), kPi * 1600, 2 * kPi * 40);
  // ∫ of the parabola 4 h t (1 - t) over its base: 2/3 base · height; a Q of height 60 rises to 30.
  expect_area(svg(R"(<path d="M10,60 Q50,0 90,60 Z"/>)"), 80 * 30 * 2.0 / 3.0, 120);
  expect_area(svg(R"(<path d="M10,60 C36.666666666666667,20 63.333333333333333,20 90,60 Z"/>)"), 80 * 30 * 2.0 / 3.0,
              120);
  // A hole.
  EXPECT_NEAR(area_of(svg(R"(<path d="M0 0H80V80H0ZM20 20V40H40V20Z"/>)")), 6400.0 - 400.0, 1e-9);
}

TEST(SvgOutline, transforms_turn_y_up_and_hidden_groups_are_left_out) {
  const Polygon p =
      parse_polygon(svg(R"x(<g transform="translate(10 20) scale(2)"><rect width="10" height="20"/></g>)x"), "s");
  Vec2 low(1e9, 1e9), high(-1e9, -1e9);
  for (const Vec2& v : p.outer) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  EXPECT_NEAR((low - Vec2(10, 40)).norm(), 0.0, 1e-9);   // 100 - (20 + 2 · 20)
  EXPECT_NEAR((high - Vec2(30, 80)).norm(), 0.0, 1e-9);  // 100 - 20
  EXPECT_NEAR(
      area_of(svg(R"(<rect width="10" height="10"/><g style="display: none"><rect x="50" width="9" height="9"/></g>)")),
      100.0, 1e-9);
  EXPECT_THAT(error_of(svg(R"(<use href="#a"/>)")), HasSubstr("unlink clones"));
  EXPECT_THAT(error_of(svg(R"(<path d="M0 0 L 5 x"/>)")), HasSubstr("a number is missing"));
  EXPECT_THAT(error_of(svg("<text>a</text>")), HasSubstr("no line, arc or curve"));
}

}  // namespace
}  // namespace triskin::placement
