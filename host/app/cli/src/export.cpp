// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/exports/export.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

#include "command.hpp"
#include "design_argument.hpp"
#include "recorded_track.hpp"
#include "shown_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/exports/icub_files.hpp"
#include "triskin/exports/simulators.hpp"
#include "triskin/hdf5/taxel_table.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/sheet/sheet.hpp"
#include "triskin/view/frame_track.hpp"
#include "triskin/view/page.hpp"

namespace triskin::cli::export_command {
namespace {

struct Options {
  std::string design, format, output, body;
  exports::CoverBody cover;
  sheet::Paper paper = sheet::Paper::kA4;
  bool switched = false;
};

struct Format {
  const char* suffix;
  std::string (*write)(const ShownDesign&, const Options&);
  // Of a robot each cover has a file of its own, NAME.COVER.pdf, with the numbers of its design.
  bool has_file_a_cover = false;
};
template <std::string (*write)(const design::Design&)>
std::string plain(const ShownDesign& shown, const Options& /*options*/) {
  return write(shown.design);
}
template <std::string (*write)(const design::Design&, const exports::CoverBody&)>
std::string model(const ShownDesign& shown, const Options& options) {
  return write(shown.design, options.cover);
}
template <exports::MjcfTouch touch>
std::string mjcf(const ShownDesign& shown, const Options& options) {
  return exports::mjcf(shown.design, touch, options.body);
}
template <std::string (*write)(const design::Design&, sheet::Paper, sheet::SheetModules)>
std::string on_paper(const ShownDesign& shown, const Options& options) {
  return write(shown.design, options.paper,
               options.switched ? sheet::SheetModules::kSwitched : sheet::SheetModules::kStrapped);
}
std::string page(const ShownDesign& shown, const Options& options) {
  view::Notes notes = shown.notes;
  notes.has_switched_modules = options.switched;
  return view::page_html(shown.design, {}, notes);
}
const std::map<std::string, Format> kFormats{
    {"picture", {".svg", plain<exports::picture_svg>}},
    {"taxels", {".taxels.csv", plain<exports::taxels_csv>}},
    {"modules", {".modules.obj", plain<exports::modules_obj>}},
    {"html", {".html", page}},
    {"gltf", {".gltf", plain<exports::gltf>}},
    {"urdf", {".urdf", model<exports::urdf>}},
    {"sdf", {".sdf", model<exports::sdf>}},
    {"mjcf", {".mjcf.xml", mjcf<exports::MjcfTouch::kTactile>}},
    {"mjcf-touch", {".touch.xml", mjcf<exports::MjcfTouch::kSites>}},
    {"taxel-list", {".taxels.json", plain<exports::taxel_list_json>}},
    {"npz", {".npz", plain<exports::taxel_list_npz>}},
    {"hdf5", {".h5", plain<hdf5::taxel_table>}},
    {"icub-positions", {".positions.txt", plain<exports::icub_positions>, true}},
    {"icub-skingui", {".skingui.ini", plain<exports::icub_skingui>, true}},
    {"pdf", {".pdf", on_paper<sheet::pdf>, true}},
    {"sheet-svg", {".sheet.svg", on_paper<sheet::svg>, true}}};

std::map<std::string, sheet::Paper> papers() {
  std::map<std::string, sheet::Paper> papers;
  for (const auto& [paper, name] : sheet::kPaperNames.rows()) papers.emplace(name, paper);
  return papers;
}

std::string ending_of(const Format& format) {
  // The name ".svg" alone would be a hidden file without an extension.
  return extension_of(std::string("name") + format.suffix);
}

// Returns the format given by name, or else by the extension of the file. An extension that contradicts the name is
// refused.
const Format& format_of(const Options& options) {
  const bool has_file = !options.output.empty() && options.output != "-" && !extension_of(options.output).empty();
  if (options.format.empty()) {
    for (const auto& [name, format] : kFormats) {
      if (has_file && extension_of(options.output) == ending_of(format)) return format;
    }
    throw InputError(
        "export: say what to write with --format, or by the extension of -o: .svg, .csv, .html, .obj, .gltf, .urdf, "
        ".sdf, .xml, .json, .npz, .pdf, .h5, .txt or .ini");
  }
  const Format& format = kFormats.at(options.format);
  if (has_file && extension_of(options.output) != ending_of(format)) {
    throw InputError(
        fmt::format("{}: the format {} is written to files that end with {}; rename it or choose another format",
                    options.output, options.format, ending_of(format)));
  }
  return format;
}

std::string recorded_page(const Options& options, Output& output) {
  if (options.format != "html")
    throw InputError(fmt::format(
        "{}: a recording is exported as a page only: --format html; other formats take a design", options.design));
  const RecordedTrack track = read_track(options.design, view::FrameTrack::kMaxInFile_bytes);
  if (!track.remark.empty()) output.say(track.remark);
  view::Notes notes;
  notes.counts_per_kpa = view::counts_per_kpa_of(track.skin.calibration);
  return view::page_html(track.skin.design, track.frames, notes);
}

std::vector<std::string> write_covers(const Options& options, const Format& format, const std::string& path) {
  std::vector<std::string> files;
  for (design::Design& cover : read_covers(options.design)) {
    const std::filesystem::path whole(path);
    files.push_back(
        (whole.parent_path() / (whole.stem().string() + "." + cover.name + whole.extension().string())).string());
    write_output(files.back(), format.write({std::move(cover), {{}}}, options));
  }
  return files;
}

int run(const Options& options, Output& output) {
  const Format& format = format_of(options);
  const bool is_model = format.suffix == std::string(".urdf") || format.suffix == std::string(".sdf");
  if (!is_model && (!options.cover.mesh_uri.empty() || options.cover.mass_kg > 0.0))
    throw InputError("export: --mesh-uri and --mass-kg are for the formats urdf and sdf");
  if (!options.cover.mesh_uri.empty() && !options.cover.mesh_uri.ends_with(".stl"))
    throw InputError(fmt::format("export: --mesh-uri {}: the mesh is an STL file; let the name end with .stl",
                                 options.cover.mesh_uri));
  const std::string path = options.output.empty()
                               ? std::filesystem::path(options.design).replace_extension(format.suffix).string()
                               : options.output;
  std::vector<std::string> files{path};
  if (is_recording(options.design)) {
    write_output(path, recorded_page(options, output));
  } else if (format.has_file_a_cover && robot::is_robot_file(options.design)) {
    if (path == "-")
      throw InputError(fmt::format("export: the format {} has a file for each cover of a robot; give -o a file",
                                   options.format.empty() ? extension_of(options.output) : options.format));
    files = write_covers(options, format, path);
  } else {
    const ShownDesign shown = read_shown_design(options.design, false);
    if (!robot::is_robot_file(options.design)) say_if_changed(shown.design, options.design, output);
    write_output(path, format.write(shown, options));
    if (const std::string& uri = options.cover.mesh_uri; !uri.empty()) {
      if (path == "-") throw InputError("export: --mesh-uri writes a file beside that of -o; give -o a file");
      files.push_back((std::filesystem::path(path).parent_path() / std::filesystem::path(uri).filename()).string());
      write_output(files.back(), exports::cover_stl(shown.design));
    }
  }
  output.result = {{"files", files}};
  for (const std::string& file : files) output.say(file);
  return 0;
}

const Registration kExport{{
    "export",
    "write a picture, the taxel list, the assembly sheet, a page, or the modules for other programs",
    "triskin export forearm.design.json --format picture -o forearm.svg",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design,
                     "design file, or robot file: all of its covers in the frame of its base; for the format html also "
                     "a recording (.mcap)")
          ->required();
      std::vector<std::string> names;
      for (const auto& [name, format] : kFormats) names.push_back(name);
      app.add_option("--format", options->format, "format (default: by the extension of -o)")
          ->check(CLI::IsMember(names));
      app.add_option("-o,--output", options->output, "output file (default: beside the design)");
      app.add_option("--body", options->body,
                     "mjcf, mjcf-touch: body of the robot's model that the cover is fixed to (default: the world)");
      app.add_option(
          "--mesh-uri", options->cover.mesh_uri,
          "urdf, sdf: the cover's surface is written beside the file, as STL in m, and the model names it so "
          "(package://my_robot/meshes/forearm.stl)");
      app.add_option("--mass-kg", options->cover.mass_kg,
                     "urdf, sdf: mass of cover, boards and cables, spread evenly over the surface (default: none)")
          ->check(CLI::Range(1e-6, 1e3));
      app.add_option("--prefix", options->cover.prefix,
                     "urdf: before the names of links, so that two covers fit one robot");
      app.add_option("--paper", options->paper, "pdf, sheet-svg: paper size; roll: 610 mm wide, as long as needed")
          ->transform(one_of(papers()))
          ->default_str("A4");
      app.add_flag("--switched", options->switched,
                   "pdf, sheet-svg, html: the modules are switched and have second cables");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::export_command
