// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/flash_memory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "triskin/base/error.hpp"
#include "triskin/base/writer_lock.hpp"

namespace triskin::hardware {
namespace {

// A new file is empty and gets the size.
void require_size(int descriptor, off_t size_bytes, const std::string& file) {
  struct stat status{};
  if (::fstat(descriptor, &status) != 0 || (status.st_size != 0 && status.st_size != size_bytes))
    throw InputError(fmt::format("{}: is not the flash of a simulated controller of this release; delete it", file));
  if (::ftruncate(descriptor, size_bytes) != 0)
    throw InputError(fmt::format("{}: cannot set the size: {}", file, std::strerror(errno)));
}

std::vector<std::uint8_t> read_inverted(int descriptor, std::size_t size_bytes, const std::string& file) {
  std::vector<std::uint8_t> bytes(size_bytes);
  std::size_t done = 0;
  while (done < size_bytes) {
    const ssize_t n = ::pread(descriptor, bytes.data() + done, size_bytes - done, static_cast<off_t>(done));
    if (n <= 0)
      throw InputError(
          fmt::format("{}: cannot read the simulated flash; delete the file to start with a fresh board", file));
    done += static_cast<std::size_t>(n);
  }
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(~b);
  return bytes;
}

}  // namespace

FlashMemory::FlashMemory(std::size_t size_bytes)
    : bytes_(size_bytes, 0xFF), programmed_(size_bytes / kProgramBytes, false) {}

FlashMemory::FlashMemory(std::size_t size_bytes, const std::filesystem::path& file) : FlashMemory(size_bytes) {
  file_ = file.string();
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0)
    throw InputError(fmt::format("{}: cannot open the simulated flash: {}", file_, std::strerror(errno)));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    throw DeviceError(
        fmt::format("{}: this controller is simulated by {} already; end that first", file_, lock_holder(descriptor_)));
  }
  require_size(descriptor_, static_cast<off_t>(size_bytes), file_);
  bytes_ = read_inverted(descriptor_, size_bytes, file_);
  for (std::size_t unit = 0; unit < programmed_.size(); ++unit) {
    const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(unit * kProgramBytes);
    programmed_[unit] = std::any_of(first, first + kProgramBytes, [](std::uint8_t b) { return b != 0xFF; });
  }
}

FlashMemory::~FlashMemory() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void FlashMemory::cut_power_after(std::uint64_t operations, Tear tear) {
  cut_at_ = operations_ + operations;
  tear_ = tear;
}

bool FlashMemory::count_operation() {
  if (operations_++ != cut_at_) return false;
  cut_at_ = kNever;
  return true;
}

void FlashMemory::store(std::size_t offset_bytes, std::size_t size_bytes) {
  if (descriptor_ < 0) return;
  std::vector<std::uint8_t> inverted(size_bytes);
  std::transform(bytes_.begin() + static_cast<std::ptrdiff_t>(offset_bytes),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(offset_bytes + size_bytes), inverted.begin(),
                 [](std::uint8_t b) { return static_cast<std::uint8_t>(~b); });
  const ssize_t n = ::pwrite(descriptor_, inverted.data(), size_bytes, static_cast<off_t>(offset_bytes));
  if (n != static_cast<ssize_t>(size_bytes)) throw DeviceError(fmt::format("{}: cannot write; check the disk", file_));
}

bool FlashMemory::erase_page(std::size_t offset_bytes) {
  if (offset_bytes % kPageBytes != 0 || offset_bytes >= bytes_.size()) return false;
  const bool cut = count_operation();
  if (cut && tear_ == Tear::kBefore) throw sim::PowerLost("power lost before a page erase");
  const std::size_t size = cut ? kPageBytes / 2 : kPageBytes;
  std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset_bytes), size, std::uint8_t{0xFF});
  std::fill_n(programmed_.begin() + static_cast<std::ptrdiff_t>(offset_bytes / kProgramBytes), size / kProgramBytes,
              false);
  store(offset_bytes, size);
  if (cut) throw sim::PowerLost("power lost in a page erase");
  return true;
}

bool FlashMemory::program(std::size_t offset_bytes, std::span<const std::uint8_t> bytes) {
  if (offset_bytes % kProgramBytes != 0 || bytes.size() % kProgramBytes != 0) return false;
  if (offset_bytes > bytes_.size() || bytes.size() > bytes_.size() - offset_bytes) return false;
  for (std::size_t at = 0; at < bytes.size(); at += kProgramBytes) {
    const std::size_t to = offset_bytes + at;
    if (programmed_[to / kProgramBytes]) return false;
    const bool cut = count_operation();
    if (cut && tear_ == Tear::kBefore) throw sim::PowerLost("power lost before a program operation");
    const std::size_t size = cut ? kProgramBytes / 2 : kProgramBytes;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), size,
                bytes_.begin() + static_cast<std::ptrdiff_t>(to));
    programmed_[to / kProgramBytes] = true;
    store(to, size);
    if (cut) throw sim::PowerLost("power lost in a program operation");
  }
  return true;
}

}  // namespace triskin::hardware
