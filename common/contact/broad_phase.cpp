// Box search on hashed cells of several levels: see broad_phase.h.
#include "contact/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"

namespace fissure::contact {
namespace {

using Key = std::uint32_t;

/// A cell of a level as a short key. Two cells may share a key: that costs comparisons, never a pair.
template <int D>
struct Cell {
  int level;
  std::array<std::int64_t, D> at;

  Key key() const {
    std::uint64_t mixed = static_cast<std::uint64_t>(level) + 1;
    for (std::int64_t c : at) {  // the finaliser of SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2714064.2660195)
      mixed += static_cast<std::uint64_t>(c) + 0x9e3779b97f4a7c15u;
      mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
      mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
      mixed ^= mixed >> 31;
    }
    return static_cast<Key>(mixed);
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
    return static_cast<std::int64_t>(
        std::clamp(std::floor(std::ldexp((x - origin[axis]) / size, -level)), -4e18, 4e18));
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
                    " is not finite (its nodes have no place any more: the run has become unstable); use a smaller "
                    "time step or a smaller contact penalty");
}

struct Entry {
  Key key;
  Index box;
};

/// Least significant digit first, 11 bits at a time; stable, so boxes stay in order within a cell.
void sort_by_key(std::vector<Entry>& entries) {
  constexpr int bits = 11, buckets = 1 << bits;
  std::vector<Entry> other(entries.size());
  for (int shift = 0; shift < 32; shift += bits) {
    std::array<std::size_t, buckets> start{};
    for (Entry const& e : entries) ++start[(e.key >> shift) & (buckets - 1)];
    std::size_t sum = 0;
    for (std::size_t& s : start) sum += std::exchange(s, sum);
    for (Entry const& e : entries) other[start[(e.key >> shift) & (buckets - 1)]++] = e;
    entries.swap(other);
  }
}

/// Sorts by a, then b, and drops what was found twice; linear when no a has more than a few partners.
std::vector<ElementPair> sorted(std::vector<ElementPair> const& found, Index n) {
  std::vector<std::size_t> start(static_cast<std::size_t>(n) + 1, 0);
  for (ElementPair const& p : found) ++start[p.a + 1];
  for (Index a = 0; a < n; ++a) start[a + 1] += start[a];
  std::vector<ElementPair> pairs(found.size());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (ElementPair const& p : found) pairs[next[p.a]++] = p;
  for (Index a = 0; a < n; ++a) std::sort(pairs.begin() + start[a], pairs.begin() + start[a + 1]);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Boxes in cells, and the search among them.
template <int D>
class CellSearch {
 public:
  CellSearch(std::vector<Bounds<D>> const& boxes, std::vector<char> const& wanted, double size)
      : boxes_(boxes), wanted_(wanted), grid_{size, boxes[0].low} {
    Index const n = static_cast<Index>(boxes.size());
    own_.reserve(boxes.size());
    for (Bounds<D> const& box : boxes) {
      own_.push_back(grid_.range(box, std::max(grid_.level(extent(box)), Grid<D>::lowest)));
      if (std::find(levels_.begin(), levels_.end(), own_.back().level) == levels_.end())
        levels_.push_back(own_.back().level);
    }
    std::sort(levels_.begin(), levels_.end());
    for (Index i = 0; i < n; ++i) own_[i].for_each([&](Key key) { entries_.push_back({key, i}); });
    sort_by_key(entries_);
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (i == 0 || entries_[i].key != entries_[i - 1].key) first_.push_back(i);
    first_.push_back(entries_.size());
  }

  /// Pairs of one level meet in their own cells.
  void search_within_levels() {
    for (std::size_t g = 0; g + 1 < first_.size(); ++g)
      for (std::size_t i = first_[g]; i < first_[g + 1]; ++i)
        for (std::size_t j = i + 1; j < first_[g + 1]; ++j) {
          Index const p = entries_[i].box, q = entries_[j].box;
          if (own_[p].level == own_[q].level && p != q) compare(p, own_[p], q, entries_[i].key);
        }
  }

  /// A smaller box looks for larger ones in the cells that it covers on their levels.
  void search_across_levels() {
    if (levels_.size() < 2) return;
    index_cells();
    for (Index p = 0; p < static_cast<Index>(boxes_.size()); ++p)
      for (auto level = std::upper_bound(levels_.begin(), levels_.end(), own_[p].level); level != levels_.end();
           ++level) {
        CellRange<D> const range = grid_.range(boxes_[p], *level);
        range.for_each([&](Key key) {
          std::int64_t const g = find(key);
          for (std::size_t i = g < 0 ? 0 : first_[g]; g >= 0 && i < first_[g + 1]; ++i)
            if (own_[entries_[i].box].level == *level) compare(p, range, entries_[i].box, key);
        });
      }
  }

  std::vector<ElementPair> pairs() const { return sorted(found_, static_cast<Index>(boxes_.size())); }
  SearchCost cost() const {
    return {comparisons_, static_cast<std::int64_t>(entries_.size()), static_cast<int>(levels_.size())};
  }

 private:
  /// Reports an overlap in the one cell that eq. 8 names.
  void compare(Index p, CellRange<D> const& range, Index q, Key key) {
    if (!wanted_.empty() && !wanted_[p] && !wanted_[q]) return;
    ++comparisons_;
    if (!overlap(boxes_[p], boxes_[q])) return;
    Cell<D> owner{range.level, {}};
    for (int c = 0; c < D; ++c) owner.at[c] = std::min(range.up[c], own_[q].up[c]);
    if (owner.key() == key) found_.push_back({std::min(p, q), std::max(p, q)});
  }

  /// Open addressing, at most half full.
  void index_cells() {
    slots_.assign(std::bit_ceil(2 * first_.size()), -1);
    for (std::size_t g = 0; g + 1 < first_.size(); ++g) {
      std::size_t s = entries_[first_[g]].key & (slots_.size() - 1);
      while (slots_[s] >= 0) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = static_cast<std::int64_t>(g);
    }
  }
  /// Which cell has the key; -1 when none.
  std::int64_t find(Key key) const {
    std::size_t s = key & (slots_.size() - 1);
    while (slots_[s] >= 0 && entries_[first_[slots_[s]]].key != key) s = (s + 1) & (slots_.size() - 1);
    return slots_[s];
  }

  std::vector<Bounds<D>> const& boxes_;
  std::vector<char> const& wanted_;
  Grid<D> grid_;
  std::vector<CellRange<D>> own_;    // cells of each box on its level
  std::vector<int> levels_;          // in use, ascending
  std::vector<Entry> entries_;       // boxes by cell
  std::vector<std::size_t> first_;   // of each cell in entries_, and the end
  std::vector<std::int64_t> slots_;  // hash table of cells
  std::vector<ElementPair> found_;
  std::int64_t comparisons_ = 0;
};

/// Few boxes are looked for among all more quickly than all are sorted into cells: up to some 40, whether there are a
/// thousand or 50 000.
constexpr std::size_t few = 32;

/// Pairs of these boxes with any.
template <int D>
std::vector<ElementPair> pairs_with_few(std::vector<Bounds<D>> const& boxes, std::vector<Index> const& these) {
  std::vector<ElementPair> pairs;
  for (Index const i : these)
    for (Index j = 0; j < static_cast<Index>(boxes.size()); ++j)
      if (i != j && overlap(boxes[i], boxes[j])) pairs.push_back({std::min(i, j), std::max(i, j)});
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

template <int D>
std::vector<ElementPair> overlapping_pairs(std::vector<Bounds<D>> const& boxes, std::vector<char> const& wanted,
                                           double lambda, SearchCost* cost) {
  require_finite(boxes);
  if (boxes.size() < 2) return {};
  if (!wanted.empty()) {
    std::vector<Index> these;
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (wanted[i]) these.push_back(static_cast<Index>(i));
    if (these.size() <= few) return pairs_with_few<D>(boxes, these);
  }
  double mean = 0;
  for (Bounds<D> const& box : boxes) mean += extent(box) / static_cast<double>(boxes.size());
  CellSearch<D> search(boxes, wanted, mean > 0 ? lambda * mean : 1.0);
  search.search_within_levels();
  search.search_across_levels();
  if (cost) *cost = search.cost();
  return search.pairs();
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
std::vector<ElementPair> pairs_with_planes(std::vector<Bounds<D>> const& boxes,
                                           std::vector<Vec<double, D>> const& points,
                                           std::vector<Vec<double, D>> const& normals, double margin) {
  require_finite(boxes);
  std::vector<ElementPair> pairs;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t w = 0; w < points.size(); ++w) {
      double lowest = 0;
      for (int c = 0; c < D; ++c)
        lowest +=
            ((normals[w][c] > 0 ? boxes[i].low[c] - margin : boxes[i].high[c] + margin) - points[w][c]) * normals[w][c];
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
  for (std::size_t s = 0; s < vertex_of_slot.size(); ++s)
    lists.slot[place[vertex_of_slot[s]]++] = static_cast<Index>(s);
  return lists;
}

template std::vector<ElementPair> overlapping_pairs<2>(std::vector<Bounds<2>> const&, std::vector<char> const&, double,
                                                       SearchCost*);
template std::vector<ElementPair> overlapping_pairs<3>(std::vector<Bounds<3>> const&, std::vector<char> const&, double,
                                                       SearchCost*);
template std::vector<ElementPair> pairs_with_boxes<2>(std::vector<Bounds<2>> const&, std::vector<Bounds<2>> const&);
template std::vector<ElementPair> pairs_with_boxes<3>(std::vector<Bounds<3>> const&, std::vector<Bounds<3>> const&);
template std::vector<ElementPair> pairs_with_planes<2>(std::vector<Bounds<2>> const&,
                                                       std::vector<Vec<double, 2>> const&,
                                                       std::vector<Vec<double, 2>> const&, double);
template std::vector<ElementPair> pairs_with_planes<3>(std::vector<Bounds<3>> const&,
                                                       std::vector<Vec<double, 3>> const&,
                                                       std::vector<Vec<double, 3>> const&, double);

}  // namespace fissure::contact
