// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/export.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

#include "triskin/cli/command.hpp"
#include "triskin/host/error.hpp"
#include "triskin/host/files.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/view/page.hpp"

namespace triskin::cli {
namespace {

struct Format {
  const char* suffix;
  std::string (*write)(const design::Design&);
};
const std::map<std::string, Format> kFormats{{"picture", {".svg", design::picture_svg}},
                                             {"taxels", {".taxels.csv", design::taxels_csv}},
                                             {"assembly", {".assembly.html", design::assembly_html}},
                                             {"modules", {".modules.obj", design::modules_obj}},
                                             {"html", {".html", view::page_html}},
                                             {"gltf", {".gltf", design::gltf}},
                                             {"urdf", {".urdf", design::urdf}},
                                             {"sdf", {".sdf", design::sdf}}};

struct Options {
  std::string design, format, output;
};

std::string extension_of(const std::string& file) {
  return std::filesystem::path(file).extension().string();
}
std::string extension_of(const Format& format) {
  return extension_of(std::string("name") + format.suffix);  // ".svg" alone would be a hidden file without extension
}

// What is asked for by name, else by the extension of the file. An extension that says something else is refused.
const Format& format_of(const Options& options) {
  const bool has_file = !options.output.empty() && options.output != "-" && !extension_of(options.output).empty();
  if (options.format.empty()) {
    for (const auto& [name, format] : kFormats) {
      if (has_file && extension_of(options.output) == extension_of(format)) return format;
    }
    throw InputError(
        "export: say what to write with --format, or by the extension of -o: .svg, .csv, .html, .obj, .gltf, .urdf or "
        ".sdf");
  }
  const Format& format = kFormats.at(options.format);
  if (has_file && extension_of(options.output) != extension_of(format)) {
    throw InputError(
        fmt::format("{}: the format {} is written to files that end with {}; rename it or choose another format",
                    options.output, options.format, extension_of(format)));
  }
  return format;
}

int run(const Options& options, Output& output) {
  const Format& format = format_of(options);
  const design::Design design = robot::read_shown(options.design);
  const std::string path = options.output.empty()
                               ? std::filesystem::path(options.design).replace_extension(format.suffix).string()
                               : options.output;
  write_output(path, format.write(design));
  output.result = {{"files", {path}}};
  output.say(path);
  return 0;
}

const Registration kExport{{
    "export",
    "write a picture, the taxel list, the assembly sheet, a page, or the modules for other programs",
    "triskin export forearm.design.json --format picture -o forearm.svg",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design,
                     "design file, or robot file: all of its covers in the frame of its base")
          ->required();
      std::vector<std::string> names;
      for (const auto& [name, format] : kFormats) names.push_back(name);
      app.add_option("--format", options->format, "what to write; without it the extension of -o says so")
          ->check(CLI::IsMember(names));
      app.add_option("-o,--output", options->output, "file; without it beside the design");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
