// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/fabrication/fabricate.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "assembly.hpp"
#include "bend.hpp"
#include "board_art.hpp"
#include "controller_nets.hpp"
#include "kicad.hpp"
#include "panel.hpp"
#include "parts_list.hpp"
#include "solids.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/cad/read_part.hpp"
#include "triskin/sheet/sides.hpp"
#include "zip_file.hpp"

namespace triskin::fabrication {
namespace {

namespace fs = std::filesystem;

void require_thickness(double thickness_mm, const char* what) {
  constexpr double kMin_mm = 0.1, kMax_mm = 20.0;
  if (!(thickness_mm >= kMin_mm && thickness_mm <= kMax_mm))
    throw InputError(fmt::format("{} of {} mm is out of range: {} … {} mm", what, thickness_mm, kMin_mm, kMax_mm));
}

// Makes a folder that gets its name when all files are in it, and is removed otherwise.
class NewFolder {
 public:
  explicit NewFolder(const fs::path& folder) : folder_(folder.has_filename() ? folder : folder.parent_path()) {
    std::error_code error;
    if (fs::exists(folder_, error) && !fs::is_empty(folder_, error))
      throw InputError(fmt::format("{}: has files in it already; name another folder, or empty it", folder_.string()));
    temporary_ = folder_;
    temporary_ += fmt::format(".{}.part", ::getpid());
    fs::create_directories(temporary_, error);
    if (error) fail(error);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return temporary_; }
  void commit() {
    std::error_code error;
    fs::remove(folder_, error);  // An empty folder of this name may exist.
    fs::rename(temporary_, folder_, error);
    if (error) fail(error);
    temporary_.clear();
  }

 private:
  [[noreturn]] void fail(const std::error_code& error) const {
    throw InputError(fmt::format("{}: cannot be made: {}", folder_.string(), error.message()));
  }
  fs::path folder_, temporary_;
};

class Fabrication {
 public:
  Fabrication(const design::Design& design, const fs::path& folder, const FabricationOptions& options)
      : design_(design),
        options_(options),
        sides_(sheet::sides_of(design)),
        islands_(flat_islands(design, sides_, options.corner_relief_mm)),
        folder_(folder) {}

  FabricationReport run() {
    report_.islands = static_cast<int>(islands_.size());
    if (wants(Product::kDxf)) write_drawings();
    if (wants(Product::kKicad) || wants(Product::kOrder)) draw_boards();
    if (wants(Product::kKicad) && !art_.empty()) write_boards();
    if (wants(Product::kParts)) write("parts.csv", parts_csv(parts_of(design_, sides_, islands_)));
    if (wants(Product::kSolids)) write_solids();
    if (wants(Product::kStep)) write_assembly();
    if (wants(Product::kSheets) || wants(Product::kOrder)) lay_on_sheets();
    if (wants(Product::kSheets) && nesting_) write_sheets();
    if (wants(Product::kOrder) && nesting_ && !art_.empty()) write_panels();
    std::ranges::sort(report_.files);
    folder_.commit();
    return std::move(report_);
  }

 private:
  [[nodiscard]] bool wants(Product product) const {
    return options_.products.empty() || options_.products.contains(product);
  }

  void write(const std::string& name, const std::string& bytes) {
    const fs::path path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    write_file_atomically(path, bytes);
    report_.files.push_back(name);
  }

  void write_drawings() {
    for (const FlatIsland& island : islands_) write("dxf/" + island.part_number + ".dxf", island_dxf(island));
  }

  void draw_boards() {
    try {
      for (const FlatIsland& island : islands_) {
        require_bends(design_, sides_, island);
        art_.push_back(board_art(design_, sides_, island));
      }
    } catch (const InputError& e) {
      if (!options_.products.empty()) throw;
      art_.clear();
      report_.left_out.push_back(fmt::format("the boards are left out: {}", e.what()));
    }
  }

  void write_boards() {
    for (const FlatIsland& island : islands_) {
      const std::string name = "kicad/" + island.part_number;
      write(name + ".kicad_pcb", island_board(design_, sides_, island));
      write(name + ".kicad_pro", board_project(island.part_number + ".kicad_pro"));
      write(name + ".net", island_netlist(design_, sides_, island));
    }
    write("kicad/Triskin.pretty/Module.kicad_mod", module_footprint());
    write("kicad/Triskin.kicad_sym", module_symbol());
    write("kicad/Module.net", module_netlist());
    write("kicad/Module.kicad_pcb", module_alone());
    write("kicad/Module.kicad_pro", board_project("Module.kicad_pro"));
    write("kicad/controller.csv", controller_csv());
  }

