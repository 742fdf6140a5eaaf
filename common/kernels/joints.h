// Joints on the faces of cells of any kind: motion and pull of one face. Both of its sides compute the same tractions
// from the same numbers (differences and means of the two sides, whose signs alone differ), so what one side gains the
// other loses to the last bit.
#pragma once
#include "base/dim.h"
#include "kernels/fold.h"
#include "kernels/friction.h"
#include "kernels/views.h"
#include "laws/laws.h"

namespace fissure::kernels {

/// What the joints on the F faces of cells have and remember, at P points each. Blocked arrays.
template <int F, int P, class Real>
struct JointMemory {
  Real const* stiffness = nullptr;    // penalty / h [Pa/m]                                             [F]
  Real* history = nullptr;            // of each point, damage first (laws/joint.h)                  [F P joint_numbers]
  Real* work = nullptr;               // what damage took in opening and in slip [J]           [F 2]
  std::uint8_t* softening = nullptr;  // 1 once any joint of a pack of cells passed a peak on this face [pack][F]
  double* dissipated = nullptr;       // this side's half of what joints dissipated [J], per cell
  FaceEvents events;                  // joints of which a point began to soften or came to hold nothing
  Real* stretch =
      nullptr;  // of the friction spring of each point's damaged share, seen from this side [m]; null: none rubs
  Real const* weakness = nullptr;  // the law's strengths over those of the face [-]; null: 1 everywhere      [F]
  Real* tension = nullptr;         // that a joint opens across (kernels/rankine.h), null: none does:         [F D]
      // its direction in the face's axes, the first along the normal: 0: none yet, -1: never
  // whose law a face follows, counted from 1; 0: its body's; null: there are none   [F]
  std::uint8_t const* bond = nullptr;
  // of joints inserted where a body was whole (kernels/insertion.h), at each point: traction over stiffness when its
  // node was split, in the face's axes, the first along the normal, seen from this side [m]; null: none are   [F P D]
  Real* offset = nullptr;
  static constexpr int D = P == 2 ? 2 : 3;

  /// Where point i of face a keeps its number k of its history.
  FISSURE_HD Real& number(Index cell, int a, int i, int k) const {
    return history[blocked(cell, (a * P + i) * laws::joint_numbers + k, F * P * laws::joint_numbers)];
  }
  /// A face with s times the law's strengths and s^2 times its fracture energies carries s times the traction at s
  /// times the gap: the law is asked at the gap/s.
  template <class S>
  FISSURE_HD S weakness_of(Index cell, int a) const {
    return weakness ? load<S>(weakness + blocked(cell, a, F)) : S(1);
  }
  FISSURE_HD Real& tension_number(Index cell, int a, int k) const { return tension[blocked(cell, a * D + k, F * D)]; }
  /// Tells a face that a tension in the direction `way` pulls it; cosine: of the angle to its normal, 0: none does.
  template <class Axes, class Way>
  FISSURE_HD void tell_tension(Index cell, int a, Axes const& axes, Real cosine, Way const& way) const {
    tension_number(cell, a, 0) = cosine;
    for (int c = 0; c < D - 1; ++c) tension_number(cell, a, 1 + c) = axes.in_face[c].dot(way);
  }
  FISSURE_HD Real damage(Index cell, int a, int i) const { return number(cell, a, i, 0); }
  FISSURE_HD Real& offset_number(Index cell, int a, int i, int c) const {
    return offset[blocked(cell, (a * P + i) * D + c, F * P * D)];
  }
  /// Whether point i carried a traction when it was inserted.
  FISSURE_HD bool began_loaded(Index cell, int a, int i) const {
    bool any = false;
    for (int c = 0; c < D && offset; ++c) any = any || offset_number(cell, a, i, c) != 0;
    return any;
  }
  /// What is left of that at a damage: offset of the gap along the normal, and in the face. What presses stays: damage
  /// takes nothing of a pressure, whose faces meet where they did (CrackFace goes on with it).
  template <class Axes>
  FISSURE_HD void offset_at(Index cell, int a, int i, Real damage, Axes const& axes, Real& normal,
                            Vec<Real, D>& in_face) const {
    Real const pulled = offset_number(cell, a, i, 0);
    normal = pulled > 0 ? (1 - damage) * pulled : pulled;
    in_face.setZero();
    for (int c = 1; c < D; ++c) in_face += (1 - damage) * offset_number(cell, a, i, c) * axes.in_face[c - 1];
  }
};

/// Where the number c of point i of face a stands in arrays [F P D].
template <int D, int F, int P>
FISSURE_HD std::size_t of_point(Index cell, int a, int i, int c) {
  return blocked(cell, (a * P + i) * D + c, F * P * D);
}

/// Opening and slip of one face of a cell, seen from inside it.
template <int D, int P, class S>
struct FaceMotion {
  Vec<S, D> gap[P];       // at each point: the other side's displacement less this one's [m]
  Vec<S, D> normal;       // of the surface midway between both sides, outward, unit
  S opening[P], slip[P];  // parts of the gap along the normal (> 0: apart) and in the face [m]
  // of the surface, times two [m]: its side, two sides of a triangle, both diagonals of four corners
  Vec<S, D> span[D - 1];

