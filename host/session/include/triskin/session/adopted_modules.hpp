// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/session/sample_account.hpp"
#include "triskin/wire/adoption.hpp"

namespace triskin::device {

/// Far ends of all ports of a design: design::module_ends.
using ModuleEnds = std::vector<std::array<design::ModuleEnd, layout::kPorts>>;

/// Modules of the design that a controller has adopted, found from the ports that they are connected to. `rows`:
/// modules of its table, by row. −1: the design has no module there, or one with another rotation. Cost: linear.
[[nodiscard]] std::vector<int> adopted_modules(const ModuleEnds& ends, std::span<const int> rows,
                                               const wire::Adoption& adoption);

/// Modules of other patches that one controller reads, as a reader of its stream sees them: samples of a list that is
/// not known yet wait until it is. Threads: one.
class AdoptedReader {
 public:
  struct Waiting {
    wire::TaxelFrame sample;
    std::uint64_t heard_us = 0;
  };
  /// Account of a module as long as it was an adopted module.
  struct Read {
    int module = -1;
    SampleAccount counts;
    std::uint64_t heard_us = 0;  ///< It is the link's clock at its latest sample.
  };

  /// True: samples wait for a list; ask FD0E, then set().
  [[nodiscard]] bool wants_list() const { return !waiting_.empty(); }
  /// Accounts from now on are those of `adoption`, whose adopted modules are `modules`. Result: the samples of it that
  /// waited. Those of other lists came too late to be asked for: dropped().
  std::deque<Waiting> set(const wire::Adoption& adoption, std::span<const int> modules, int every,
                          std::uint64_t interval_us);
  /// Counts a sample of an adopted module; `row`: of the adopted module among the adopted modules. Result: the module
  /// that it belongs to, when the sample counts. −1: none; it may wait for its list.
  int add(std::size_t row, const wire::TaxelFrame& sample, std::uint64_t now_us);
  /// True: a sample of the module came since `since_us`.
  [[nodiscard]] bool reads(int module, std::uint64_t since_us) const;
  /// What was read so far, earlier lists first.
  [[nodiscard]] const std::vector<Read>& all() const { return read_; }
  /// Samples that nobody can say the module of.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  std::uint8_t list_ = 0;
  std::size_t first_ = 0;  // Start of the present list in read_.
  std::vector<Read> read_;
  std::deque<Waiting> waiting_;
  std::uint64_t dropped_ = 0;
};

}  // namespace triskin::device
