// Box search on hashed cells of several levels: see broad_phase.h.
#include "solver/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "base/error.h"

namespace fissure::solver {
namespace {

/// A cell of a level as a 64-bit key. Two cells may share a key: that costs comparisons, never a pair.
template <int D>
struct Cell {
  int level;
  std::array<std::int64_t, D> at;

  std::uint64_t key() const {
    std::uint64_t mixed = static_cast<std::uint64_t>(level) + 1;
    for (std::int64_t c : at) {  // the finaliser of SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2714064.2660195)
      mixed += static_cast<std::uint64_t>(c) + 0x9e3779b97f4a7c15u;
      mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
      mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
      mixed ^= mixed >> 31;
    }
    return mixed;
  }
};

/// Cells of one level that a box covers: from low to up on each axis.
template <int D>
struct CellRange {
  int level;
  std::array<std::int64_t, D> low, up;

  template <class F>
  void for_each(F&& f) const {
    Cell<D> cell{level, low};
    while (true) {
      f(cell.key());
      int axis = 0;
      while (axis < D && cell.at[axis] == up[axis]) cell.at[axis] = low[axis], ++axis;
      if (axis == D) return;
      ++cell.at[axis];
    }
  }
};

/// Cells twice as large from level to level; level 0 has `size`.
template <int D>
struct Grid {
  double size;
  std::array<double, D> origin;

  int level(double extent) const { return extent > 0 ? static_cast<int>(std::ceil(std::log2(extent / size))) : lowest; }

  /// Far beyond the last cell that a number can tell from its neighbour, everything shares one.
  std::int64_t coordinate(double x, int axis, int level) const {
    return static_cast<std::int64_t>(std::clamp(std::floor(std::ldexp((x - origin[axis]) / size, -level)), -4e18, 4e18));
  }
  CellRange<D> range(Bounds<D> const& box, int level) const {
    CellRange<D> range{level, {}, {}};
    for (int c = 0; c < D; ++c) {
      range.low[c] = coordinate(box.low[c], c, level);
      range.up[c] = coordinate(box.high[c], c, level);
    }
    return range;
  }
  static constexpr int lowest = -40;  // points and boxes 10^12 times smaller than the mean share a level
};

/// Eq. 7: overlap on every axis, from both sides.
template <int D>
bool overlap(Bounds<D> const& p, Bounds<D> const& q) {
  for (int c = 0; c < D; ++c)
    if (p.low[c] > q.high[c] || q.low[c] > p.high[c]) return false;
  return true;
}

template <int D>
double extent(Bounds<D> const& box) {
  double widest = 0;
  for (int c = 0; c < D; ++c) widest = std::max(widest, box.high[c] - box.low[c]);
  return widest;
}

template <int D>
void require_finite(std::vector<Bounds<D>> const& boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (int c = 0; c < D; ++c)
      if (!std::isfinite(boxes[i].low[c]) || !std::isfinite(boxes[i].high[c]))
        throw Error("contact search: box " + std::to_string(i) + " of " + std::to_string(boxes.size()) +
                    " is not finite (its nodes have no place any more: the run has become unstable); "
                    "use a smaller time step or a smaller contact penalty");
}

struct Entry {
  std::uint64_t key;
  Index box;
};

/// Least significant digit first, 11 bits at a time; stable, so boxes stay in order within a cell.
void sort_by_key(std::vector<Entry>& entries) {
  constexpr int bits = 11, buckets = 1 << bits;
  std::vector<Entry> other(entries.size());
  std::vector<std::size_t> start(buckets);
  for (int shift = 0; shift < 64; shift += bits) {
    std::fill(start.begin(), start.end(), 0);
    for (Entry const& e : entries) ++start[(e.key >> shift) & (buckets - 1)];
    std::size_t sum = 0;
    for (std::size_t& s : start) sum += std::exchange(s, sum);
    for (Entry const& e : entries) other[start[(e.key >> shift) & (buckets - 1)]++] = e;
    entries.swap(other);
  }
}

/// Where the entries of a key begin: open addressing, at most half full.
class CellTable {
 public:
  explicit CellTable(std::vector<Entry> const& entries) : slots_(std::bit_ceil(2 * entries.size() + 2), {0, -1}) {
    for (std::size_t i = 0; i < entries.size(); ++i)
      if (i == 0 || entries[i].key != entries[i - 1].key) {
        std::size_t s = entries[i].key & (slots_.size() - 1);
        while (slots_[s].first >= 0) s = (s + 1) & (slots_.size() - 1);
        slots_[s] = {entries[i].key, static_cast<std::int64_t>(i)};
      }
  }
  /// -1 when there is none.
  std::int64_t find(std::uint64_t key) const {
    std::size_t s = key & (slots_.size() - 1);
    while (slots_[s].first >= 0 && slots_[s].key != key) s = (s + 1) & (slots_.size() - 1);
    return slots_[s].first;
  }