  /// From twice the middle surface's corners; `outward`: +1 where their order turns the normal outward, else -1.
  FISSURE_HD void resolve(Vec<S, D> const (&middle)[P], S const& outward) {
    normal = Dim<D>::face_normal(middle);
    normal *= outward / root(normal.squaredNorm());
    for (int s = 0; s < D - 1; ++s) span[s] = middle[end(s)] - middle[begin(s)];
    for (int i = 0; i < P; ++i) {
      opening[i] = gap[i].dot(normal);
      slip[i] = root(along(i).squaredNorm());
    }
  }
  FISSURE_HD Vec<S, D> along(int i) const { return gap[i] - opening[i] * normal; }
  /// Corners where a span begins and ends.
  FISSURE_HD static constexpr int begin(int s) { return P == 4 ? s : 0; }
  FISSURE_HD static constexpr int end(int s) { return P == 4 ? s + 2 : s + 1; }
};

/// Axes in a face that turn with it, the same from both sides where those order its corners alike.
template <int D, class Real>
struct FaceAxes {
  Vec<Real, D> in_face[D - 1];

  FISSURE_HD explicit FaceAxes(Vec<Real, D> const (&span)[D - 1]) {
    for (int s = 0; s < D - 1; ++s) {
      in_face[s] = span[s];
      for (int before = 0; before < s; ++before) in_face[s] -= in_face[before].dot(span[s]) * in_face[before];
      in_face[s] /= in_face[s].norm();
    }
  }
};

/// A joint law at work on the faces of cells.
template <int D, int F, int P, class Real, class Law>
struct Joints {
  JointMemory<F, P, Real> memory;
  Law law;
  Law const* bonds = nullptr;      // laws of bonds
  double dt = 0;                   // of the step that led here [s]
  double* viscous_work = nullptr;  // of dampers in softened joints [J], per element
  bool on_demand = false;          // there are none before they are inserted
  using History = typename Law::template History<Real>;

  /// Whether no joint has been inserted around the pack that a cell is of.
  FISSURE_HD bool asleep(Index cell) const {
    bool any = !on_demand;
    for (int a = 0; a < F; ++a) any = any || memory.softening[(cell / layout_width) * F + a] != 0;
    return !any;
  }

