// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/wire/image_update.hpp"

namespace triskin::deploy {

/// A session is the host's side of one broadcast update on one bus, step by step. Not thread-safe.
class UpdateSession {
 public:
  using OnProgress = std::function<void(std::size_t board, const char* stage, double fraction)>;
  /// `bus` and `package` must outlive the session. `session` must not be 0.
  UpdateSession(session::Bus& bus, std::span<const wire::NodeClaim> boards, const FirmwarePackage& package,
                const UpdateOptions& options, std::uint16_t session, OnProgress progress);

  /// Asks each board what it runs, and lets the boards that need the update join. Nothing is written. Throws as Bus
  /// does.
  void begin();
  /// Performs everything up to the check of the image on each participating board; nothing is activated. Throws as Bus
  /// does.
  void transfer();
  /// Returns true when a board has refused the image that others are ready for.
  [[nodiscard]] bool any_refused() const;
  /// Makes all boards that are ready commit and start the image.
  void activate();
  /// Ends the session without using the new images; `why` is the reason.
  void hold_back(const std::string& why);
  /// Ends the session on the bus without a report, for leaving by an exception.
  void abandon() noexcept;

  [[nodiscard]] std::vector<BoardUpdate> take_boards();
  [[nodiscard]] int rounds() const { return rounds_; }
  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t again() const { return again_; }

 private:
  struct Board {
    BoardUpdate result;
    std::uint32_t id_crc = 0;
    bool under_way = false;  ///< The board takes part in the session.
    bool claims = false;     ///< The board has answered who it is.
    // The following answers arrived since forget().
    std::optional<wire::update::Who> who;
    std::optional<wire::update::Image> image;
    std::optional<wire::update::State> state;
    std::set<std::uint16_t> missing;  ///< Since it was last asked, the board reported these units as missing.
    int silent_rounds = 0;            ///< In this many consecutive rounds the board did not report its missing units.
  };
  /// Lists the units of one slot's image that have to be sent, in order.
  using Units = std::vector<std::uint16_t>;

  void send(const wire::update::Order& order);
  /// The command is sent several times, because nothing is answered that would show a loss; boards that already have it
  /// ignore repeats.
  void send_to_all(wire::update::Command command) {
    for (int k = 0; k < 3; ++k) send({command, session_, {}});
  }
  void take(const wire::CanFrame& frame);
  void listen(std::uint64_t until_us);
  void listen_while(std::uint64_t until_us, const std::function<bool()>& goes_on);
  using Done = std::function<bool(const Board&)>;
  /// Sends `command` to each board that `wanted` selects until `done`; returns false if one did not answer in time.
  void ask(wire::update::Command command, const Done& wanted, const Done& done, int tries);
  void ask_all();
  /// Returns true when the board has last answered that it takes part in another session.
  [[nodiscard]] static bool of_another(const Board& board);
  void wait_for_another();
  void look_for_silent();
  void decide(Board& board);
  void join();
  [[nodiscard]] bool joined(const Board& board) const;
  /// Returns true if asking a board once more may let it join.
  [[nodiscard]] bool may_join_later(const Board& board) const;
  void refused_at_join(Board& board);
  void erase();
  void poll_until(const Done& done, std::uint64_t patience_us, wire::update::Command repeat, wire::update::Phase from,
                  const char* doing);
  void send_image();
  void send_units(std::array<Units, 2> units, const char* stage);
  void send_missing();
  /// Asks each board in `open` (indices) which units it misses.
  void ask_missing(const std::vector<std::size_t>& open);
  /// Units are listed by slot.
  using MissingUnits = std::array<std::set<std::uint16_t>, 2>;
  /// Adds what a board misses to `missing`; returns false if it is complete or was given up.
  bool still_needs(Board& board, MissingUnits& missing);
  /// Reports `fraction` for each board that takes part.
  void report_to_all(const char* stage, double fraction) const;
  [[nodiscard]] bool complete(const Board& board) const;
  void check();
  void give_up(Board& board, UpdateOutcome outcome, const std::string& why);
  /// Gives a board up if it does not answer, or answers that it no longer takes part.
  void expect_answer(Board& board, const char* doing);
  /// Notes the outcome of a board that was told to start the image.
  void conclude(Board& board);
  [[nodiscard]] bool started(const Board& board) const;
  [[nodiscard]] bool equal(const Board& board) const;
  [[nodiscard]] int free_slot(const Board& board) const { return 1 - board.who->running_slot; }
  [[nodiscard]] bool erased(int slot, std::size_t unit) const;
  [[nodiscard]] std::array<bool, 2> slots_wanted() const;
  [[nodiscard]] wire::update::Offer offer_of(int slot) const;
  [[nodiscard]] bool any_under_way() const;

  session::Bus& bus_;
  const FirmwarePackage& package_;
  UpdateOptions options_;
  std::uint16_t session_;
  OnProgress progress_;
  std::vector<Board> boards_;
  std::map<std::uint32_t, std::size_t> by_answer_;  ///< The map finds the board for the identifier of an answer.
  bool fd_;
  std::size_t frame_bytes_;
  std::uint64_t silence_us_;  ///< No more answers are expected after this time.
  int rounds_ = 0;
  std::size_t frames_ = 0, again_ = 0;
};

}  // namespace triskin::deploy
