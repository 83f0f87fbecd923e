// SPDX-License-Identifier: GPL-3.0-or-later
#include "package.hpp"

#include <fmt/format.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string_view>
#include <vector>

#include "triskin/base/error.hpp"

namespace triskin::mesh {

constexpr std::size_t kMaxBytes = 2'000'000'000;

namespace {

// Little-endian; −1 beyond the end.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  if (at > bytes.size() || size > bytes.size() - at) return ~std::uint64_t{0};
  std::uint64_t value = 0;
  for (std::size_t k = size; k-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

// lib3mf writes each part with Zip64 sizes, which minizip 1.1 of Debian never reads where long has 64 bits: it compares
// 0xFFFFFFFF with −1. Where a size or place fits into the 32 bits of the table of contents, it is put there: by
// position in the archive, the byte to read. APPNOTE.TXT of PKWARE, 4.3.12, 4.3.14, 4.3.15, 4.5.3.
std::map<std::size_t, char> sizes_in_32_bits(std::string_view bytes) {
  constexpr std::uint64_t kInZip64 = 0xFFFFFFFF;
  std::map<std::size_t, char> replaced;
  const std::size_t end = bytes.rfind("PK\5\6");
  if (end == std::string_view::npos) return replaced;
  std::uint64_t at = number_at(bytes, end + 16, 4);
  if (at == kInZip64 && end >= 20) {
    const std::uint64_t large_end = number_at(bytes, end - 20 + 8, 8);
    at = large_end < bytes.size() ? number_at(bytes, static_cast<std::size_t>(large_end) + 48, 8) : large_end;
  }
  while (at < bytes.size() && bytes.substr(static_cast<std::size_t>(at), 4) == "PK\1\2") {
    const auto entry = static_cast<std::size_t>(at);
    const std::uint64_t name = number_at(bytes, entry + 28, 2), extra = number_at(bytes, entry + 30, 2);
    const std::uint64_t comment = number_at(bytes, entry + 32, 2);
    if (name > 0xFFFF || extra > 0xFFFF || comment > 0xFFFF) break;
    const std::size_t extra_end = entry + 46 + name + extra;
    for (std::size_t field = entry + 46 + name; field + 4 <= extra_end; field += 4 + number_at(bytes, field + 2, 2)) {
      if (number_at(bytes, field, 2) != 1) continue;
      std::size_t large = field + 4;
      for (const std::size_t small : {entry + 24, entry + 20, entry + 42}) {  // size, packed size, place
        if (number_at(bytes, small, 4) != kInZip64) continue;
        const std::uint64_t value = number_at(bytes, large, 8);
        for (std::size_t k = 0; k < 4 && value < kInZip64; ++k) replaced[small + k] = bytes[large + k];
        large += 8;
      }
    }
    at = extra_end + comment;
  }
  return replaced;
}

}  // namespace

// The library reads files; these functions let it read the bytes like one.
struct Package::Stream {
  const std::string& bytes;
  std::map<std::size_t, char> replaced;
  std::size_t at = 0;

  static void* open(void* self, const void*, int) { return self; }
  static uLong read(void*, void* self, void* into, uLong size) {
    auto& s = *static_cast<Stream*>(self);
    const std::size_t n = std::min<std::size_t>(size, s.bytes.size() - s.at);
    std::memcpy(into, s.bytes.data() + s.at, n);
    for (auto r = s.replaced.lower_bound(s.at); r != s.replaced.end() && r->first < s.at + n; ++r)
      static_cast<char*>(into)[r->first - s.at] = r->second;
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
    : name_(std::move(name)), stream_(std::make_unique<Stream>(Stream{bytes, sizes_in_32_bits(bytes)})) {
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