  /// Pull of the joint on face a at each of its points [N]. `area`: of each point at rest [m^2], 0 where there is no
  /// joint; rate(i, l): how fast the gap at point i grows in lane l [m/s]; booked(l): the element that books the
  /// dampers' work.
  template <class S, class Rate, class Booked>
  FISSURE_HD void pull(Index cell, int a, FaceMotion<D, P, S> const& motion, S const (&area)[P], Rate const& rate,
                       Booked const& booked, Vec<S, D> (&f)[P]) const {
    S const k = load<S>(memory.stiffness + blocked(cell, a, F));
    bool passed = memory.softening[(cell / layout_width) * F + a] != 0;
    S const pulls = k * memory.template weakness_of<S>(cell, a);
    for (int i = 0; i < P; ++i) passed = passed || any_lane(law.past_peak(pulls, motion.opening[i], motion.slip[i]));
    if (passed) {
      S left[P];
      Vec<S, D> soft[P];
      for (int i = 0; i < P; ++i) left[i] = area[i];
      soften<S>(cell, a, k, motion, left, rate, booked, soft);
      for (int i = 0; i < P; ++i) f[i] = soft[i] + (left[i] * k) * motion.gap[i];
    } else {
      for (int i = 0; i < P; ++i) f[i] = (area[i] * k) * motion.gap[i];
    }
  }

  /// Adds this side's half of what the joint on face a holds to each lane's sum [J]: lanes are added up in the end,
  /// cell by cell, so that the total does not depend on the width of a pack.
  template <class S>
  FISSURE_HD void add_stored(Index cell, int a, FaceMotion<D, P, S> const& motion, S const (&area)[P],
                             double (&sum)[lane_width<S>]) const {
    if (memory.softening[(cell / layout_width) * F + a] == 0) {
      S const k = load<S>(memory.stiffness + blocked(cell, a, F));
      for (int i = 0; i < P; ++i) {
        S const stored = area[i] * k * motion.gap[i].squaredNorm() * as<S>(0.5);
        for (int l = 0; l < lane_width<S>; ++l) sum[l] += 0.5 * static_cast<double>(lane(stored, l));
      }
      return;
    }
    for (int l = 0; l < lane_width<S>; ++l) {
      if (!(lane(area[0], l) > 0)) continue;
      Real const k = memory.stiffness[blocked(cell + l, a, F)];
      Law const& its = law_of(cell + l, a);
      for (int i = 0; i < P; ++i) {
        auto const history = point(cell + l, a, i);
        Real opening = lane(motion.opening[i], l), slip = lane(motion.slip[i], l), given = 0;
        if (memory.began_loaded(cell + l, a, i)) {
          Vec<Real, D> normal, span[D - 1], gap, along;
          for (int c = 0; c < D; ++c) normal[c] = lane(motion.normal[c], l), gap[c] = lane(motion.gap[i][c], l);
          for (int s = 0; s < D - 1; ++s)
            for (int c = 0; c < D; ++c) span[s][c] = lane(motion.span[s][c], l);
          Real off;
          memory.offset_at(cell + l, a, i, history.damage, FaceAxes<D, Real>(span), off, along);
          given = its.stored(k, off, along.norm(), history);
          opening += off, slip = (gap - normal * gap.dot(normal) + along).norm();
        }
        Real stored = its.stored(k, opening, slip, history) - given;
        if (memory.stretch) {
          Real squared = 0;
          for (int c = 0; c < D; ++c)
            squared += memory.stretch[at(cell + l, a, i, c)] * memory.stretch[at(cell + l, a, i, c)];
          stored += its.rubbing(history.damage) * k * squared / 2;
        }
        sum[l] += 0.5 * static_cast<double>(lane(area[i], l) * stored);
      }
    }
  }

 private:
  FISSURE_HD History point(Index cell, int a, int i) const {
    return History::read([&](int k) { return memory.number(cell, a, i, k); });
  }
  FISSURE_HD Law const& law_of(Index cell, int a) const {
    std::uint8_t const bond = memory.bond ? memory.bond[blocked(cell, a, F)] : 0;
    return bond > 0 ? bonds[bond - 1] : law;
  }
  FISSURE_HD static std::size_t at(Index cell, int a, int i, int c) { return of_point<D, F, P>(cell, a, i, c); }

