// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "board_match.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::deploy {

/// Each cover in a pass of flash_together first finds its boards, then provides the conversations that write their
/// tables.
class CoverFlash {
 public:
  /// `images` is indexed by patch; `patches` has the results, also those of earlier passes. All arguments must outlive
  /// the pass.
  CoverFlash(const FlashPart& part, const std::vector<std::vector<std::uint8_t>>& images,
             std::vector<FlashResult::Patch>& patches)
      : bus_(*part.bus),
        design_(*part.design),
        options_(part.options),
        progress_(part.progress),
        images_(images),
        patches_(patches) {}

  /// Decides which board serves which patch. `settled` are the boards of covers that were planned before, by serial
  /// number. `known` has what was found out about the bus so far, and this call adds to it. Throws as match_boards and
  /// assign_addresses do.
  void plan(std::span<const FlashOptions::Neighbour> settled, BusBoards& known);
  /// Gives the boards of all covers of a pass the addresses of their patches; an unneeded board that has such an
  /// address moves to a free one. In a dry run nothing is done. Throws DeviceError as assign_addresses.
  static void give_addresses(const std::deque<CoverFlash>& covers, BusBoards& known);
  /// Returns the boards of this cover, for covers that are planned later.
  [[nodiscard]] std::vector<FlashOptions::Neighbour> settled() const;
  /// Counts the controllers that answered.
  [[nodiscard]] std::size_t found() const { return found_; }
  /// Appends a conversation for each board.
  void add_tasks(std::vector<session::Task>& tasks);

  struct Failure {
    std::string who;  ///< The text names the patch and the controller.
    std::exception_ptr what;
    [[nodiscard]] std::string text() const;  ///< Returns the message of the exception.
  };
  /// Returns the patches without their table, in order, from `outcomes` of the tasks and from patches without a board.
  [[nodiscard]] std::vector<Failure> failures(std::span<const std::exception_ptr> outcomes);
  /// Returns how many conversations add_tasks appended.
  [[nodiscard]] std::size_t tasks() const { return boards_.size(); }
  /// Names the patches that have their table.
  [[nodiscard]] std::string what_is_done() const;

 private:
  // Notes the serial numbers of neighbours whose boards were found by a cover planned before.
  void name_neighbours(std::span<const FlashOptions::Neighbour> settled);
  void find(std::vector<wire::NodeClaim>& claims);
  // Starts the results of the patches again from the boards found, and keeps what an earlier pass wrote.
  void list_patches();
  [[nodiscard]] std::uint8_t address_of(const Board& board) const;
  void begin(FlashResult::Patch& r, const Board& board) const;
  void step(layout::PatchIndex patch, const char* what, double fraction) const;
  void serve(session::Bus& bus, const Board& board, FlashResult::Patch& r) const;
  void converse(session::Bus& bus, const Board& board, FlashResult::Patch& r, bool& began_to_write) const;

  session::Bus& bus_;
  const design::Design& design_;
  FlashOptions options_;
  const ProgressSink& progress_;
  const std::vector<std::vector<std::uint8_t>>& images_;
  std::vector<FlashResult::Patch>& patches_;  // Patches with a board are listed first, then those without.
  std::vector<Board> boards_;
  std::vector<MissingBoard> missing_;
  std::size_t found_ = 0;
};

}  // namespace triskin::deploy
