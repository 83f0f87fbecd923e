// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/identify.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "touch_finder.hpp"
#include "triskin/session/address_users.hpp"

namespace triskin::deploy {
namespace {

class Identification {
 public:
  Identification(session::Bus& bus, const design::Design& design, const IdentifyOptions& options,
                 const std::function<void(const IdentifiedBoard&)>& found)
      : bus_(bus), design_(design), options_(options), found_(found) {}

  std::vector<IdentifiedBoard> run() {
    find_boards();
    compare_shapes();
    std::vector<layout::PatchIndex> open = design::patches_here(design_);
    if (options_.patch >= 0) {
      open = {options_.patch};
    } else {
      settle_by_shape(open);
    }
    touch(open);
    for (const layout::PatchIndex patch : open) result_.push_back({patch, "", FoundBy::kNothing});
    std::ranges::sort(result_, {}, &IdentifiedBoard::patch);
    return std::move(result_);
  }

 private:
  void find_boards() {
    auto claims = bus_.discover();
    if (claims.empty()) throw DeviceError(bus_.nobody_answers());
    claims = put_apart(bus_, std::move(claims), false);
    const auto users = session::users_of_addresses(claims);
    for (const auto& c : claims) {
      if (users.at(c.node_address) == 1) {
        session::Controller controller(bus_, c.node_address);
        boards_.push_back({c, read_shape(controller), {}, false});
      } else if (options_.say) {
        options_.say(fmt::format("controller {} is left out: it holds a table and shares node address {}",
                                 session::to_text(c.unique_id), c.node_address));
      }
    }
  }

  void compare_shapes() {
    std::vector<BoardShape> shapes;
    for (const FeelingBoard& b : boards_) shapes.push_back(b.shape);
    const std::vector<layout::PatchIndex> here = design::patches_here(design_);
    const ShapeAssignment found = assign_by_shape(shapes, seats_of(design_, here));
    for (std::size_t k = 0; k < boards_.size(); ++k) {
      by_shape_.push_back(found.seat[k] < 0 ? layout::PatchIndex::none()
                                            : here[static_cast<std::size_t>(found.seat[k])]);
      for (const int seat : found.likely[k]) boards_[k].likely.push_back(here[static_cast<std::size_t>(seat)]);
      boards_[k].across = found.across[k];
    }
  }

  void settle_by_shape(std::vector<layout::PatchIndex>& open) {
    std::vector<FeelingBoard> rest;
    for (std::size_t k = 0; k < boards_.size(); ++k) {
      const layout::PatchIndex patch = by_shape_[k];
      if (patch < 0)
        rest.push_back(std::move(boards_[k]));
      else
        assign(patch, boards_[k], FoundBy::kShape, open);
    }
    boards_ = std::move(rest);
  }

  void touch(std::vector<layout::PatchIndex>& open) {
    const bool all = options_.patch < 0 && boards_.size() == open.size();
    if (open.empty() || boards_.empty()) return;
    if (all && open.size() == 1) return assign(open[0], boards_[0], FoundBy::kOnly, open);
    TouchFinder finder(bus_, design_, boards_, options_);
    std::vector<bool> taken(boards_.size(), false);
    for (const layout::PatchIndex patch : std::vector<layout::PatchIndex>(open)) {
      const auto last = std::ranges::find(taken, false) - taken.begin();
      if (all && open.size() == 1 && std::ranges::count(taken, false) == 1)
        return assign(patch, boards_[static_cast<std::size_t>(last)], FoundBy::kOnly, open);
      const auto board = finder.find(patch);
      if (!board) continue;
      taken[*board] = true;
      assign(patch, boards_[*board], FoundBy::kTouch, open);
    }
  }

  void assign(layout::PatchIndex patch, const FeelingBoard& board, FoundBy by, std::vector<layout::PatchIndex>& open) {
    result_.push_back({patch, session::to_text(board.claim.unique_id), by});
    std::erase(open, patch);
    if (found_) found_(result_.back());
  }

  session::Bus& bus_;
  const design::Design& design_;
  const IdentifyOptions& options_;
  const std::function<void(const IdentifiedBoard&)>& found_;
  std::vector<FeelingBoard> boards_;
  std::vector<layout::PatchIndex> by_shape_;  // Each board has the patch that its shape settles, or −1.
  std::vector<IdentifiedBoard> result_;
};

}  // namespace

std::vector<IdentifiedBoard> identify(session::Bus& bus, const design::Design& design, const IdentifyOptions& options,
                                      const std::function<void(const IdentifiedBoard&)>& found) {
  if (options.patch >= 0 && !std::ranges::binary_search(design::patches_here(design), options.patch))
    throw InputError(
        fmt::format("--patch {}: the design has patches {}", options.patch, design::patch_numbers(design)));
  return Identification(bus, design, options, found).run();
}

}  // namespace triskin::deploy