  /// Friction of the damaged share of a point, per area [Pa]: what it pulls this side along the slip of the other.
  FISSURE_HD Vec<Real, D> rub(Law const& its, Index cell, int a, int i, Real k, Real weak, Vec<Real, D> const& normal,
                              Vec<Real, D> const& gap, Vec<Real, D> const& move, Real damage, Real damage_now,
                              Real& dissipated) const {
    Real const opening = gap.dot(normal), most = Real(its.residual) * positive(-opening);
    Vec<Real, D> stretch, joining = gap - normal * opening;
    for (int c = 0; c < D; ++c) stretch[c] = memory.stretch[at(cell, a, i, c)];
    Real const slip = joining.norm();
    if (slip > 0) joining *= smaller(most / slip, root(its.undamaged(k, weak * opening, weak * slip) / k));
    auto const pull = damaged_friction<D, Real>(normal, move, k, its.rubbing(damage), its.rubbing(damage_now), most,
                                                joining, stretch, dissipated);
    for (int c = 0; c < D; ++c) memory.stretch[at(cell, a, i, c)] = stretch[c];
    return pull;
  }

  /// Whether a joint has damage, was inserted, opens across a tension or passes a peak in this step.
  FISSURE_HD bool softens(Law const& its, Index cell, int a, Real pulls, Real const (&opening)[P],
                          Real const (&slip)[P]) const {
    bool any = memory.tension && memory.tension_number(cell, a, 0) > 0;
    for (int i = 0; i < P; ++i)
      any = any || memory.damage(cell, a, i) > 0 || memory.began_loaded(cell, a, i) ||
            its.past_peak(pulls, opening[i], slip[i]);
    return any;
  }

  /// What a point carried when it was inserted, as an offset of its gap that its damage takes back, but for pressure.
  /// No work was done on it, so its energy is counted from there.
  struct Inserted {
    bool loaded = false;
    Real normal = 0;  // [m]
    Vec<Real, D> in_face = Vec<Real, D>::Zero();
    Real share = 1;  // 1 - damage

    FISSURE_HD Inserted(Joints const& joints, Index cell, int a, int i, Real damage, Vec<Real, D> const (&span)[D - 1])
        : loaded(joints.memory.began_loaded(cell, a, i)), share(1 - damage) {
      if (loaded) joints.memory.offset_at(cell, a, i, damage, FaceAxes<D, Real>(span), normal, in_face);
    }
    /// Books what its energy, that at the gap less that at the offset alone, loses by the offset that damage takes back
    /// and by what the offset alone no longer holds, beyond what the law has booked at the gap [J/m^2].
    FISSURE_HD void take_back(Law const& its, Real k, Vec<Real, D> const& gap, Vec<Real, D> const& n,
                              History const& before, History const& now, laws::JointEnergy<Real>& energy) const {
      Real const left = share > 0 ? (1 - now.damage) / share : Real(0), o = gap.dot(n);
      Vec<Real, D> const along = gap - o * n;
      Real const pulled = positive(normal), normal_left = normal - (1 - left) * pulled, offset = in_face.norm();
      Vec<Real, D> const along_now = along - (1 - left) * in_face;
      Real const lost = its.stored(k, o, along.norm(), now) -
                        its.stored(k, o - normal + normal_left, along_now.norm(), now) +
                        its.stored(k, normal_left, left * offset, now) - its.stored(k, normal, offset, before);
      Real const squares = pulled * pulled + offset * offset;
      energy.dissipated += lost;
      if (squares > 0) energy.by_slip += lost * offset * offset / squares;
    }
  };

  /// How fast the length of opening and slip grows [m/s], 0 where it does not. `o`, `s`: its parts now.
  FISSURE_HD static Real growth(Vec<Real, D> const& gap, Vec<Real, D> const& normal, Real o, Real s,
                                Vec<Real, D> const& rate) {
    Real const open = positive(o), apart = root(open * open + s * s), opening_rate = rate.dot(normal);
    return apart > 0 ? positive((open * opening_rate + gap.dot(rate) - o * opening_rate) / apart) : Real(0);
  }

