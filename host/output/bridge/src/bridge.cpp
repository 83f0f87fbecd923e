// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/bridge.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/base/error.hpp"
#include "triskin/recording/cdr.hpp"

namespace triskin::bridge {
namespace {

constexpr double kSecond_ns = 1e9;
// 126 controllers at 54 Hz send this many messages in a quarter of a second.
constexpr Delivery kStream{.depth = 2000, .latched = false}, kLatest{.depth = 10, .latched = false},
    kForEver{.depth = 1, .latched = true};

}  // namespace

Bridge::Bridge(Domain& domain, const design::Design& design, const BridgeOptions& options, std::uint64_t now_ns)
    : domain_(domain),
      design_(design),
      base_("skin/" + options.part + "/"),
      frame_(options.frame_prefix + "skin_" + options.part),
      parent_(options.frame_prefix + options.parent_frame),
      pose_(options.pose),
      points_period_ns_(options.points_hz > 0.0 ? static_cast<std::uint64_t>(kSecond_ns / options.points_hz) : 0),
      calibration_(options.calibration),
      numbers_(design.layout.numbers),
      frames_([this](std::span<const recording::ModuleSample> samples) { put_raw(samples); }),
      cloud_(design) {
  if (!is_part_name(options.part))
    throw InputError(fmt::format("\"{}\" is not a name of a ROS topic; take letters, digits and _, for example {}",
                                 options.part, part_name(options.part)));
  if (parent_ == frame_)
    throw InputError(
        fmt::format("the frame {} of the skin cannot be its own parent; name the link that carries it", frame_));
  if (options.raw) raw_ = domain.advertise(base_ + "raw", kRaw, kStream);
  if (points_period_ns_ > 0) points_ = domain.advertise(base_ + "points", kPoints, kLatest);
  contacts_ = domain.advertise(base_ + "contacts", kContacts, kLatest);
  if (options.calibration.by_taxel || options.calibration.newton_per_count > 0.0)
    wrench_ = domain.advertise(base_ + "wrench", kWrench, kLatest);
  if (options.markers) markers_ = domain.advertise(base_ + "markers", kMarkers, kLatest);
  if (options.stop) stop_ = domain.advertise(base_ + "stop", kStop, kLatest);
  layout_ = domain.advertise(base_ + "layout", kLayout, kForEver);
  diagnostics_ = domain.advertise("/diagnostics", kDiagnostics, kLatest);
  transforms_ = domain.advertise("/tf_static", kTransforms, kForEver);
  layout_->write(recording::encode_layout(design, now_ns, frame_));
  transforms_->write(encode_transform(parent_, frame_, pose_, now_ns));
}

void Bridge::put_raw(std::span<const recording::ModuleSample> samples) {
  if (!raw_) return;
  if (clock_offset_ns_ == 0) {
    raw_->write(recording::encode_raw(samples, numbers_));
  } else {
    std::vector<recording::ModuleSample> moved(samples.begin(), samples.end());
    for (recording::ModuleSample& s : moved) s.sampled_ns = on_clock(s.sampled_ns);
    raw_->write(recording::encode_raw(moved, numbers_));
  }
  ++published_.raw;
  published_.samples += samples.size();
}

void Bridge::add(const recording::ModuleSample& sample) {
  frames_.add(sample);
  if (!points_) return;
  cloud_.add(sample);
  if (sample.sampled_ns < next_points_ns_) return;
  points_->write(cloud_.encode(on_clock(sample.sampled_ns), frame_));
  ++published_.points;
  // Times lie on a grid, so that the rate is exact; after a gap a new grid starts.
  next_points_ns_ = std::max(next_points_ns_ + points_period_ns_, sample.sampled_ns);
  if (published_.points == 1) next_points_ns_ = sample.sampled_ns + points_period_ns_;
}

void Bridge::add_contacts(std::span<const recording::Contact> contacts, std::uint64_t stamp_ns) {
  const std::uint64_t stamp = on_clock(stamp_ns);
  if (wrench_) {
    const double by_sum = calibration_.by_taxel ? 0.0 : calibration_.newton_per_count;
    wrench_->write(encode_wrench(wrench_of(contacts, by_sum, pose_), stamp, parent_));
    ++published_.wrenches;
  }
  const bool is_news = !contacts.empty() || had_contacts_;
  if (markers_ && (is_news || stamp_ns >= next_markers_ns_)) {
    constexpr std::uint64_t kRepeat_ns = 1'000'000'000;
    markers_->write(encode_markers(design_, contacts, arrows_, stamp, frame_));
    arrows_ = contacts.size();
    next_markers_ns_ = stamp_ns + kRepeat_ns;
  }
  if (!is_news) return;
  contacts_->write(recording::encode_contacts(contacts, stamp, frame_, calibration_, numbers_));
  ++published_.contacts;
  had_contacts_ = !contacts.empty();
}

void Bridge::add_stop(bool stop) {
  if (!stop_) return;
  recording::CdrWriter w;
  w.u8(stop ? 1 : 0);
  stop_->write(w.message());
  ++published_.stops;
}

void Bridge::add_diagnostics(std::span<const Diagnosis> parts, std::uint64_t stamp_ns) {
  diagnostics_->write(encode_diagnostics(parts, on_clock(stamp_ns)));
  ++published_.diagnostics;
}

int Bridge::other_publishers() const {
  return domain_.other_writers(base_ + "layout");
}

int Bridge::readers() const {
  int readers = 0;
  for (const auto* topic :
       {&raw_, &points_, &contacts_, &wrench_, &markers_, &stop_, &layout_, &diagnostics_, &transforms_})
    readers += *topic ? (*topic)->readers() : 0;
  return readers;
}

void Bridge::flush() {
  frames_.flush();
}

}  // namespace triskin::bridge
