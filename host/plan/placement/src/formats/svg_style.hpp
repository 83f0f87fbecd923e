// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <boost/property_tree/ptree.hpp>
#include <string>
#include <string_view>

/// What an SVG says in styles: which shapes are seen, and the properties of each.
namespace triskin::placement {

using boost::property_tree::ptree;

inline constexpr const char* kSheetInOtherFile =
    "the style sheet is in another file, which is not read; save the drawing with inline styles, or as plain SVG";

/// Throws InputError "name: <where>: what".
[[noreturn]] void fail_svg(const std::string& name, const std::string& where, const std::string& what);

/// The name of an element without its prefix.
[[nodiscard]] std::string local_name(const std::string& name);
/// An attribute of an element; empty if it has none.
[[nodiscard]] std::string attribute(const ptree& element, const char* name);
/// The value of a property: one in the style counts before the attribute (SVG 2, 6.6).
[[nodiscard]] std::string property(const ptree& element, const char* name);
/// Lengths that a style may set (SVG 2, 8.1): those of <rect>, <circle> and <ellipse>.
[[nodiscard]] bool is_length(std::string_view key);

/// Writes what the style sheets of the document say of an element into its style. Errors: InputError for a selector
/// that is not a name, class or id, for a sheet in another file, and for one that moves or cuts.
void apply_style_sheets(ptree& document, const std::string& name);

/// What paints a shape, as groups hand it down (SVG 2, 13): fill, stroke, the opacity of each, and visibility.
using Paint = std::array<std::string, 5>;
[[nodiscard]] Paint paint_of(const ptree& element, Paint inherited);
/// A stroke that nobody set is none, unless `takes_unset_strokes`.
[[nodiscard]] bool is_painted(const Paint& paint, bool takes_unset_strokes);
[[nodiscard]] bool is_visible(const Paint& paint);
[[nodiscard]] bool is_displayed(const ptree& element);

}  // namespace triskin::placement