  /// Whether both sides have folded about each other; spans and gaps are twice what the middle surface needs.
  FISSURE_HD static bool has_folded(Vec<Real, D> const (&span)[D - 1], Vec<Real, D> const (&gap)[P]) {
    Eigen::Matrix<Real, D, D - 1> middle, turn;
    for (int s = 0; s < D - 1; ++s) {
      middle.col(s) = span[s];
      turn.col(s) = gap[FaceMotion<D, P, Real>::end(s)] - gap[FaceMotion<D, P, Real>::begin(s)];
    }
    return folded<D, Real>(middle, turn);
  }

  /// What depends on the opening alone depends on the normal, so on where the middle surface's corners are, half of
  /// which are this side's: where the normal force is not along the gap it turns the face back. With it the force is
  /// that of the energy and has no moment (docs/theory/joints.md, The couple of a slipped joint). `slipped`: the sum of
  /// normal forces beyond what is along the gap, times slips [N m].
  template <class S>
  FISSURE_HD static void turn_back(Vec<Real, D> const& slipped, Vec<Real, D> const& normal,
                                   Vec<Real, D> const (&span)[D - 1], int l, Vec<S, D> (&f)[P]) {
    Eigen::Matrix<Real, D, D - 1> along;
    for (int s = 0; s < D - 1; ++s) along.col(s) = span[s];
    Eigen::Matrix<Real, D - 1, D - 1> const squares = along.transpose() * along;
    // Shares of the spans in the slips; half of them, as spans are doubled.
    Eigen::Matrix<Real, D - 1, 1> const share = squares.inverse() * (along.transpose() * slipped);
    for (int s = 0; s < D - 1; ++s)
      for (int c = 0; c < D; ++c) {
        int const from = FaceMotion<D, P, S>::begin(s), to = FaceMotion<D, P, S>::end(s);
        set_lane(f[to][c], l, lane(f[to][c], l) + share[s] * normal[c]);
        set_lane(f[from][c], l, lane(f[from][c], l) - share[s] * normal[c]);
      }
  }

  /// A joint which has softened has a damper of calming k dt [Pa s/m] beside its stiffness k while it is pressed:
  /// leapfrog gains energy on a spring that is there on one side only, a tenth per bounce where it limits the step
  /// (docs/theory/energy.md).
  static constexpr Real calming = Real(0.1);

