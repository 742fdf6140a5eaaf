// Contact of simplices with each other: forces of the potential (overlap.h) and Coulomb friction on a spring
// (friction.h).
#pragma once
#include <limits>

#include "kernels/friction.h"
#include "kernels/overlap.h"
#include "laws/contact.h"

namespace fissure::kernels {

/// Which law holds between which elements.
struct ContactTable {
  using Number = std::uint16_t;               // of a material: a byte would end at 256
  Number const* law = nullptr;                // of an element
  laws::ContactLaw const* between = nullptr;  // [n_laws][n_laws] for pairs; [body][n_laws] for rigid bodies
  Index n_laws = 1;

  FISSURE_HD laws::ContactLaw const& of(Index first, Index second) const { return between[first * n_laws + second]; }
};

/// Penalty of a pair, times how far it reaches out of the plane [Pa m, 3D: Pa]. In axisymmetry that is fixed at rest,
/// so that the forces still follow from a potential, and the smaller of both, so that no contact is stiffer for its
/// element than in the plane.
template <int D, class Real>
FISSURE_HD Real pair_penalty(MeshView<D, Real> const& mesh, laws::ContactLaw const& law, Index a, Index b) {
  return Real(law.penalty) * smaller(mesh.out_of_plane(a), mesh.out_of_plane(b));
}

/// What a contact remembers: the stretch of its friction spring (D numbers, [m]), the stiffness that carried it [N/m],
/// and until it has parted once where its potential begins (overlap.h): what was the largest when the pair became a
/// candidate, or what crack faces hand over (crack_faces.h); -1 as long as nobody has looked.
template <int D>
inline constexpr int spring_size = D + 2;

/// Candidate pairs of elements: forces on the corners of both, without friction, zero when they do not overlap. After
/// the list is rebuilt `force`, `stiffness`, `work` and `penetration` must be zero: a pair that does not touch and did
/// not touch before is left alone.
template <int D, class Real_>
struct PairForces {
  static constexpr char const* name = "contact pairs";
  static constexpr bool packed = true, gathers = true, costly = true;
  using Real = Real_;

  MeshView<D, Real> mesh;
  ContactTable table;
  Index count = 1;              // of pairs
  Index const* pair = nullptr;  // [pair][2]
  Real* spring = nullptr;       // [pair][spring_size<D>], carried over rebuilds
  Real* force = nullptr;        // [pair][2][D+1][D] [N]
  Real* stiffness = nullptr;    // [pair][2][D+1]: bound of the corner's row of the stiffness matrix [N/m]
  Real* weight = nullptr;       // [pair][2][D+1]: share of the corner in the point of action, where there is friction
  Real const* work = nullptr;   // [pair]: friction's, in the last step [J]
  Real* penetration = nullptr;  // [pair]: largest potential on a face inside the other, 0..1; > 0 where they touch
  // A pair with a gap sleeps until things have moved as far relative to each other (conservative advancement: B.
  // Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, PhD thesis, Berkeley 1996).
  double path = 0;               // longest way of anything relative to anything since the list was built [m]
  double* wake = nullptr;        // [pair]: path at which it must be looked at again [m]
  std::uint8_t* axis = nullptr;  // [pair]: along which a gap was last seen, looked along first; or `no_axis`
  Real* held = nullptr;          // [pair]: by the overlap, where it is asked for [J]
  // set to 1 when an element that touches is inside out, as a part of a block may be; null: nobody asks
  int* fault = nullptr;
  // Slots that nobody sums yet are told of: set to 1 when a pair that is not `listed` [pair] presses or did; null:
  // nobody asks.
  std::uint8_t const* listed = nullptr;
  int* news = nullptr;

  /// How many pairs, one after the other, are looked through for those that fill packs; a GPU's thread has one.
  template <class S>
  static constexpr Index block = lane_width<S> > 1 ? 512 : 1;

  template <class S = Real>
  FISSURE_HD void operator()(Index first) const {
    Meeting<S> meeting;
    Index const end = first + block<S> < count ? first + block<S> : count;
    for (Index i = first; i < end; ++i) {
      if (path < wake[i] || !may_meet(i, meeting)) continue;
      meeting.pair[meeting.count++] = i;
      if (meeting.count == lane_width<S>) press(meeting), meeting.count = 0;
    }
    if (meeting.count > 0) press(meeting);
  }

 private:
  /// Pairs that may overlap: the corners of both relative to the first of the first [m].
  template <class S>
  struct Meeting {
    alignas(sizeof(S)) Real x[2][D + 1][D][lane_width<S>];
    Index pair[lane_width<S>];
    int count = 0;
  };

