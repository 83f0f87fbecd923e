// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "triskin/ports/ports.hpp"
#include "triskin/sim/flash_model.hpp"

namespace triskin::test {

/// Simulates flash with the rules of the silicon, as a port (fw::FlashArea) or as a model (sim::FlashModel). Power can
/// fail in any operation, which is an erase or one program unit; `tear` sets how much of it is done then.
template <class Interface>
class FlashDouble final : public Interface {
 public:
  static constexpr std::size_t kPage = 2048, kUnit = 8;
  enum class Tear { kNothing, kHalf, kAll };

  explicit FlashDouble(std::size_t pages = 8) : bytes_(pages * kPage, 0xFF), written_(pages * kPage / kUnit, false) {}

  /// After `operations` more operations, the next one throws sim::PowerLost, once.
  void cut_after(int operations, Tear tear) {
    cut_ = operations;
    tear_ = tear;
  }
  void never_cut() { cut_ = -1; }
  void refuse(bool on) { refuse_ = on; }
  [[nodiscard]] int operations() const { return operations_; }
  [[nodiscard]] int erases() const { return erases_; }
  [[nodiscard]] std::vector<std::uint8_t>& raw() { return bytes_; }

  [[nodiscard]] std::size_t size_bytes() const override { return bytes_.size(); }
  [[nodiscard]] std::size_t page_bytes() const override { return kPage; }
  [[nodiscard]] std::size_t program_bytes() const override { return kUnit; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const override { return bytes_; }

  bool erase_page(std::size_t offset) override {
    if (offset % kPage != 0 || offset >= bytes_.size() || refuse_) return false;
    const bool cut = power_fails();
    ++erases_;
    const std::size_t n = !cut || tear_ == Tear::kAll ? kPage : tear_ == Tear::kHalf ? kPage / 2 : 0;
    std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), n, std::uint8_t{0xFF});
    std::fill_n(written_.begin() + static_cast<std::ptrdiff_t>(offset / kUnit), n / kUnit, false);
    if (cut) throw sim::PowerLost("erase");
    return true;
  }

  bool program(std::size_t offset, std::span<const std::uint8_t> in) override {
    if (offset % kUnit != 0 || in.size() % kUnit != 0 || offset + in.size() > bytes_.size() || refuse_) return false;
    for (std::size_t k = 0; k < in.size(); k += kUnit) {
      if (written_[(offset + k) / kUnit]) return false;
      const bool cut = power_fails();
      const std::size_t n = !cut || tear_ == Tear::kAll ? kUnit : tear_ == Tear::kHalf ? kUnit / 2 : 0;
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(k), n,
                  bytes_.begin() + static_cast<std::ptrdiff_t>(offset + k));
      if (n > 0) written_[(offset + k) / kUnit] = true;
      if (cut) throw sim::PowerLost("program");
    }
    return true;
  }

 private:
  bool power_fails() {
    ++operations_;
    return cut_ >= 0 && cut_-- == 0;
  }
  std::vector<std::uint8_t> bytes_;
  std::vector<bool> written_;
  int operations_ = 0, erases_ = 0, cut_ = -1;
  Tear tear_ = Tear::kNothing;
  bool refuse_ = false;
};

}  // namespace triskin::test
