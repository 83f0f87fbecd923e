// SPDX-License-Identifier: GPL-3.0-or-later
#include "package.hpp"

#include <fmt/format.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "triskin/base/error.hpp"

namespace triskin::mesh {

constexpr std::size_t kMaxBytes = 2'000'000'000;

// The library reads files; these functions let it read the bytes like one.
struct Package::Stream {
  const std::string& bytes;
  std::size_t at = 0;

  static void* open(void* self, const void*, int) { return self; }
  static uLong read(void*, void* self, void* into, uLong size) {
    auto& s = *static_cast<Stream*>(self);
    const std::size_t n = std::min<std::size_t>(size, s.bytes.size() - s.at);
    std::memcpy(into, s.bytes.data() + s.at, n);
    s.at += n;
    return n;
  }
  static uLong write(void*, void*, const void*, uLong) { return 0; }
  static ZPOS64_T tell(void*, void* self) { return static_cast<Stream*>(self)->at; }
  static long seek(void*, void* self, ZPOS64_T offset, int origin) {
    auto& s = *static_cast<Stream*>(self);
    const std::size_t base = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                             : origin == ZLIB_FILEFUNC_SEEK_CUR ? s.at
                                                                : s.bytes.size();
    if (base + offset > s.bytes.size()) return -1;
    s.at = base + offset;
    return 0;
  }
  static int close(void*, void*) { return 0; }
  static int error(void*, void*) { return 0; }
};

Package::Package(const std::string& bytes, std::string name)
    : name_(std::move(name)), stream_(std::make_unique<Stream>(Stream{bytes})) {
  zlib_filefunc64_def calls{&Stream::open, &Stream::read,  &Stream::write, &Stream::tell,
                            &Stream::seek, &Stream::close, &Stream::error, stream_.get()};
  zip_ = unzOpen2_64(name_.c_str(), &calls);
  if (zip_ == nullptr) fail("its archive has no table of contents: it was cut, or it is no archive");
}

Package::~Package() {
  if (zip_ != nullptr) unzClose(zip_);
}

void Package::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: not a mesh that can be read ({}); copy or export it again", name_, what));
}

bool Package::locate(const std::string& part) {
  constexpr int kAnyCase = 2;
  const std::string name = part.substr(part.starts_with('/') ? 1 : 0);
  return unzLocateFile(zip_, name.c_str(), kAnyCase) == UNZ_OK;
}

bool Package::has(const std::string& part) {
  return locate(part);
}

std::string Package::read(const std::string& part) {
  const std::string shown = part.substr(0, 80);
  if (!locate(part)) fail(fmt::format("its part {} is missing", shown));
  unz_file_info64 info{};
  if (unzGetCurrentFileInfo64(zip_, &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK)
    fail(fmt::format("its part {} is damaged", shown));
  if ((info.flag & 1U) != 0) fail(fmt::format("its part {} is encrypted", shown));
  if (unzOpenCurrentFile(zip_) != UNZ_OK) fail(fmt::format("its part {} is damaged", shown));
  std::string bytes;
  std::vector<char> buffer(1U << 16U);
  int got = 0;
  while ((got = unzReadCurrentFile(zip_, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0) {
    bytes.append(buffer.data(), static_cast<std::size_t>(got));
    if (bytes.size() > kMaxBytes) fail("it is too large");
  }
  const bool is_whole = unzCloseCurrentFile(zip_) == UNZ_OK && got == 0 && bytes.size() == info.uncompressed_size;
  if (!is_whole) fail(fmt::format("its part {} is damaged", shown));
  return bytes;
}

}  // namespace triskin::mesh
