// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "triskin/base/error.hpp"

namespace triskin::hdf5 {

/// Owns an object of the library and closes it.
class Handle {
 public:
  /// Takes ownership of an object. Throws InputError naming `what` when the library could not make it.
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw InputError(fmt::format("HDF5 cannot make {}", what));
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  [[nodiscard]] hid_t id() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Throws InputError naming `what` when the library reports an error.
inline void require(herr_t status, const std::string& what) {
  if (status < 0) throw InputError(fmt::format("HDF5 cannot write {}", what));
}

/// Adds attribute `name` with a value in memory. Throws as require().
inline void write_attribute(hid_t object, const std::string& name, hid_t stored, hid_t given, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, name);
  const Handle attribute(H5Acreate2(object, name.c_str(), stored, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         name);
  require(H5Awrite(attribute.id(), given, value), name);
}

/// Adds attribute `name` with a text of variable length, which readers have as text: one of fixed length is bytes to
/// h5py. Throws as require().
inline void write_text(hid_t object, const std::string& name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, name);
  require(H5Tset_size(type.id(), H5T_VARIABLE), name);
  require(H5Tset_cset(type.id(), H5T_CSET_UTF8), name);
  const char* text = value.c_str();
  write_attribute(object, name, type.id(), type.id(), static_cast<const void*>(&text));
}
/// Adds attribute `name` with a whole number. Throws as require().
inline void write_number(hid_t object, const std::string& name, std::uint64_t value) {
  write_attribute(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, &value);
}
/// Adds attribute `name` with a number. Throws as require().
inline void write_number(hid_t object, const std::string& name, double value) {
  write_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

}  // namespace triskin::hdf5