  FISSURE_HD Real* memory(Index i) const { return spring + static_cast<std::size_t>(i) * spring_size<D>; }
  /// Nothing is left of a contact: without one, nothing is to be done.
  FISSURE_HD bool over(Index i) const { return !(penetration[i] > 0) && work[i] == 0 && !(memory(i)[D] > 0); }
  FISSURE_HD void sleep(Index i, Real gap) const { wake[i] = path + 0.99 * positive(static_cast<double>(gap)); }

  /// Places a pair in the next lane, unless the axis that parted it last time shows a gap.
  template <class S>
  FISSURE_HD bool may_meet(Index i, Meeting<S>& meeting) const {
    Index const ea = pair[2 * i], eb = pair[2 * i + 1];
    Vec<Real, D> const X0 = mesh.reference(ea, 0), u0 = mesh.displacement(mesh.vertex(ea, 0));
    Simplex<D, Real> a, b;
    a.place(mesh, ea, X0, u0);
    b.place(mesh, eb, X0, u0);
    if (axis[i] != no_axis && over(i)) {
      Vec<Real, D> const along = axis_between<D, Real>(a.x, b.x, axis[i]);
      Real const gap = gap_along(along, a.x, b.x) / along.norm();
      if (clear<D, Real>(gap, a)) {
        memory(i)[D + 1] = 0;
        sleep(i, gap);
        return false;
      }
    }
    for (int v = 0; v <= D; ++v)
      for (int c = 0; c < D; ++c) {
        meeting.x[0][v][c][meeting.count] = a.x[v][c];
        meeting.x[1][v][c][meeting.count] = b.x[v][c];
      }
    return true;
  }

  /// A pack of pairs; lanes without one repeat the first.
  template <class S>
  FISSURE_HD void press(Meeting<S>& meeting) const {
    constexpr int W = lane_width<S>;
    for (int l = meeting.count; l < W; ++l)
      for (auto& element : meeting.x)
        for (auto& corner : element)
          for (auto& x : corner) x[l] = x[0];
    Simplex<D, S> a, b;
    for (int v = 0; v <= D; ++v)
      for (int c = 0; c < D; ++c) {
        a.x[v][c] = load<S>(meeting.x[0][v][c]);
        b.x[v][c] = load<S>(meeting.x[1][v][c]);
      }
    auto const pair_of = [&](int l) { return meeting.pair[l < meeting.count ? l : 0]; };
    S const touched = generate<S>([&](int l) { return penetration[pair_of(l)] > 0 ? Real(1) : Real(0); });
    S const p = generate<S>([&](int l) {
      Index const i = pair_of(l), ea = pair[2 * i], eb = pair[2 * i + 1];
      return pair_penalty(mesh, table.of(table.law[ea], table.law[eb]), ea, eb);
    });
    S const begins = generate<S>([&](int l) { return larger(memory(pair_of(l))[D + 1], Real(0)); });

    Mat<S, D + 1> a_in_b, b_in_a;
    S along = S(0);
    S const gap = separation<D, S>(a, b, a_in_b, b_in_a, touched > S(0), along);
    auto const meet = !clear<D, S>(gap, a);
    Overlap<D, S> between(a, b, a_in_b, b_in_a, p, begins, gap, held != nullptr);
    between.on_a.normalise();
    between.on_b.normalise();

    alignas(sizeof(S)) Real gaps[W], axes[W], meets[W], deepest[W], energies[W], turned[2][W], forces[2][D + 1][D][W],
        stiffnesses[2][D + 1][W], weights[2][D + 1][W];
    store(gap, gaps), store(along, axes), store(select(meet, S(1), S(0)), meets);
    store(between.deepest, deepest), store(between.held, energies);
    store(select(a.turned, S(-1), S(1)), turned[0]), store(select(b.turned, S(-1), S(1)), turned[1]);
    for (int side = 0; side < 2; ++side) {
      auto const& on = side == 0 ? between.on_a : between.on_b;
      for (int v = 0; v <= D; ++v) {
        for (int c = 0; c < D; ++c) store(S(on.force[v][c]), forces[side][v][c]);
        store(S(2) * on.stiffness[v], stiffnesses[side][v]);  // the row meets the corners of both sides
        store(on.weight[v], weights[side][v]);
      }
    }
    for (int l = 0; l < meeting.count; ++l) {
      Index const i = meeting.pair[l], ea = pair[2 * i], eb = pair[2 * i + 1];
      axis[i] = meets[l] > 0 ? no_axis : static_cast<std::uint8_t>(axes[l]);
      if (fault && meets[l] > 0 && (turned[0][l] != mesh.parity[ea] || turned[1][l] != mesh.parity[eb])) raise(fault);
      Real& begin = memory(i)[D + 1];
      if (!(meets[l] > 0)) begin = 0;
      if (begin < 0) begin = deepest[l], deepest[l] = 0;
      if (!(deepest[l] > 0)) {
        // Parting, friction books once more: new slots know no penetration, but the spring does.
        if (over(i)) {
          if (!(meets[l] > 0)) sleep(i, gaps[l]);
          continue;
        }
      }
      if (news && !listed[i]) raise(news);
      penetration[i] = deepest[l];
      if (held) held[i] = energies[l];
      bool const rubs = table.of(table.law[ea], table.law[eb]).rubs();
      for (int side = 0; side < 2; ++side)
        for (int v = 0; v <= D; ++v) {
          std::size_t const slot = (2 * static_cast<std::size_t>(i) + side) * (D + 1) + v;
          if (rubs) weight[slot] = weights[side][v][l];
          stiffness[slot] = stiffnesses[side][v][l];
          for (int c = 0; c < D; ++c) force[slot * D + c] = forces[side][v][c][l];
        }
    }
  }
};

/// Friction of the pairs, in the plane of the contact between two pieces. One pair's own force leans to the side: it
/// has faces that lie inside a body, whose pressures cancel among neighbours. So the normal is that of the pressures
/// that the two pieces exert on each other around the nodes of the pair, weighted like its point of action, and the
/// pair's share of them is its force along it.
template <int D, class Real_>
struct PairFriction {
  static constexpr char const* name = "contact friction";
  static constexpr bool packed = false;
  using Real = Real_;

