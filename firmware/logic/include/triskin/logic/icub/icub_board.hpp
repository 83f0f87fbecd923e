// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/icub_commands.hpp"
#include "triskin/wire/unique_id.hpp"

namespace triskin::fw {

/// To an iCub host, the controller looks like this: it answers and obeys the commands of an MTB4 skin board. As there,
/// settings are kept in RAM. state() reports refused commands. See docs/icub.md.
class IcubBoard {
 public:
  /// A command needs these facts about the controller.
  struct Self {
    std::uint8_t node_address;
    std::uint32_t version;  ///< The numbers are major, minor, patch and build, from the highest byte down.
    const wire::UniqueId& unique_id;
    std::uint64_t now_us;
  };
  /// A command can have these effects besides its answers.
  struct Reaction {
    std::optional<bool> transmit;              ///< The command starts or stops the stream.
    bool calibrate = false;                    ///< The next reading of each triangle becomes its rest value.
    bool restart = false;                      ///< The controller must restart as after power-up.
    std::optional<std::uint8_t> node_address;  ///< This address, 1 … 14, must be stored.
  };
  /// Handles a frame with an 11-bit identifier. Answers wait in reply().
  [[nodiscard]] Reaction handle(const wire::CanFrame& frame, const Self& self);

  /// Returns the oldest answer, or nullptr.
  [[nodiscard]] const wire::CanFrame* reply() const {
    return reply_at_ < reply_count_ ? &replies_[reply_at_] : nullptr;
  }
  /// Removes reply() after it was sent.
  void pop_reply() { ++reply_at_; }

  /// Returns true when triangle 0 … 15 takes part in the stream.
  [[nodiscard]] bool enabled(std::size_t triangle) const { return (enabled_ >> triangle & 1) != 0; }
  /// Returns by how many bits the change of a triangle is shifted, 0 … 15.
  [[nodiscard]] int shift(std::size_t triangle) const { return shift_[triangle]; }
  /// Returns the value at rest.
  [[nodiscard]] int no_load() const { return no_load_; }
  [[nodiscard]] wire::icub::SkinType skin_type() const { return skin_type_; }
  /// Returns true if a sample must be sent at `now_us`; on average, it keeps the period that the host asked for.
  [[nodiscard]] bool due(std::uint64_t now_us);
  /// Returns the value of FD30.
  [[nodiscard]] wire::icub::State state(std::uint8_t node_address) const;

 private:
  static constexpr std::uint8_t kNoLoad = 245, kShift = 2, kPeriod_ms = 50, kObsoletePeriod_ms = 40;
  void poll(const wire::CanFrame& frame, const Self& self, Reaction& reaction);
  void load(const wire::CanFrame& frame, const Self& self, Reaction& reaction);
  void set_defaults();
  void set_board(const wire::CanFrame& frame);
  void set_triangles(const wire::CanFrame& frame, Reaction& reaction);
  void set_address(const wire::CanFrame& frame, const Self& self, std::uint16_t excluded, Reaction& reaction);
  void refuse(const wire::CanFrame& frame, std::uint8_t flag);
  void answer(const wire::CanFrame& asked, const Self& self, std::initializer_list<std::uint8_t> bytes);
  void answer_version(const wire::CanFrame& asked, const Self& self);
  void answer_description(const wire::CanFrame& asked, const Self& self);
  void answer_time(const wire::CanFrame& asked, const Self& self);

  wire::icub::SkinType skin_type_ = wire::icub::SkinType::kCompensated;
  std::uint8_t no_load_ = kNoLoad, period_ms_ = kPeriod_ms;
  std::array<std::uint8_t, wire::icub::kTriangles> shift_ = [] {
    std::array<std::uint8_t, wire::icub::kTriangles> all{};
    all.fill(kShift);
    return all;
  }();
  std::uint16_t enabled_ = 0xFFFF;
  std::uint64_t next_us_ = 0;
  std::uint8_t flags_ = 0, last_refused_ = 0, refused_ = 0;
  std::array<wire::CanFrame, 16> replies_{};  // A request without room gets no answer, and the host asks again.
  std::size_t reply_at_ = 0, reply_count_ = 0;
};

}  // namespace triskin::fw
