// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/wire/image_update.hpp"

namespace triskin::device {

/// The host's side of one broadcast update on one bus, in steps. Not thread-safe.
class UpdateSession {
 public:
  using OnProgress = std::function<void(std::size_t board, const char* stage, double fraction)>;
  /// `bus` and `package` outlive it. `session`: not 0.
  UpdateSession(Bus& bus, std::span<const wire::NodeClaim> boards, const FirmwarePackage& package,
                const BroadcastOptions& options, std::uint16_t session, OnProgress progress);

  /// Asks each board what it runs, and lets those take part that are to be updated. Nothing is written. Throws as Bus
  /// does.
  void begin();
  /// Everything up to the check of the image on each board that takes part; nothing is activated. Throws as Bus does.
  void transfer();
  /// True when a board has refused what others are ready for.
  [[nodiscard]] bool any_refused() const;
  /// All that are ready commit and start the image.
  void activate();
  /// Ends the session; what is ready stays out of use, because of `why`.
  void hold_back(const std::string& why);
  /// Ends the session on the bus and tells nobody: for a way out by exception.
  void abandon() noexcept;

  [[nodiscard]] std::vector<BoardUpdate> take_boards();
  [[nodiscard]] int rounds() const { return rounds_; }
  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t again() const { return again_; }

 private:
  struct Board {
    BoardUpdate result;
    std::uint32_t id_crc = 0;
    bool under_way = false;  ///< It takes part in the session.
    bool claims = false;     ///< It has said who it is.
    // Answers since forget():
    std::optional<wire::update::Who> who;
    std::optional<wire::update::Image> image;
    std::optional<wire::update::State> state;
    std::set<std::uint16_t> missing;  ///< It reported these units missing since it was last asked.
    int silent_rounds = 0;            ///< It did not say in so many rounds in a row what it misses.
  };
  /// Units of one slot's image that are to be sent, in order.
  using Units = std::vector<std::uint16_t>;

  void send(const wire::update::Order& order);
  /// Several times: without answers nobody says that it has missed it, and who has it already ignores it.
  void send_to_all(wire::update::Command command) {
    for (int k = 0; k < 3; ++k) send({command, session_, {}});
  }
  void take(const wire::CanFrame& frame);
  void listen(std::uint64_t until_us);
  void listen_while(std::uint64_t until_us, const std::function<bool()>& goes_on);
  using Done = std::function<bool(const Board&)>;
  /// Sends `command` to each board that `wanted` names until `done`; false of those that have not answered in time.
  void ask(wire::update::Command command, const Done& wanted, const Done& done, int tries);
  void ask_all();
  void look_for_silent();
  void decide(Board& board);
  void join();
  void refused_at_join(Board& board);
  void erase();
  void poll_until(const Done& done, std::uint64_t patience_us, wire::update::Command repeat, wire::update::Phase from,
                  const char* doing);
  void send_image();
  void send_units(std::array<Units, 2> units, const char* stage);
  void send_missing();
  [[nodiscard]] bool complete(const Board& board) const;
  void check();
  void give_up(Board& board, UpdateOutcome outcome, const std::string& why);
  /// Gives up who does not answer, or answers that it takes no part any more.
  void expect_answer(Board& board, const char* doing);
  [[nodiscard]] bool started(const Board& board) const;
  [[nodiscard]] bool equal(const Board& board) const;
  [[nodiscard]] int free_slot(const Board& board) const { return 1 - board.who->running_slot; }
  [[nodiscard]] bool erased(int slot, std::size_t unit) const;
  [[nodiscard]] std::array<bool, 2> slots_wanted() const;
  [[nodiscard]] wire::update::Offer offer_of(int slot) const;
  [[nodiscard]] bool any_under_way() const;

  Bus& bus_;
  const FirmwarePackage& package_;
  BroadcastOptions options_;
  std::uint16_t session_;
  OnProgress progress_;
  std::vector<Board> boards_;
  std::map<std::uint32_t, std::size_t> by_answer_;  ///< They lead from the identifier of an answer to its board.
  bool fd_;
  std::size_t frame_bytes_;
  std::uint64_t silence_us_;  ///< No more answers are expected after this time.
  int rounds_ = 0;
  std::size_t frames_ = 0, again_ = 0;
};

}  // namespace triskin::device
