// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/adopted_modules.hpp"

#include <algorithm>
#include <map>

namespace triskin::session {

std::vector<layout::ModuleId> adopted_modules(const ModuleEnds& ends, std::span<const layout::ModuleId> rows,
                                              const wire::Adoption& adoption) {
  std::vector<layout::ModuleId> modules(rows.begin(), rows.end());
  for (const wire::AdoptedModule& g : adoption.list_of_adopted()) {
    const auto parent = g.parent < modules.size() ? modules[g.parent] : layout::ModuleId::none();
    const auto end = parent < 0 ? design::ModuleEnd{} : ends.at(static_cast<std::size_t>(parent)).at(g.parent_port);
    modules.push_back(end.port == g.port ? end.module : layout::ModuleId::none());
  }
  modules.erase(modules.begin(), modules.begin() + static_cast<std::ptrdiff_t>(rows.size()));
  return modules;
}

std::deque<AdoptedReader::Waiting> AdoptedReader::set(const wire::Adoption& adoption,
                                                      std::span<const layout::ModuleId> modules, int every,
                                                      std::uint64_t interval_us) {
  std::deque<Waiting> mine;
  for (const Waiting& w : waiting_) {
    if (w.sample.adopted_modules == adoption.list)
      mine.push_back(w);
    else
      ++dropped_;
  }
  waiting_.clear();
  if (adoption.list == list_) return mine;
  list_ = adoption.list;
  // A module that stays adopted continues: until its first sample under this list, its time is that of the previous
  // one.
  std::map<layout::ModuleId, std::uint64_t> heard_us;
  for (std::size_t k = first_; k < read_.size(); ++k) heard_us[read_[k].module] = read_[k].heard_us;
  first_ = read_.size();
  for (const layout::ModuleId m : modules) read_.push_back({m, SampleAccount(every, interval_us), heard_us[m]});
  return mine;
}

// What happened to an adopted module's samples before the first one arrived here is unknown, so its account begins with
// that one.
layout::ModuleId AdoptedReader::add(std::size_t row, const wire::TaxelFrame& sample, std::uint64_t now_us) {
  constexpr std::size_t kMaxWaiting = 512;
  if (sample.adopted_modules == 0) return layout::ModuleId::none();
  if (sample.adopted_modules != list_ || list_ == 0) {
    if (waiting_.size() == kMaxWaiting) {
      waiting_.pop_front();
      ++dropped_;
    }
    waiting_.push_back({sample, now_us});
    return layout::ModuleId::none();
  }
  if (first_ + row >= read_.size()) return layout::ModuleId::none();
  Read& r = read_[first_ + row];
  if (!r.counts.started()) r.counts.begin(sample.starts, {sample.sample - 1, sample.unread, sample.dropped}, now_us);
  if (!r.counts.add(sample, now_us)) return layout::ModuleId::none();
  r.heard_us = now_us;
  return r.module;
}

bool AdoptedReader::reads(layout::ModuleId module, std::uint64_t since_us) const {
  return std::any_of(read_.begin() + static_cast<std::ptrdiff_t>(first_), read_.end(),
                     [&](const Read& r) { return r.module == module && r.heard_us >= since_us && r.heard_us > 0; });
}

}  // namespace triskin::session
