// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "reference_cycles.hpp"
#include "step_lexer.hpp"
#include "text_encoding.hpp"
#include "triskin/base/error.hpp"

namespace triskin::cad {
namespace {

constexpr std::size_t kMaxDepth = 64;  // Real files nest control points three deep.
// No unit makes a robot part of this size; kernels search for its triangles until memory ends.
constexpr double kMaxCoordinate = 1e9;

enum Trait : std::uint16_t {
  kFace = 1,
  kAssembly = 2,
  kDocumentFile = 4,
  kUnits = 8,
  kLengthUnit = 16,
  kPoint = 32,
  kOperator = 64,
  kDirection = 128,
  kStyle = 256,
  kInvisible = 512,
  kLayer = 1024,
  kComplexOperator = 2048,
  kOverride = 4096,
};

std::uint16_t trait_of(std::string_view keyword) {
  if (keyword == "ADVANCED_FACE" || keyword == "FACE_SURFACE") return kFace;
  if (keyword == "NEXT_ASSEMBLY_USAGE_OCCURRENCE") return kAssembly;
  if (keyword == "DOCUMENT_FILE") return kDocumentFile;
  if (keyword == "GLOBAL_UNIT_ASSIGNED_CONTEXT") return kUnits;
  if (keyword == "LENGTH_UNIT") return kLengthUnit;
  if (keyword == "CARTESIAN_POINT") return kPoint;
  if (keyword == "CARTESIAN_TRANSFORMATION_OPERATOR") return kOperator | kComplexOperator;
  if (keyword.starts_with("CARTESIAN_TRANSFORMATION_OPERATOR_3D")) return kOperator;
  if (keyword == "DIRECTION") return kDirection;
  if (keyword == "STYLED_ITEM") return kStyle;
  if (keyword == "OVER_RIDING_STYLED_ITEM") return kStyle | kOverride;
  if (keyword == "INVISIBILITY") return kInvisible;
  if (keyword == "PRESENTATION_LAYER_ASSIGNMENT") return kLayer;
  return 0;
}

// The first value of these is the name of a representation item (ISO 10303-43). Some exporters leave it unset (`$`)
// where it is empty; the kernel then drops the entity.
bool begins_with_name(std::string_view keyword) {
  static constexpr std::array<std::string_view, 26> kItems{"ADVANCED_FACE",
                                                           "FACE_SURFACE",
                                                           "FACE_BOUND",
                                                           "FACE_OUTER_BOUND",
                                                           "VERTEX_POINT",
                                                           "EDGE_CURVE",
                                                           "ORIENTED_EDGE",
                                                           "CLOSED_SHELL",
                                                           "OPEN_SHELL",
                                                           "ORIENTED_CLOSED_SHELL",
                                                           "MANIFOLD_SOLID_BREP",
                                                           "BREP_WITH_VOIDS",
                                                           "SHELL_BASED_SURFACE_MODEL",
                                                           "CARTESIAN_POINT",
                                                           "DIRECTION",
                                                           "VECTOR",
                                                           "LINE",
                                                           "CIRCLE",
                                                           "ELLIPSE",
                                                           "PLANE",
                                                           "PCURVE",
                                                           "MAPPED_ITEM",
                                                           "STYLED_ITEM",
                                                           "REPRESENTATION_ITEM",
                                                           "GEOMETRIC_SET",
                                                           "TRIMMED_CURVE"};
  return std::ranges::find(kItems, keyword) != kItems.end() || keyword.ends_with("_SURFACE") ||
         keyword.ends_with("_CURVE") || keyword.ends_with("_LOOP") || keyword.ends_with("_WITH_KNOTS") ||
         keyword.starts_with("AXIS1_PLACEMENT") || keyword.starts_with("AXIS2_PLACEMENT") ||
         keyword.starts_with("SURFACE_OF_") || keyword.starts_with("CARTESIAN_TRANSFORMATION_OPERATOR");
}

bool is_tessellation(std::string_view keyword) {
  return keyword.starts_with("TESSELLATED_") || keyword == "TRIANGULATED_FACE" ||
         keyword == "COMPLEX_TRIANGULATED_FACE" || keyword == "TRIANGULATED_SURFACE_SET" ||
         keyword == "COMPLEX_TRIANGULATED_SURFACE_SET";
}
bool is_csg(std::string_view keyword) {
  return keyword == "CSG_SOLID" || keyword == "BOOLEAN_RESULT" || keyword == "BLOCK" || keyword == "SPHERE" ||
         keyword == "TORUS" || keyword == "RIGHT_CIRCULAR_CYLINDER" || keyword == "RIGHT_CIRCULAR_CONE" ||
         keyword == "RIGHT_ANGULAR_WEDGE";
}

std::string schema_name(const std::string& schema) {
  if (schema.starts_with("AUTOMOTIVE_DESIGN")) return "AP214";
  if (schema.starts_with("CONFIG_CONTROL_DESIGN") || schema.starts_with("AP203")) return "AP203";
  if (schema.starts_with("AP242")) return "AP242";
  return schema.substr(0, schema.find_first_of(" {"));
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : lexer_(bytes), encoding_(guess_encoding(bytes)) {}

  StepText run() {
    magic();
    for (section(); !is_ended_; section()) {
    }
    finish();
    return std::move(out_);
  }

 private:
  using Kind = StepToken::Kind;

  [[noreturn]] void fail(const std::string& what) const { throw InputError(place() + ": " + what); }
  [[nodiscard]] std::string place() const {
    return entity_.id > 0 ? fmt::format("#{} (line {})", entity_.id, lexer_.line())
                          : fmt::format("line {}", lexer_.line());
  }
  // Returns the next token, which must exist.
  StepToken next() {
    StepToken token = lexer_.next();
    if (token.kind == Kind::kEnd) ends_here();
    if (token.kind == Kind::kBad) fail(token.problem);
    return token;
  }
  [[noreturn]] void ends_here() const {
    if (entity_.id > 0) throw InputError(fmt::format("the file ends within #{}; it was cut, get it again", entity_.id));
    if (!ids_.empty())
      throw InputError(
          fmt::format("the file ends after #{}, before the end of its data; it was cut, get it again", ids_.back()));
    throw InputError("the file ends within its header; it was cut, get it again");
  }
  void expect(Kind kind, const char* wanted) {
    const StepToken token = next();
    if (token.kind != kind) fail(fmt::format("`{}` stands where {} should", token.shown(), wanted));
    put(token);
  }
  void put(const StepToken& token) {
    if (token.kind == Kind::kString)
      out_.text += '\'' + encode_step_string(decode_step_string(token.text, encoding_)) + '\'';
    else
      out_.text += token.text;
  }
  void end_statement() {
    expect(Kind::kSemicolon, "`;`");
    out_.text += '\n';
  }

  void magic() {
    put(next());  // is_step() has checked this token.
    end_statement();
  }
  void section() {
    const StepToken name = next();
    const std::string keyword = name.upper();
    if (keyword == "END-ISO-10303-21") return end_file();
    if (name.kind != Kind::kKeyword) fail(fmt::format("`{}` stands where a section should begin", name.shown()));
    if (keyword == "ANCHOR" || keyword == "REFERENCE" || keyword == "SIGNATURE") return other_section(keyword);
    if (keyword != "HEADER" && keyword != "DATA") fail(fmt::format("the section {} is not known", keyword));
    if (keyword == "HEADER") {
      out_.text += keyword;
      end_statement();
      return header();
    }
    begin_data();
    data();
    if (lexer_.at_end()) {
      out_.warnings.emplace_back("the file lacks its last line END-ISO-10303-21");
      end_file();
    }
  }
  // Several sections of data share their numbers and become one; their names and schemas fall away.
  void begin_data() {
    const std::size_t before = out_.text.size();
    if (lexer_.peek() == '(') {
      put(next());
      list();
    }
    end_statement();
    out_.text.resize(before);
    if (!std::exchange(has_data_, true)) out_.text += "DATA;\n";
  }
  void end_file() {
    if (has_data_) out_.text += "ENDSEC;\n";
    out_.text += "END-ISO-10303-21;\n";
    is_ended_ = true;
  }
  // Sections of edition 3 (ISO 10303-21:2016) that hold no shapes: names for others, references to other files, a
  // signature.
  void other_section(const std::string& keyword) {
    end_statement_unread();
    const std::string_view contents = lexer_.skip_section();
    if (contents.data() == nullptr)
      throw InputError(fmt::format("the file ends within its section {}; it was cut, get it again", keyword));
    if (keyword == "REFERENCE" && contents.find('#') != std::string_view::npos)
      out_.warnings.emplace_back("the file refers to entities of other files (section REFERENCE), which are not read");
  }
  void end_statement_unread() {
    const std::size_t before = out_.text.size();
    end_statement();
    out_.text.resize(before);
  }
  void header() {
    for (StepToken name = next(); name.upper() != "ENDSEC"; name = next()) {
      if (name.kind != Kind::kKeyword) fail(fmt::format("`{}` stands where a statement should begin", name.shown()));
      out_.text += name.upper();
      first_string_.clear();
      expect(Kind::kOpen, "`(`");
      list();
      end_statement();
      if (name.upper() == "FILE_SCHEMA") out_.schema = schema_name(first_string_);
    }
    out_.text += "ENDSEC";
    end_statement();
  }
  void data() {
    for (StepToken name = next(); name.upper() != "ENDSEC"; name = next()) {
      if (name.kind != Kind::kReference) fail(fmt::format("`{}` stands where an entity should begin", name.shown()));
      entity(name);
      entity_ = {};
    }
    end_statement_unread();
  }

  void entity(const StepToken& name) {
    entity_ = {};
    entity_.id = id_of(name);
    traits_ = 0;
    numbers_in_entity_ = 0;
    values_.clear();
    first_string_.clear();
    put(name);
    expect(Kind::kEquals, "`=`");
    const StepToken what = next();
    if (what.kind == Kind::kKeyword) {
      record(what);
    } else if (what.kind == Kind::kOpen) {
      complex_record();
    } else {
      fail(fmt::format("`{}` stands where the name of an entity should", what.shown()));
    }
    end_statement();
    keep();
  }
  void record(const StepToken& name) {
    const std::string keyword = name.upper();
    traits_ |= trait_of(keyword);
    out_.tessellated += is_tessellation(keyword) ? 1 : 0;
    out_.csg += is_csg(keyword) ? 1 : 0;
    out_.text += keyword;
    expect(Kind::kOpen, "`(`");
    is_name_next_ = begins_with_name(keyword);
    list();
  }
  void complex_record() {
    out_.text += '(';
    for (StepToken token = next(); token.kind != Kind::kClose; token = next()) {
      if (token.kind != Kind::kKeyword)
        fail(fmt::format("`{}` stands where the name of an entity should", token.shown()));
      record(token);
    }
    out_.text += ')';
  }

  // Reads values up to the bracket that closes the one before them. Nesting is counted instead of recursing.
  void list() {
    std::size_t depth = 1;
    bool wants_value = true, may_close = true;
    while (depth > 0) {
      StepToken token = next();
      if (token.kind == Kind::kOmitted && is_name_next_) token = {Kind::kString, {}, {}};
      is_name_next_ = false;
      put(token);
      if (token.kind == Kind::kClose && (may_close || !wants_value)) {
        --depth;
        wants_value = may_close = false;
      } else if (token.kind == Kind::kComma && !wants_value) {
        wants_value = true;
        may_close = false;
      } else if (wants_value && (token.kind == Kind::kOpen || token.kind == Kind::kKeyword)) {
        if (token.kind == Kind::kKeyword) typed_value(token);
        if (++depth > kMaxDepth)
          fail(fmt::format("brackets are nested more than {} deep; no part needs that", kMaxDepth));
        may_close = true;
      } else if (wants_value && token.is_value()) {
        value(token);
        wants_value = may_close = false;
      } else {
        fail(fmt::format("`{}` stands where {} should", token.shown(), wants_value ? "a value" : "a comma or bracket"));
      }
    }
  }
  void typed_value(const StepToken& name) {
    if (lexer_.peek() != '(') fail(fmt::format("`{}` stands where a number or reference should", name.shown()));
    put(next());
  }
  void value(const StepToken& token) {
    if (token.kind == Kind::kReference) entity_.references.push_back(reference_of(token));
    if ((traits_ & kOperator) != 0) values_.push_back(token.kind == Kind::kReference ? reference_of(token) : 0);
    if (token.kind == Kind::kString && first_string_.empty()) first_string_ = decode_step_string(token.text, encoding_);
    if (token.kind == Kind::kNumber) number(token);
    numbers_in_entity_ += token.kind == Kind::kNumber ? 1 : 0;
  }
  void number(const StepToken& token) {
    double value = 0.0;
    const std::string_view digits = token.text.starts_with('+') ? token.text.substr(1) : token.text;
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool is_tiny = error == std::errc::result_out_of_range && digits.find("E-") != std::string_view::npos;
    if (is_tiny) return;
    if (error != std::errc{} || !std::isfinite(value))
      fail(fmt::format("`{}` is no number that can be used", token.shown()));
    if ((traits_ & kPoint) != 0 && std::abs(value) > kMaxCoordinate)
      fail(fmt::format("the coordinate {} is no place on a part", token.shown()));
    if ((traits_ & kDirection) != 0 && numbers_in_entity_ < 3) direction_[numbers_in_entity_] = value;
    if ((traits_ & kOperator) != 0 && value != 1.0) scaled_.emplace_back(entity_.id, value);
  }
  // Programs write −1 for a reference to nothing, as a number of 64 bits; it is ignored.
  static std::int64_t reference_of(const StepToken& token) {
    std::int64_t id = 0;
    const auto [rest, error] = std::from_chars(token.text.data() + 1, token.text.data() + token.text.size(), id);
    return error == std::errc{} && id <= INT32_MAX ? id : 0;
  }
  std::int64_t id_of(const StepToken& token) const {
    std::int64_t id = 0;
    const auto [rest, error] = std::from_chars(token.text.data() + 1, token.text.data() + token.text.size(), id);
    if (error != std::errc{} || id <= 0 || id > INT32_MAX)
      fail(fmt::format("`{}` is no number of an entity", token.shown()));
    return id;
  }

  // Files hold millions of entities, so only the references and traits of each are kept.
  void keep() {
    if ((traits_ & kPoint) != 0 && (numbers_in_entity_ < 1 || numbers_in_entity_ > 3))
      fail(fmt::format("a point has {} coordinates", numbers_in_entity_));
    if (std::ranges::find(entity_.references, entity_.id) != entity_.references.end())
      fail("it refers to itself; export the part again");
    out_.faces += (traits_ & kFace) != 0 ? 1 : 0;
    if ((traits_ & kDocumentFile) != 0) out_.external_files.push_back(first_string_);
    if ((traits_ & kAssembly) != 0 && entity_.references.size() >= 2)
      assemblies_.add(entity_.references[0], {entity_.references[1]}, entity_.id);
    if ((traits_ & kDirection) != 0) directions_.emplace_back(entity_.id, direction_);
    if ((traits_ & kOperator) != 0) operators_.push_back({entity_.id, values_, (traits_ & kComplexOperator) != 0});
    // The item comes last, before the style that it overrides.
    const std::size_t behind_item = (traits_ & kOverride) != 0 ? 2 : 1;
    if ((traits_ & kStyle) != 0 && entity_.references.size() >= behind_item)
      styled_.emplace(entity_.id, std::vector{entity_.references.end()[-static_cast<std::ptrdiff_t>(behind_item)]});
    if ((traits_ & kLayer) != 0) styled_.emplace(entity_.id, entity_.references);
    if ((traits_ & kInvisible) != 0)
      invisible_.insert(invisible_.end(), entity_.references.begin(), entity_.references.end());
    if ((traits_ & kLengthUnit) != 0) length_units_.push_back(entity_.id);
    if ((traits_ & kUnits) != 0)
      used_units_.insert(used_units_.end(), entity_.references.begin(), entity_.references.end());
    ids_.push_back(entity_.id);
    graph_.add(entity_.id, entity_.references, entity_.id);
  }

  void finish() {
    entity_ = {};
    if (ids_.empty()) throw InputError("the file has no entities; export the part again");
    if (const auto twice = graph_.defined_twice(); twice)
      throw InputError(fmt::format("#{} is there twice; export the part again", *twice));
    if (const auto circle = assemblies_.circle(); !circle.empty())
      throw InputError(fmt::format("#{}: circular assembly: a product is a component of itself; export it again",
                                   circle.front().label));
    if (const auto circle = graph_.circle(); !circle.empty()) throw InputError(circle_text(circle));
    std::ranges::sort(length_units_);
    out_.has_length_unit = std::ranges::any_of(
        used_units_, [&](std::int64_t id) { return std::ranges::binary_search(length_units_, id); });
    refuse_scale_and_mirror();
    warn_of_dangling();
    list_hidden();
  }

  // The kernel takes the rotation and the place of an operator alone, and drops its scale and mirroring.
  void refuse_scale_and_mirror() {
    constexpr const char* kRemedy = "which cannot be read; apply it to the part in the CAD program and export again";
    std::ranges::sort(directions_);
    for (const auto& [id, scale] : scaled_)
      throw InputError(fmt::format("#{}: an instance of a part is scaled by {}, {}", id, scale, kRemedy));
    for (const Operator& o : operators_) {
      if (is_mirrored(o)) throw InputError(fmt::format("#{}: an instance of a part is mirrored, {}", o.id, kRemedy));
    }
  }
  struct Operator {
    std::int64_t id;
    std::vector<std::int64_t> values;
    bool is_complex;  // Written as a list of its types, whose names and descriptions stand elsewhere.
  };
  // Values 3, 4 and 7 are the axes (0, 1 and 4 of a complex record); 0 stands for an unset one, which follows from the
  // others. Three axes that turn the other way mirror (ISO 10303-42).
  [[nodiscard]] bool is_mirrored(const Operator& o) const {
    const std::array<std::size_t, 3> places =
        o.is_complex ? std::array<std::size_t, 3>{0, 1, 4} : std::array<std::size_t, 3>{3, 4, 7};
    if (o.values.size() <= places[2]) return false;
    std::array<std::array<double, 3>, 3> axes{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t id = o.values[places[k]];
      const auto found = std::ranges::lower_bound(directions_, id, {}, [](const auto& d) { return d.first; });
      if (found == directions_.end() || found->first != id) return false;
      axes[k] = found->second;
    }
    const auto& [u, v, w] = axes;
    return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
               (u[0] * v[1] - u[1] * v[0]) * w[2] <
           0.0;
  }

  // What is invisible is named directly, by its style or by its layer; a layer may hold styles.
  void list_hidden() {
    std::vector<std::int64_t> todo = invisible_;
    std::set<std::int64_t> seen;
    while (!todo.empty()) {
      const std::int64_t id = todo.back();
      todo.pop_back();
      if (!seen.insert(id).second) continue;
      const auto styled = styled_.find(id);
      if (styled == styled_.end())
        out_.hidden.push_back(id);
      else
        todo.insert(todo.end(), styled->second.begin(), styled->second.end());
    }
    std::ranges::sort(out_.hidden);
  }
  static std::string circle_text(const std::vector<ReferenceGraph::Step>& circle) {
    std::string text;
    for (std::size_t k = 0; k < std::min<std::size_t>(circle.size(), 6); ++k)
      text += fmt::format("#{} → ", circle[k].label);
    return fmt::format("{}{}#{}: entities refer to each other in a circle; export the part again", text,
                       circle.size() > 6 ? "… → " : "", circle.front().label);
  }
  void warn_of_dangling() {
    const auto dangling = graph_.dangling();
    if (dangling.empty()) return;
    out_.warnings.push_back(fmt::format("{} references lead to entities that are not in the file, first #{} to #{}",
                                        dangling.size(), dangling.front().first, dangling.front().second));
  }

  struct Entity {
    std::int64_t id = 0;
    std::vector<std::int64_t> references;
  };
  StepLexer lexer_;
  RawEncoding encoding_;
  StepText out_;
  Entity entity_;
  std::uint16_t traits_ = 0;
  bool is_name_next_ = false;         // The next value of the record would be its name.
  std::vector<std::int64_t> values_;  // Of an operator: the references, 0 for other values.
  std::array<double, 3> direction_{};
  std::vector<std::pair<std::int64_t, std::array<double, 3>>> directions_;
  std::vector<Operator> operators_;
  std::vector<std::pair<std::int64_t, double>> scaled_;
  std::map<std::int64_t, std::vector<std::int64_t>> styled_;  // What a style or layer is applied to.
  std::vector<std::int64_t> invisible_;
  std::size_t numbers_in_entity_ = 0;
  std::string first_string_;
  std::vector<std::int64_t> ids_, length_units_, used_units_;
  ReferenceGraph graph_, assemblies_;
  bool has_data_ = false, is_ended_ = false;
};

}  // namespace

StepText read_step_text(std::string_view bytes) {
  if (bytes.empty()) throw InputError("the file is empty");
  if (!is_step(bytes)) {
    const std::string kind = looks_like(bytes);
    throw InputError(kind.empty() ? std::string("not a STEP file: it does not begin with ISO-10303-21")
                                  : "not a STEP file: it looks like " + kind);
  }
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return Reader(bytes).run();
}

}  // namespace triskin::cad
