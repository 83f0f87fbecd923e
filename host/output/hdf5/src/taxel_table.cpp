// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hdf5/taxel_table.hpp"

#include "triskin/base/error.hpp"

#ifdef TRISKIN_HDF5
#include <vector>

#include "hdf5_object.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::hdf5 {
namespace {

// A table has `columns` numbers per row; one column makes a plain list. `unit` and `meaning` become attributes.
struct TableColumn {
  const char* name;
  const char* unit;
  const char* meaning;
};
void write_table(hid_t file, const TableColumn& column, hsize_t rows, hsize_t columns, hid_t stored, hid_t given,
                 const void* values) {
  const hsize_t size[2]{rows, columns};
  const Handle space(H5Screate_simple(columns == 1 ? 1 : 2, size, nullptr), H5Sclose, column.name);
  const Handle wish(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, column.name);
  require(H5Pset_obj_track_times(wish.id(), false), column.name);  // A time stamp would make equal designs differ.
  const Handle table(H5Dcreate2(file, column.name, stored, space.id(), H5P_DEFAULT, wish.id(), H5P_DEFAULT), H5Dclose,
                     column.name);
  require(H5Dwrite(table.id(), given, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), column.name);
  write_text(table.id(), "unit", column.unit);
  write_text(table.id(), "meaning", column.meaning);
}

struct Rows {
  std::vector<std::string> cover;
  std::vector<int> module, taxel, patch, line, address, pressure;
  std::vector<double> position_mm, normal;
};

Rows rows_of(const design::Design& design) {
  Rows rows;
  const auto wiring = design::wiring_of(design);
  for (std::size_t k = 0; k < wiring.size(); ++k) {
    const design::NamedCover* cover = design::cover_of(design, static_cast<int>(k));
    const int first_patch = cover == nullptr ? 0 : cover->first.patch;
    const auto taxels = design::taxels_of(design.layout.modules[k], wiring[k].routed.rotation);
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      rows.cover.push_back(cover == nullptr ? design.name : cover->name);
      rows.module.push_back(design::number_of(design, static_cast<int>(k)).value);
      rows.taxel.push_back(static_cast<int>(t));
      rows.patch.push_back(wiring[k].patch < 0 ? -1 : wiring[k].patch - first_patch);
      rows.line.push_back(wiring[k].patch < 0 ? -1 : wiring[k].routed.line);
      rows.address.push_back(wiring[k].patch < 0 ? -1 : wiring[k].routed.address);
      rows.pressure.push_back(layout::measures_pressure(t) ? 1 : 0);
      for (int x = 0; x < 3; ++x) {
        rows.position_mm.push_back(taxels[t].position_mm[x]);
        rows.normal.push_back(taxels[t].normal[x]);
      }
    }
  }
  return rows;
}

void write_rows(hid_t file, const Rows& rows) {
  const hsize_t n = rows.module.size();
  const auto list = [&](const TableColumn& column, const std::vector<int>& values) {
    write_table(file, column, n, 1, H5T_STD_I32LE, H5T_NATIVE_INT, values.data());
  };
  const Handle text(H5Tcopy(H5T_C_S1), H5Tclose, "cover");
  require(H5Tset_size(text.id(), H5T_VARIABLE), "cover");
  require(H5Tset_cset(text.id(), H5T_CSET_UTF8), "cover");
  std::vector<const char*> covers;
  for (const std::string& name : rows.cover) covers.push_back(name.c_str());
  write_table(file, {"cover", "1", "name of the cover: of the design, or of its cover on a robot"}, n, 1, text.id(),
              text.id(), static_cast<const void*>(covers.data()));
  list({"module", "1", "number in the design of its cover"}, rows.module);
  list({"taxel", "1", "input of the converter, 0 to 11"}, rows.taxel);
  list({"patch", "1", "patch (controller) in the design of its cover, -1: none"}, rows.patch);
  list({"line", "1", "I2C line 0 to 3, -1: none"}, rows.line);
  list({"address", "1", "address strap 0 to 3, -1: none"}, rows.address);
  list({"measures_pressure", "1", "1: pressure, 0: temperature"}, rows.pressure);
  write_table(file, {"position", "mm", "centre of the taxel, mesh frame"}, n, 3, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
              rows.position_mm.data());
  write_table(file, {"normal", "1", "outward unit normal, mesh frame"}, n, 3, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
              rows.normal.data());
}

std::string image_of(hid_t file) {
  require(H5Fflush(file, H5F_SCOPE_GLOBAL), "the file");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw InputError("HDF5 cannot write the file");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) < 0) throw InputError("HDF5 cannot write the file");
  return bytes;
}

}  // namespace

bool can_write() {
  return true;
}

std::string taxel_table(const design::Design& design) {
  if (design.layout.modules.empty())
    throw InputError("export: the design has no module, so it has no taxels; make it again with triskin design");
  constexpr std::size_t kGrowth_bytes = 1U << 16U;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "a file"),
      create(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "a file");
  require(H5Pset_fapl_core(access.id(), kGrowth_bytes, false), "into memory");
  require(H5Pset_obj_track_times(create.id(), false), "a file");
  const Handle file(H5Fcreate("taxels.h5", H5F_ACC_TRUNC, create.id(), access.id()), H5Fclose, "a file");
  write_text(file.id(), "format", "triskin-taxels");
  write_number(file.id(), "version", std::uint64_t{1});
  write_text(file.id(), "name", design.name);
  write_text(file.id(), "design_id", fmt::format("{:016x}", design.design_id));
  write_rows(file.id(), rows_of(design));
  return image_of(file.id());
}

}  // namespace triskin::hdf5

#else

namespace triskin::hdf5 {

bool can_write() {
  return false;
}

std::string taxel_table(const design::Design& /*design*/) {
  throw InputError(
      "this triskin was built without HDF5; install the package libhdf5-dev and build again, or use --format taxels "
      "(CSV)");
}

}  // namespace triskin::hdf5

#endif
