// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/read_part.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "reader_process.hpp"
#include "step_text.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/cad/part_stream.hpp"

namespace triskin::cad {
namespace {

constexpr double kMegabyte = 1e6;
// A cover of 1.6 MB takes 3 s of a slow processor and 300 MB. Damage makes the kernel loop; for a file of ordinary size
// we stop it long before the time limit.
constexpr double kProcessor_s = 7.0, kProcessorPerMegabyte_s = 6.0;
// Other programs may take the processor meanwhile, so the wall clock gets more than processor time.
constexpr double kWallTimes = 3.0;
constexpr std::uint64_t kMemory_mb = 1000;
constexpr double kMemoryFreeSize_mb = 20.0, kMemoryPerMegabyte = 60.0;
constexpr std::size_t kMaxFile_bytes = 400'000'000;
constexpr double kSmallestPart_mm = 20.0, kLargestPart_mm = 5000.0;

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return extension;
}
bool has_iges_name(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".iges" || extension == ".igs";
}
bool has_step_name(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".step" || extension == ".stp" || extension == ".p21";
}

// Explains how to export a shape that is hidden in the file.
std::string no_geometry(const StepText& step) {
  if (!step.external_files.empty()) {
    const auto shown = std::min<std::size_t>(step.external_files.size(), 3);
    return fmt::format(
        "has no geometry of its own: it refers to {} other files ({}{}); export the assembly with its parts in one "
        "file",
        step.external_files.size(),
        fmt::join(step.external_files.begin(), step.external_files.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < step.external_files.size() ? ", …" : "");
  }
  if (step.tessellated > 0)
    return "has triangles only (AP242 tessellation) and no exact faces; export exact geometry, or an STL for its mesh";
  if (step.csg > 0)
    return "has solids as operations on primitives (CSG) and no faces; export it as boundary representation (B-rep)";
  if (step.schema.starts_with("IFC")) return "is an IFC building model; export the part as STEP (AP214 or AP242)";
  return fmt::format("has no faces (schema {}); export the part as solids or surfaces",
                     step.schema.empty() ? "not named" : step.schema);
}

void clean_name(std::string& name) {
  std::erase_if(name, [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

class PartReading {
 public:
  PartReading(std::string_view bytes, std::string name, const ReadOptions& options)
      : bytes_(bytes), name_(std::move(name)), options_(options) {}

  Part run() {
    if (bytes_.empty()) fail("the file is empty");
    if (bytes_.size() > kMaxFile_bytes)
      fail(fmt::format("{:.0f} MB are more than can be read (400 MB); export the cover alone",
                       static_cast<double>(bytes_.size()) / kMegabyte));
    const bool is_iges_file = is_iges(bytes_) || (has_iges_name(name_) && !is_step(bytes_));
    is_iges_file ? check_iges() : check_step();
    // The reader of STEP takes a line with the entities that are switched off before the file.
    if (!is_iges_file) step_.text.insert(0, fmt::format("{}\n", fmt::join(step_.hidden, " ")));
    Part part = read(is_iges_file ? "iges" : "step", is_iges_file ? bytes_ : std::string_view(step_.text));
    part.format = is_iges_file ? "IGES" : "STEP " + step_.schema;
    part.warnings.insert(part.warnings.begin(), step_.warnings.begin(), step_.warnings.end());
    if (!step_.external_files.empty()) {
      part.warnings.push_back(fmt::format("the file refers to {} other files, which are not read, first {}",
                                          step_.external_files.size(), step_.external_files.front()));
    }
    if (!is_iges_file && part.faces.size() < static_cast<std::size_t>(step_.faces)) {
      part.warnings.push_back(fmt::format("the file holds {} faces, of which {} belong to no body that could be read",
                                          step_.faces, static_cast<std::size_t>(step_.faces) - part.faces.size()));
    }
    if (part.mesh.faces.empty())
      fail(is_iges_file ? "has no faces; export the part as surfaces or solids" : nothing_left(part));
    for (Face& face : part.faces) clean_name(face.name);
    for (Body& body : part.bodies) {
      clean_name(body.name);
      clean_name(body.path);
    }
    warn_of_hidden(part);
    judge(part, is_iges_file);
    return part;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}", name_, what)); }

  void check_step() {
    try {
      step_ = read_step_text(bytes_);
    } catch (const InputError& e) {
      fail(e.what());
    }
    for (std::string& file : step_.external_files) clean_name(file);
    if (step_.faces == 0) step_refers_elsewhere();
  }
  // Faces of other kinds of models (GEOMETRIC_SET of surfaces) have no face entity, so the kernel decides on those.
  void step_refers_elsewhere() const {
    if (!step_.external_files.empty() || step_.tessellated > 0 || step_.csg > 0) fail(no_geometry(step_));
  }
  void check_iges() const {
    const std::string kind = is_iges(bytes_) ? std::string() : looks_like(bytes_);
    if (!is_iges(bytes_))
      fail(kind.empty() ? "not an IGES file: its first line has no section letter in column 73"
                        : "not an IGES file: it looks like " + kind);
    const std::size_t last = bytes_.find_last_not_of(" \r\n\t\x1a");
    const std::size_t line = bytes_.rfind('\n', last);
    const std::string_view end = bytes_.substr(line == std::string_view::npos ? 0 : line + 1, 80);
    if (end.size() <= 72 || end[72] != 'T') fail("the file ends before its last section (T); it was cut, get it again");
    if (bytes_.find('\0') != std::string_view::npos) fail("a byte 0 has no place in an IGES file; the file is damaged");
  }
  [[nodiscard]] std::string nothing_left(const Part& part) const {
    return part.faults.empty() ? no_geometry(step_)
                               : fmt::format("nothing of it can be used: {}", fmt::join(part.faults, "; "));
  }

  [[nodiscard]] ProcessLimits limits() const {
    const double size_mb = static_cast<double>(bytes_.size()) / kMegabyte;
    ProcessLimits limits;
    limits.wall_s = kWallTimes * options_.time_limit_s;
    limits.processor_s = std::min(options_.time_limit_s, kProcessor_s + kProcessorPerMegabyte_s * size_mb);
    const double extra_mb = kMemoryPerMegabyte * std::max(0.0, size_mb - kMemoryFreeSize_mb);
    const std::uint64_t memory_mb =
        options_.memory_mb > 0 ? options_.memory_mb : kMemory_mb + static_cast<std::uint64_t>(extra_mb);
    limits.memory_bytes = memory_mb * 1'000'000;
    return limits;
  }

  [[nodiscard]] Part read(const std::string& format, std::string_view text) const {
    const auto program = find_reader();
    if (!program)
      fail(
          "this triskin was built without the reader of CAD files; install the package libocct-data-exchange-dev and "
          "build again, or export the part as STL, OBJ or 3MF");
    const ProcessLimits bounds = limits();
    const ProcessResult result = run_limited(
        *program, {format, fmt::format("{}", options_.unit_mm), fmt::format("{}", options_.max_deviation_mm)}, text,
        bounds);
    const ReaderOutput said = parse_frames(result.output);
    if (said.part) return decode_part(*said.part);
    fail(reason(result, said, bounds));
  }
  static std::string reason(const ProcessResult& result, const ReaderOutput& said, const ProcessLimits& limits) {
    const std::string stage = said.stage.empty() ? "before it began to read" : "while " + said.stage;
    if (said.error) return *said.error + " (" + stage + ")";
    constexpr const char* kRemedy =
        "the file is damaged or beyond it; check the part in the CAD program and export it again";
    if (result.end == ProcessEnd::kOutOfTime)
      return fmt::format("the geometry kernel did not end within {:.0f} s of processor time or {:.0f} s ({}); {}",
                         limits.processor_s, limits.wall_s, stage, kRemedy);
    if (result.end == ProcessEnd::kCrashed)
      return fmt::format("the geometry kernel crashed (signal {}, {}); {}", result.signal, stage, kRemedy);
    return fmt::format("the reader of CAD files ended without an answer ({}); {}", stage, kRemedy);
  }

  static void warn_of_hidden(Part& part) {
    std::vector<std::string> names;
    std::vector<bool> has_shown(part.bodies.size(), false), has_hidden = has_shown;
    int faces = 0;
    for (const Face& face : part.faces) {
      (face.is_hidden ? has_hidden : has_shown)[static_cast<std::size_t>(face.body)] = true;
      faces += face.is_hidden ? 1 : 0;
    }
    for (std::size_t b = 0; b < part.bodies.size(); ++b) {
      if (!has_hidden[b]) continue;
      const std::string name = part.bodies[b].name.empty() ? fmt::format("body {}", b) : part.bodies[b].name;
      names.push_back(has_shown[b] ? "faces of " + name : name);
    }
    if (names.empty()) return;
    part.warnings.push_back(
        fmt::format("switched off in the CAD program and left out: {} ({}); --object takes one body",
                    short_list(names, 5), counted(faces, "face")));
  }

  void judge(Part& part, bool is_iges_file) const {
    const design::Vec3 size = size_of(part);
    const bool has_unit = !part.unit.empty() && (is_iges_file || step_.has_length_unit);
    if (!has_unit) part.unit.clear();
    if (!has_unit && !part.unit_given)
      part.warnings.push_back(
          fmt::format("the file names no unit of length that can be read: its numbers were taken for millimetres, "
                      "which gives {:.4g} × "
                      "{:.4g} × {:.4g} mm; --unit says another",
                      size.x(), size.y(), size.z()));
    if (part.unit_given || (size.norm() >= kSmallestPart_mm && size.norm() <= kLargestPart_mm)) return;
    part.warnings.push_back(
        fmt::format("the part is {} {:.4g} mm across; if the unit is wrong, give the right one with --unit",
                    size.norm() < kSmallestPart_mm ? "only" : "as much as", size.norm()));
  }

  std::string_view bytes_;
  std::string name_;
  ReadOptions options_;
  StepText step_;
};

}  // namespace

bool is_cad_file(const std::filesystem::path& path, std::string_view bytes) {
  return is_step(bytes) || is_iges(bytes) || has_step_name(path) || has_iges_name(path);
}

bool can_read_parts() {
  return find_reader().has_value();
}

Part read_part_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options) {
  return PartReading(bytes, name, options).run();
}

Part read_part(const std::filesystem::path& path, const ReadOptions& options) {
  return read_part_bytes(read_file(path), path.string(), options);
}

}  // namespace triskin::cad
