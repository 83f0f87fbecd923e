// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/latest_samples.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "little_endian.hpp"

namespace triskin::view {
namespace {

// A frame contains the change from the rest value, so pressure gives negative numbers.
std::int16_t change_of(double below_rest_counts) {
  using Limits = std::numeric_limits<std::int16_t>;
  return static_cast<std::int16_t>(std::clamp<double>(std::round(-below_rest_counts), Limits::min(), Limits::max()));
}

}  // namespace

void LatestSamples::add(layout::SkinModule module, const PressureSample& sample, std::int64_t wall_time_us) {
  const std::lock_guard lock(mutex_);
  if (module < 0 || static_cast<std::size_t>(module) >= modules_.size()) return;
  Module& m = modules_[static_cast<std::size_t>(module)];
  m.number = ++newest_;
  m.wall_time_us = wall_time_us;
  m.valid = sample.valid;
  m.state = sample.state;
  for (std::size_t t = 0; t < m.change.size(); ++t) m.change[t] = change_of(sample.below_rest_counts[t]);
}

void LatestSamples::set_health(Health health) {
  const std::lock_guard lock(mutex_);
  health_ = std::move(health);
}

LatestSamples::Health LatestSamples::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

void LatestSamples::set_contacts(int group, std::vector<Contact> contacts) {
  const std::lock_guard lock(mutex_);
  std::vector<Contact>& before = contacts_[group];
  if (!before.empty() || !contacts.empty()) ++contacts_number_;
  before = std::move(contacts);
}

std::optional<std::vector<LatestSamples::Contact>> LatestSamples::contacts_since(std::uint64_t& seen) const {
  std::vector<Contact> all;
  {
    const std::lock_guard lock(mutex_);
    if (contacts_number_ == seen) return std::nullopt;
    seen = contacts_number_;
    for (const auto& [group, contacts] : contacts_) all.insert(all.end(), contacts.begin(), contacts.end());
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &Contact::change_counts);
  return all;
}

std::string LatestSamples::frame_since(std::uint64_t& seen) const {
  const std::lock_guard lock(mutex_);
  std::int64_t newest_us = std::numeric_limits<std::int64_t>::min();
  std::size_t count = 0;
  for (const Module& m : modules_) {
    if (m.number <= seen) continue;
    newest_us = std::max(newest_us, m.wall_time_us);
    ++count;
  }
  if (count == 0) return {};
  std::string out;
  out.reserve(kHeaderBytes + kRecordBytes * count);
  put_le(out, kFrameKind, 1);
  put_le(out, kFrameVersion, 1);
  put_le(out, count, 2);
  put_le(out, newest_ & 0xFFFF'FFFFU, 4);
  put_le(out, std::bit_cast<std::uint64_t>(static_cast<double>(newest_us) * 1e-3), 8);
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    const Module& m = modules_[k];
    if (m.number <= seen) continue;
    const std::int64_t age_ms = (newest_us - m.wall_time_us) / 1000;
    put_le(out, k, 2);
    put_le(out, m.valid, 2);
    put_le(out, wire::wire_number(m.state), 1);
    put_le(out, 0, 1);
    put_le(out, static_cast<std::uint64_t>(std::clamp<std::int64_t>(age_ms, 0, 0xFFFF)), 2);
    for (const std::int16_t c : m.change) put_le(out, static_cast<std::uint16_t>(c), 2);
  }
  seen = newest_;
  return out;
}

}  // namespace triskin::view
