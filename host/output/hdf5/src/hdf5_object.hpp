// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
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

/// Adds attribute `name` with a text. Throws as require().
inline void write_text(hid_t object, const std::string& name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, name), space(H5Screate(H5S_SCALAR), H5Sclose, name);
  require(H5Tset_size(type.id(), std::max<std::size_t>(1, value.size())), name);
  require(H5Tset_cset(type.id(), H5T_CSET_UTF8), name);
  const Handle attribute(H5Acreate2(object, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         name);
  require(H5Awrite(attribute.id(), type.id(), value.empty() ? "" : value.data()), name);
}

}  // namespace triskin::hdf5
