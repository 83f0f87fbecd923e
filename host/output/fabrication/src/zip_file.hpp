// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <minizip/zip.h>

#include <filesystem>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin::fabrication {

/// A zip file that is being written. Errors: InputError naming the file when it cannot be written.
class ZipFile {
 public:
  explicit ZipFile(const std::filesystem::path& path)
      : path_(path), zip_(::zipOpen64(path.c_str(), APPEND_STATUS_CREATE)) {
    if (zip_ == nullptr) fail();
  }
  ZipFile(const ZipFile&) = delete;
  ZipFile& operator=(const ZipFile&) = delete;
  ~ZipFile() {
    if (zip_ != nullptr) ::zipClose(zip_, nullptr);
  }
  void add(const std::string& name, const std::string& bytes) {
    const zip_fileinfo no_date{};  // A fixed date makes equal content give equal bytes.
    const bool is_written = ::zipOpenNewFileInZip(zip_, name.c_str(), &no_date, nullptr, 0, nullptr, 0, nullptr,
                                                  Z_DEFLATED, Z_DEFAULT_COMPRESSION) == ZIP_OK &&
                            ::zipWriteInFileInZip(zip_, bytes.data(), static_cast<unsigned>(bytes.size())) == ZIP_OK &&
                            ::zipCloseFileInZip(zip_) == ZIP_OK;
    if (!is_written) fail();
  }
  void close() {
    const bool is_closed = ::zipClose(zip_, nullptr) == ZIP_OK;
    zip_ = nullptr;
    if (!is_closed) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw InputError(
        fmt::format("{}: cannot be written; look at the folder and the space on the disk", path_.string()));
  }
  std::filesystem::path path_;
  zipFile zip_;
};

}  // namespace triskin::fabrication