 private:
  struct Slot {
    std::uint64_t key;
    std::int64_t first;
  };
  std::vector<Slot> slots_;
};

}  // namespace

template <int D>
std::vector<ElementPair> overlapping_pairs(std::vector<Bounds<D>> const& boxes, double lambda, SearchCost* cost) {
  require_finite(boxes);
  Index const n = static_cast<Index>(boxes.size());
  std::vector<ElementPair> pairs;
  if (n < 2) return pairs;

  double mean = 0;
  for (auto const& box : boxes) mean += extent(box) / n;
  Grid<D> const grid{mean > 0 ? lambda * mean : 1.0, boxes[0].low};

  std::vector<CellRange<D>> own(boxes.size());
  std::vector<int> levels;
  for (Index i = 0; i < n; ++i) {
    int const level = std::max(grid.level(extent(boxes[i])), Grid<D>::lowest);
    own[i] = grid.range(boxes[i], level);
    levels.push_back(level);
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());

  std::vector<Entry> entries;
  for (Index i = 0; i < n; ++i) own[i].for_each([&](std::uint64_t key) { entries.push_back({key, i}); });
  sort_by_key(entries);
  CellTable const cells(entries);

  std::int64_t comparisons = 0;
  for (Index p = 0; p < n; ++p)
    for (auto level = std::lower_bound(levels.begin(), levels.end(), own[p].level); level != levels.end(); ++level) {
      CellRange<D> const range = *level == own[p].level ? own[p] : grid.range(boxes[p], *level);
      range.for_each([&](std::uint64_t key) {
        std::int64_t const first = cells.find(key);
        if (first < 0) return;
        for (std::size_t i = static_cast<std::size_t>(first); i < entries.size() && entries[i].key == key; ++i) {
          Index const q = entries[i].box;
          if (own[q].level != *level || (own[q].level == own[p].level && q <= p)) continue;
          ++comparisons;
          if (!overlap(boxes[p], boxes[q])) continue;
          Cell<D> owner{*level, {}};
          for (int c = 0; c < D; ++c) owner.at[c] = std::min(range.up[c], own[q].up[c]);
          if (owner.key() == key) pairs.push_back({std::min(p, q), std::max(p, q)});
        }
      });
    }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  if (cost) *cost = {comparisons, static_cast<std::int64_t>(entries.size()), static_cast<int>(levels.size())};
  return pairs;
}

template <int D>
std::vector<ElementPair> pairs_with_boxes(std::vector<Bounds<D>> const& boxes, std::vector<Bounds<D>> const& bodies) {
  require_finite(boxes);
  std::vector<ElementPair> pairs;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (overlap(boxes[i], bodies[b])) pairs.push_back({static_cast<Index>(i), static_cast<Index>(b)});
  return pairs;
}

template <int D>
std::vector<ElementPair> pairs_with_planes(std::vector<Bounds<D>> const& boxes, std::vector<Vec<double, D>> const& points,
                                           std::vector<Vec<double, D>> const& normals, double margin) {
  require_finite(boxes);
  std::vector<ElementPair> pairs;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t w = 0; w < points.size(); ++w) {
      double lowest = 0;
      for (int c = 0; c < D; ++c)
        lowest += ((normals[w][c] > 0 ? boxes[i].low[c] - margin : boxes[i].high[c] + margin) - points[w][c]) * normals[w][c];
      if (lowest <= 0) pairs.push_back({static_cast<Index>(i), static_cast<Index>(w)});
    }
  return pairs;
}

SlotLists slot_lists(std::vector<Index> const& vertex_of_slot, Index n_vertices) {
  SlotLists lists;
  std::vector<Index> place(static_cast<std::size_t>(n_vertices), 0);
  for (Index v : vertex_of_slot) ++place[v];
  lists.first.push_back(0);
  for (Index v = 0; v < n_vertices; ++v)
    if (place[v] > 0) {
      lists.vertex.push_back(v);
      lists.first.push_back(lists.first.back() + place[v]);
      place[v] = lists.first.end()[-2];
    }
  lists.slot.resize(vertex_of_slot.size());
  for (std::size_t s = 0; s < vertex_of_slot.size(); ++s) lists.slot[place[vertex_of_slot[s]]++] = static_cast<Index>(s);
  return lists;
}

template std::vector<ElementPair> overlapping_pairs<2>(std::vector<Bounds<2>> const&, double, SearchCost*);
template std::vector<ElementPair> overlapping_pairs<3>(std::vector<Bounds<3>> const&, double, SearchCost*);
template std::vector<ElementPair> pairs_with_boxes<2>(std::vector<Bounds<2>> const&, std::vector<Bounds<2>> const&);
template std::vector<ElementPair> pairs_with_boxes<3>(std::vector<Bounds<3>> const&, std::vector<Bounds<3>> const&);
template std::vector<ElementPair> pairs_with_planes<2>(std::vector<Bounds<2>> const&, std::vector<Vec<double, 2>> const&,
                                                       std::vector<Vec<double, 2>> const&, double);
template std::vector<ElementPair> pairs_with_planes<3>(std::vector<Bounds<3>> const&, std::vector<Vec<double, 3>> const&,
                                                       std::vector<Vec<double, 3>> const&, double);

}  // namespace fissure::solver
