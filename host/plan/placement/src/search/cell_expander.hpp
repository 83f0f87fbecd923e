// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "kernels/contraction.hpp"
#include "kernels/edge_grid.hpp"
#include "kernels/evaluator.hpp"
#include "kernels/slice_raster.hpp"
#include "search/cell_list.hpp"
#include "search/cell_parts.hpp"
#include "search/conflict_bound.hpp"

namespace triskin::placement {

/// An open node of the branch and bound: a box of motions with a bound. A cell that is a slice has all translations of
/// one lattice period.
struct Cell {
  MotionBox box;
  int certain = 0;                       ///< This many tiles hold in the whole cell, in addition to those of the list.
  int bound = 0;                         ///< No motion in the cell has a higher value.
  std::shared_ptr<const CellList> list;  ///< A slice has no list.
  /// If positive, the list has no edges yet, and those within this distance of a tile may cut it.
  double reach_mm = 0.0;
  /// The middle of the part that gives a slice its bound. Empty until the slice is bounded.
  std::optional<Motion> promising = std::nullopt;
  /// In this many generations no contradictions are looked for, because there were few in a cell around this one.
  int without_conflicts = 0;
  std::optional<PackedTiles> packed = std::nullopt;  ///< Replaces the list while the cell waits, to save memory.
  [[nodiscard]] bool is_slice() const { return !list && !packed; }
};

/// States the separation that a tile must keep. It counts for a value from inset − tolerance on; for the bound from
/// half the tolerance less than the inset on, or, if the inset rises, from the inset on.
struct Demand {
  double inset_mm = 0.0, tolerance_mm = 0.0, resolution_mm = 0.0;
  /// Tiles that hold with less are kept in the lists, so that the inset may be raised up to this value.
  double last_inset_mm = 0.0;
  bool rising = false;     ///< The inset is raised when more than `best` tiles hold, and `best` stays unchanged.
  bool conflicts = false;  ///< Only in long searches is it worth looking for constraints that contradict each other.
};

struct Expansion {
  std::vector<Cell> children;
  std::vector<MotionBox> closed;  ///< Together with the children they cover the cell; they are kept only on request.
  std::vector<Motion> as_good;    ///< These motions reach `best` in the filtered lists and are not counted exactly.
  std::vector<std::pair<int, Motion>> better;  ///< These motions are counted exactly and sorted by rising value.
  /// These slices may hold `best` tiles or more; each has its bound.
  std::vector<std::pair<int, MotionBox>> tied_slices;
  int best = 0;              ///< as_good refers to this value.
  int unresolved_bound = 0;  ///< The parts that are too small to be split have this bound.
  bool too_large = false;    ///< A slice was left open because its raster would take too much memory.
  int passes = 0;
};

/// Refines one cell after another: bounds, clips and divides it. Keeps its memory, so each thread needs its own object.
class CellExpander {
 public:
  CellExpander(const PreparedPolygon& polygon, const TileGrid& grid, const EdgeGrid& edges)
      : polygon_(polygon),
        edges_(edges),
        filter_(polygon, grid),
        raster_(polygon, grid),
        evaluator_(polygon, grid),
        conflicts_(polygon, grid),
        grid_(grid) {}

  /// The children are those parts of the cell that may hold more than `best` tiles.
  void expand(Cell cell, const Demand& demand, int best, bool keep_closed, Expansion& result);

 private:
  void refine(Cell& cell);
  void set_frame(const MotionBox& box);
  void note_value(int value);
  void try_motion(const Motion& motion);
  void close(const MotionBox& box);
  void close_clipped(MotionBox whole, const MotionBox& clipped);
  void bound_slice(Cell& cell);
  void leave_open(const Cell& cell);
  void refine_slice(Cell& cell);
  [[nodiscard]] bool closed_by_conflicts(Cell& cell, CellList& list);
  void drop_dead(CellList& list);
  void halve_angles(const Cell& cell, const CellList& list);
  [[nodiscard]] bool unresolved(const Cell& cell);
  void look_ahead(Cell& cell, const CellList& list);
  void note_tie(const Cell& cell);
  [[nodiscard]] OpenParts<int> open_among(const Cell& cell, const PartIndex& low, const PartIndex& high) const;
  void divide_slice(const Cell& cell, const PartIndex& low, const PartIndex& high, std::size_t first_chosen,
                    int certain);
  int choose_border(const PartIndex& low, const PartIndex& high, std::size_t first, std::size_t last);
  void add_slice_child(const Cell& cell, const MotionBox& box, const OpenParts<int>& open, std::size_t first_chosen,
                       int certain);
  void divide(const Cell& cell, const CellList& list, const PartIndex& low, const PartIndex& high,
              std::size_t first_chosen, int certain);
  [[nodiscard]] std::shared_ptr<const CellList> chosen_list(const CellList& list, std::size_t first_chosen) const;
  int choose(const PartIndex& low, const PartIndex& high, std::size_t first, std::size_t last);
  [[nodiscard]] std::array<double, 3> weighted_half(const MotionBox& box) const;

  const PreparedPolygon& polygon_;
  const EdgeGrid& edges_;
  CellFilter filter_;
  SliceRaster raster_;
  Evaluator evaluator_;
  ConflictBound conflicts_;
  const TileGrid& grid_;
  CellFrame frame_;
  std::array<CellList, 2> lists_;
  OffsetBoxes boxes_;
  Contraction contraction_;
  std::vector<HalfSpace> halves_;
  Lookahead lookahead_;
  std::vector<PartWord> words_;
  // A stack of lists of tiles: those undecided in the parts that are being divided.
  std::vector<std::uint32_t> chosen_;
  PartIndex parts_{};
  Demand demand_;
  int best_ = 0;
  bool keep_closed_ = false;
  Expansion* result_ = nullptr;
};

}  // namespace triskin::placement
