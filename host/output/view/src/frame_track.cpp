// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/frame_track.hpp"

#include <algorithm>
#include <bit>
#include <chrono>

#include "little_endian.hpp"
#include "messages.hpp"

namespace triskin::view {
namespace {

// Returns contacts as an entry of the track: the header of a frame, with another kind and without records, and the text
// that the WebSocket carries.
std::string contacts_entry(const std::vector<LatestSamples::Contact>& contacts, std::int64_t time_us) {
  std::string entry;
  put_le(entry, LatestSamples::kContactsKind, 1);
  put_le(entry, LatestSamples::kFrameVersion, 1);
  put_le(entry, 0, 6);
  put_le(entry, std::bit_cast<std::uint64_t>(static_cast<double>(time_us) * 1e-3), 8);
  return entry + contacts_json(contacts);
}

}  // namespace

void FrameTrack::advance_to(std::int64_t time_us) {
  if (started_ && time_us < due_us_) return;
  if (started_) {
    flush();
  } else {
    start_us_ = contacts_due_us_ = time_us;
    started_ = true;
  }
  due_us_ = time_us + kStep_us;
}

void FrameTrack::add(layout::SkinModule module, const PressureSample& sample, std::int64_t time_us) {
  advance_to(time_us);
  newest_us_ = std::max(newest_us_, time_us);
  live_.add(module, sample, time_us - start_us_);
}

void FrameTrack::append(std::string_view entry) {
  if (is_cut_ || bytes_.size() + entry.size() + 4 > max_bytes_) {
    is_cut_ = true;
    return;
  }
  put_le(bytes_, entry.size(), 4);
  bytes_ += entry;
}

void FrameTrack::flush() {
  if (is_cut_) return;
  const std::string frame = live_.frame_since(seen_);
  if (frame.empty()) return;
  append(frame);
  if (contacts_ && newest_us_ >= contacts_due_us_) flush_contacts(newest_us_ - start_us_);
}

void FrameTrack::flush_contacts(std::int64_t frame_us) {
  using std::chrono::microseconds;
  contacts_due_us_ = newest_us_ + microseconds(LatestSamples::kContactsEvery).count();
  live_.set_contacts(0, contacts_());
  if (const auto changed = live_.contacts_since(seen_contacts_)) append(contacts_entry(*changed, frame_us));
}

std::string FrameTrack::finish() {
  contacts_due_us_ = newest_us_;
  flush();
  return std::move(bytes_);
}

}  // namespace triskin::view
