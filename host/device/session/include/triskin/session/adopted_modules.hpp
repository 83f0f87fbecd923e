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

namespace triskin::session {

/// design::module_ends returns the far ends of all ports of a design in this form.
using ModuleEnds = std::vector<std::array<design::ModuleEnd, layout::kPorts>>;

/// Finds the modules of the design that a controller has adopted, from the ports that they are connected to. `rows`:
/// modules of its table, by row. −1 means that the design has no module there, or one with another rotation. Cost:
/// linear.
[[nodiscard]] std::vector<layout::ModuleId> adopted_modules(const ModuleEnds& ends,
                                                            std::span<const layout::ModuleId> rows,
                                                            const wire::Adoption& adoption);

/// Handles modules of other patches that one controller reads, for a reader of its stream. Samples that refer to an
/// unknown list wait until it is known. Threads: one.
class AdoptedReader {
 public:
  struct Waiting {
    wire::TaxelFrame sample;
    std::uint64_t heard_us = 0;
  };
  /// The account covers the time while the module was adopted.
  struct Read {
    layout::ModuleId module = layout::ModuleId::none();
    SampleAccount counts;
    std::uint64_t heard_us = 0;  ///< The link's clock at the module's latest sample is stored.
  };

  /// Returns true if samples wait for a list; then read FD0E and call set().
  [[nodiscard]] bool wants_list() const { return !waiting_.empty(); }
  /// Uses the list `adoption` from now on, whose adopted modules are `modules`. Returns the samples that waited for
  /// this list. Waiting samples of other lists can no longer be resolved and count as dropped().
  std::deque<Waiting> set(const wire::Adoption& adoption, std::span<const layout::ModuleId> modules, int every,
                          std::uint64_t interval_us);
  /// Counts a sample of an adopted module; `row` is the module's position among the adopted ones. Returns the module
  /// that it belongs to if the sample counts, else −1; the sample may be waiting for its list.
  layout::ModuleId add(std::size_t row, const wire::TaxelFrame& sample, std::uint64_t now_us);
  /// Returns true if a sample of the module arrived after `since_us`.
  [[nodiscard]] bool reads(layout::ModuleId module, std::uint64_t since_us) const;
  /// Returns the accounts so far, earlier lists first.
  [[nodiscard]] const std::vector<Read>& all() const { return read_; }
  /// Counts the samples whose module could not be determined.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  std::uint8_t list_ = 0;
  std::size_t first_ = 0;  // The present list starts at this index of read_.
  std::vector<Read> read_;
  std::deque<Waiting> waiting_;
  std::uint64_t dropped_ = 0;
};

}  // namespace triskin::session
