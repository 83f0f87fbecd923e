// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>

namespace triskin::mesh {

/// Reads the parts of a zip archive in memory.
class Package {
 public:
  /// `bytes` must outlive the package. Errors: InputError naming `name` if they are no archive, or a truncated one.
  Package(const std::string& bytes, std::string name);
  ~Package();
  Package(const Package&) = delete;
  Package& operator=(const Package&) = delete;

  /// Tells whether a part exists. Case is ignored, and so is a slash at the beginning.
  [[nodiscard]] bool has(const std::string& part);
  /// Returns the contents of a part. Errors: InputError naming it if it is missing, damaged (CRC-32), encrypted or
  /// larger than 2 GB. Cost: linear.
  [[nodiscard]] std::string read(const std::string& part);

 private:
  struct Stream;
  [[noreturn]] void fail(const std::string& what) const;
  bool locate(const std::string& part);

  std::string name_;
  std::unique_ptr<Stream> stream_;
  void* zip_ = nullptr;
};

}  // namespace triskin::mesh