  static Layer named(Layer layer, const char* name, const std::array<std::uint8_t, 3>& colour) {
    layer.solid.name = name;
    layer.solid.colour = colour;
    return layer;
  }
  void write_solids() {
    std::vector<Solid> modules = module_solids(design_, islands_.front().corner_cut_mm);
    const double mould_end_mm = options_.elastic_mm + options_.wall_mm;
    Layer carrier = named(layer_of(design_.surface, -options_.wall_mm, 0.0), "carrier", {200, 200, 200});
    Layer mould = named(layer_of(design_.surface, options_.elastic_mm, mould_end_mm), "mould", {90, 120, 160});
    report_.carrier_error_mm = carrier.error_mm;
    report_.carrier_folded_faces = carrier.folded_faces;
    report_.mould_error_mm = mould.error_mm;
    report_.mould_folded_faces = mould.folded_faces;
    write("solids/modules.stl", stl(modules));
    write("solids/carrier.stl", stl({carrier.solid}));
    write("solids/mould.stl", stl({mould.solid}));
    modules.push_back(std::move(carrier.solid));
    modules.push_back(std::move(mould.solid));
    write_3mf(folder_.path() / "solids/solids.3mf", modules);
    report_.files.emplace_back("solids/solids.3mf");
  }

  void write_assembly() {
    if (options_.products.empty() && !cad::can_read_parts()) {
      report_.left_out.emplace_back(
          "the STEP assembly is left out: this triskin was built without the program for CAD files "
          "(libocct-data-exchange-dev)");
      return;
    }
    write(plain_name(design_.name) + ".step", assembly_step(design_, islands_.front().corner_cut_mm, report_.left_out));
  }

  void lay_on_sheets() {
    try {
      nesting_ = nest(islands_, options_.sheet);
      report_.sheet_fill = nesting_->fill;
    } catch (const InputError& e) {
      if (!options_.products.empty()) throw;
      report_.left_out.push_back(fmt::format("the sheets are left out: {}", e.what()));
    }
  }

  void write_sheets() {
    for (int sheet = 0; sheet < sheets(); ++sheet)
      write(fmt::format("sheets/sheet_{}.dxf", sheet + 1), sheet_dxf(islands_, *nesting_, sheet, options_.sheet));
    write("sheets/places.csv", places_csv(islands_, *nesting_));
  }
  [[nodiscard]] int sheets() const { return static_cast<int>(nesting_->fill.size()); }

  void write_panels() {
    for (int sheet = 0; sheet < sheets(); ++sheet) {
      const Panel panel = panel_of(islands_, art_, *nesting_, sheet);
      write_archive(fmt::format("order/{}_board.zip", panel.name), panel.board);
      write_archive(fmt::format("order/{}_assembly.zip", panel.name), panel.assembly);
      const double width_mm = panel.size_mm.minCoeff(), length_mm = panel.size_mm.maxCoeff();
      if (width_mm > kMaxPanelWidth_mm || length_mm > kMaxPanelLength_mm)
        report_.advice.push_back(
            fmt::format("{} is {:.0f} x {:.0f} mm; many makers of flexible boards take {:g} x {:g} mm: ask, or give "
                        "--sheet-mm {:g},{:g}",
                        panel.name, panel.size_mm.x(), panel.size_mm.y(), kMaxPanelWidth_mm, kMaxPanelLength_mm,
                        kMaxPanelWidth_mm - 14, kMaxPanelLength_mm - 14));
    }
  }
  void write_archive(const std::string& name, const std::vector<NamedFile>& files) {
    const fs::path path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    ZipFile zip(path);
    for (const NamedFile& file : files) zip.add(file.name, file.bytes);
    zip.close();
    report_.files.push_back(name);
  }

  const design::Design& design_;
  const FabricationOptions& options_;
  sheet::Sides sides_;
  std::vector<FlatIsland> islands_;
  std::vector<BoardArt> art_;  // One for each island, or none if boards are left out.
  std::optional<Nesting> nesting_;
  NewFolder folder_;
  FabricationReport report_;
};

}  // namespace

FabricationReport fabricate(const design::Design& design, const fs::path& folder, const FabricationOptions& options) {
  require_thickness(options.elastic_mm, "an elastic layer");
  require_thickness(options.wall_mm, "a wall");
  return Fabrication(design, folder, options).run();
}

}  // namespace triskin::fabrication