  /// The rare path: joints with damage, lane by lane. Their areas become 0, so that they do not rise as well.
  template <class S, class Rate, class Booked>
  FISSURE_RARE FISSURE_DEVICE void soften(Index first, int a, S const& stiffness, FaceMotion<D, P, S> const& motion,
                                          S (&area)[P], Rate const& rate, Booked const& booked,
                                          Vec<S, D> (&f)[P]) const {
    for (auto& at : f) at = Vec<S, D>::Constant(S(0));
    for (int l = 0; l < lane_width<S>; ++l) {
      Index const cell = first + l;
      Law const& its = law_of(cell, a);
      Real const k = lane(stiffness, l), at_rest = memory.template weakness_of<Real>(cell, a);
      Real openings[P], slips[P];
      for (int i = 0; i < P; ++i) openings[i] = lane(motion.opening[i], l), slips[i] = lane(motion.slip[i], l);
      if (!(lane(area[0], l) > 0) || !softens(its, cell, a, k * at_rest, openings, slips)) continue;
      memory.softening[(cell / layout_width) * F + a] = 1;
      bool news = false;
      Vec<Real, D> normal, gaps[P], span[D - 1], pulled = Vec<Real, D>::Zero(), turned = Vec<Real, D>::Zero();
      for (int c = 0; c < D; ++c) normal[c] = lane(motion.normal[c], l);
      for (int s = 0; s < D - 1; ++s)
        for (int c = 0; c < D; ++c) span[s][c] = lane(motion.span[s][c], l);
      for (int i = 0; i < P; ++i)
        for (int c = 0; c < D; ++c) gaps[i][c] = lane(motion.gap[i][c], l);
      bool const gives_way = has_folded(span, gaps);
      laws::Tension<Real> tension;
      if (memory.tension && memory.tension_number(cell, a, 0) > 0) {
        FaceAxes<D, Real> const axes(span);
        tension.cosine = memory.tension_number(cell, a, 0);
        for (int c = 0; c < D - 1; ++c) pulled += memory.tension_number(cell, a, 1 + c) * axes.in_face[c];
      }
      for (int i = 0; i < P; ++i) {
        auto history = point(cell, a, i);
        laws::JointEnergy<Real> energy{};
        Real const w = lane(area[i], l);
        set_lane(area[i], l, Real(0));
        Real const damage = history.damage;
        Inserted const inserted(*this, cell, a, i, damage, span);
        Vec<Real, D> const gap = gaps[i] + inserted.normal * normal + inserted.in_face;
        Real const o = openings[i] + inserted.normal,
                   s = inserted.loaded ? (gap - gap.dot(normal) * normal).norm() : slips[i];
        Real const weak =
            its.faster.points == 0 ? at_rest : at_rest / its.faster.value(growth(gap, normal, o, s, rate(i, l)));
        tension.slip = weak * gap.dot(pulled);
        auto t = its.soften(
            k, weak * o, weak * s, history, energy,
            [&] {
              Vec<Real, D> const start = gap * Real(dt > 0) - rate(i, l) * Real(dt);  // no step led to the first moment
              Real const opened = start.dot(normal);
              return laws::JointGap<Real>{weak * opened, weak * (start - normal * opened).norm()};
            },
            tension);
        if (gives_way) t = Law::give_way(k, weak * o, weak * s, history, energy);
        t.normal /= weak, energy.dissipated /= weak * weak, energy.by_slip /= weak * weak;
        if (inserted.loaded) inserted.take_back(its, k, gap, normal, point(cell, a, i), history, energy);
        memory.work[blocked(cell, a * 2 + 0, F * 2)] += w * (energy.dissipated - energy.by_slip);
        memory.work[blocked(cell, a * 2 + 1, F * 2)] += w * energy.by_slip;
        Vec<Real, D> rubs = Vec<Real, D>::Zero();
        if (memory.stretch && history.damage > 0)
          rubs = rub(its, cell, a, i, k, weak, normal, gap, rate(i, l) * Real(dt), damage, history.damage,
                     energy.dissipated);
        turned += w * (t.normal * (gaps[i] - openings[i] * normal) - t.per_slip * openings[i] * (gap - o * normal));
        if (o < 0 && history.damage > 0) {
          Real const opening_rate = rate(i, l).dot(normal);
          Real const drag = calming * k * Real(dt) * opening_rate;
          t.normal += drag;
          viscous_work[booked(l)] += 0.5 * static_cast<double>(w * drag * opening_rate) * dt;
        }
        news = news || (history.damage > 0 && !(damage > 0)) || (history.damage >= 1 && damage < 1);
        FISSURE_EXPECT(history.damage >= damage && history.damage <= 1);
        history.write([&](int n, Real value) { memory.number(cell, a, i, n) = value; });
        // What an offset gives back is a loss below nothing; what a law takes is never, but for round-off.
        if (!inserted.loaded) energy.dissipated = positive(energy.dissipated);
        memory.dissipated[cell] += 0.5 * static_cast<double>(w * energy.dissipated);
        for (int c = 0; c < D; ++c)
          set_lane(f[i][c], l, w * (t.normal - t.per_slip * o) * normal[c] + w * (t.per_slip * gap[c] + rubs[c]));
      }
      turn_back<S>(turned, normal, span, l, f);
      if (news) memory.events.tell(cell, F, a);
    }
  }
};

}  // namespace fissure::kernels
