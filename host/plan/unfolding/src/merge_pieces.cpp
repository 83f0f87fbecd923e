// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge_pieces.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <queue>
#include <string>
#include <tuple>

#include "triskin/base/index.hpp"

namespace triskin::unfolding {
namespace {

// A joined piece gets a new number, so that queue entries of its parts are recognised as outdated and each pair is
// tried once.
class Merger {
 public:
  Merger(const CutSurface& cut, std::vector<Piece>& pieces, const TryPiece& try_piece, const ProgressSink& progress)
      : cut_(cut),
        surface_(cut.surface()),
        pieces_(pieces),
        try_piece_(try_piece),
        progress_(progress),
        seams_(pieces.size()) {
    for (Piece& p : pieces) alive_.emplace_back(std::move(p));
  }

  void run() {
    find_seams();
    std::size_t left = std::max<std::size_t>(60'000, 30 * surface_.mesh().faces.size());
    std::size_t count = alive_.size();
    while (!queue_.empty()) {
      const auto [length, a, b] = queue_.top();
      queue_.pop();
      if (!alive_[at(a)] || !alive_[at(b)]) continue;
      std::vector<FaceIndex> both;
      std::ranges::merge(alive_[at(a)]->faces, alive_[at(b)]->faces, std::back_inserter(both));
      if (both.size() > left) continue;  // Smaller pairs may still fit.
      left -= both.size();
      auto joined = try_piece_(both);
      if (!joined) continue;
      replace(a, b, std::move(*joined));
      report(progress_, "merging pieces", -1.0, std::to_string(--count));
    }
    pieces_.clear();
    for (auto& p : alive_) {
      if (p) pieces_.push_back(std::move(*p));
    }
  }

 private:
  void find_seams() {
    std::vector<int> piece_of(surface_.mesh().faces.size(), -1);
    for (std::size_t p = 0; p < alive_.size(); ++p) {
      for (const FaceIndex f : alive_[p]->faces) piece_of[at(f)] = static_cast<int>(p);
    }
    for (std::size_t f = 0; f < piece_of.size(); ++f) {
      const auto& c = surface_.mesh().faces[f];
      for (int s = 0; s < 3; ++s) {
        const FaceIndex n = cut_.neighbour(FaceIndex(f), s);
        if (n < 0 || piece_of[at(n)] == piece_of[f]) continue;
        seams_[at(piece_of[f])][piece_of[at(n)]] +=
            (surface_.mesh().vertices[at(c[at((s + 1) % 3)])] - surface_.mesh().vertices[at(c[at(s)])]).norm();
      }
    }
    for (std::size_t a = 0; a < seams_.size(); ++a) {
      for (const auto& [b, length] : seams_[a]) {
        if (static_cast<int>(a) < b) queue_.emplace(length, static_cast<int>(a), b);
      }
    }
  }

  void replace(int a, int b, Piece joined) {
    const int id = static_cast<int>(alive_.size());
    alive_[at(a)].reset();
    alive_[at(b)].reset();
    alive_.emplace_back(std::move(joined));
    seams_.emplace_back();
    for (const int old : {a, b}) {
      for (const auto& [n, length] : seams_[at(old)]) {
        if (alive_[at(n)]) seams_[at(id)][n] += length;
      }
    }
    for (const auto& [n, length] : seams_[at(id)]) {
      seams_[at(n)][id] = length;
      queue_.emplace(length, n, id);
    }
  }

  const CutSurface& cut_;
  const mesh::Surface& surface_;
  std::vector<Piece>& pieces_;
  const TryPiece& try_piece_;
  const ProgressSink& progress_;
  std::vector<std::optional<Piece>> alive_;
  std::vector<std::map<int, double>> seams_;  // Each piece maps its neighbours to the length of their seam in mm.
  std::priority_queue<std::tuple<double, int, int>> queue_;
};

}  // namespace

void merge_pieces(const CutSurface& cut, std::vector<Piece>& pieces, const TryPiece& try_piece,
                  const ProgressSink& progress) {
  Merger(cut, pieces, try_piece, progress).run();
}

}  // namespace triskin::unfolding
