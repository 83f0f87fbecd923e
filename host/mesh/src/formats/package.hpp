// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>

namespace triskin::geometry {

/// A zip archive in memory.
class Package {
 public:
  /// `bytes` outlives the package. Errors: InputError naming `name` where they are no archive, or one that was cut.
  Package(const std::string& bytes, std::string name);
  ~Package();
  Package(const Package&) = delete;
  Package& operator=(const Package&) = delete;

  /// Is a part there? Upper and lower case are the same, a slash at the beginning is left out.
  [[nodiscard]] bool has(const std::string& part);
  /// Contents of a part. Errors: InputError naming it where it is missing, damaged (CRC-32), encrypted or larger than
  /// 2 GB. Cost: linear.
  [[nodiscard]] std::string read(const std::string& part);

 private:
  struct Stream;
  [[noreturn]] void fail(const std::string& what) const;
  bool locate(const std::string& part);

  std::string name_;
  std::unique_ptr<Stream> stream_;
  void* zip_ = nullptr;
};

}  // namespace triskin::geometry