  MeshView<D, Real> mesh;
  ContactTable table;
  Real dt = 0;                  // since the springs were last stretched [s]
  Index const* pair = nullptr;  // these as PairForces has them
  Real* spring = nullptr;
  Real* force = nullptr;  // friction is added
  Real const* stiffness = nullptr;
  Real const* weight = nullptr;
  Real* work = nullptr;
  Real const* penetration = nullptr;
  Index const* listed = nullptr;   // places of the pairs that may rub; null: all of them
  Index const* group = nullptr;    // [listed][2][D+1]: where the corner's node and the other piece have their sum
  Real const* pressure = nullptr;  // [group][D]: of the forces of pairs, without friction [N]

  template <class S = Real>
  FISSURE_HD void operator()(Index n) const {
    Index const i = listed ? listed[n] : n;
    Real* const memory = spring + static_cast<std::size_t>(i) * spring_size<D>;
    if (!(penetration[i] > 0) && !(memory[D] > 0) && work[i] == 0) return;
    Index const ea = pair[2 * i], eb = pair[2 * i + 1];
    laws::ContactLaw const& law = table.of(table.law[ea], table.law[eb]);
    if (!(law.rubs())) return;
    std::size_t const a = static_cast<std::size_t>(i) * 2 * (D + 1), b = a + D + 1;
    Index const* const group_a = group + static_cast<std::size_t>(n) * 2 * (D + 1);
    Index const* const group_b = group_a + D + 1;
    Vec<Real, D> slip = Vec<Real, D>::Zero(), normal = slip, own = slip;
    Real k = 0;
    for (int c = 0; c <= D; ++c) {
      slip += mesh.velocity(mesh.vertex(eb, c)) * weight[b + c] - mesh.velocity(mesh.vertex(ea, c)) * weight[a + c];
      for (int d = 0; d < D; ++d) {
        normal[d] += pressure[group_b[c] * D + d] * weight[b + c] - pressure[group_a[c] * D + d] * weight[a + c];
        own[d] += force[(b + c) * D + d];
      }
      k += stiffness[a + c] / 2;
    }
    Real const size = normal.norm();
    if (size > 0) normal /= size;
    Real lost = 0;
    Real const pressing = positive(own.dot(normal));
    auto const drag = friction<D, Real>(normal, pressing, slip, dt, k, law.most(pressing), memory, lost);
    work[i] = lost;
    for (int c = 0; c <= D; ++c)
      for (int d = 0; d < D; ++d) {
        force[(a + c) * D + d] -= drag[d] * weight[a + c];
        force[(b + c) * D + d] += drag[d] * weight[b + c];
      }
  }
};

}  // namespace fissure::kernels
