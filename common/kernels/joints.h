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
  FISSURE_HD FaceMotion<D, P, ScalarOf<S>> of(int l) const {
    FaceMotion<D, P, ScalarOf<S>> one;
    one.normal = lane_of<D>(normal, l);
    for (int i = 0; i < P; ++i) {
      one.gap[i] = lane_of<D>(gap[i], l);
      one.opening[i] = lane(opening[i], l), one.slip[i] = lane(slip[i], l);
    }
    for (int s = 0; s < D - 1; ++s) one.span[s] = lane_of<D>(span[s], l);
    return one;
  }
  /// Corners where a span begins and ends.
  FISSURE_HD static constexpr int begin(int s) { return P == 4 ? s : 0; }
  FISSURE_HD static constexpr int end(int s) { return P == 4 ? s + 2 : s + 1; }
};

/// Axes in a face that turn with it, the same from both sides where those order its corners alike.
template <int D, class S>
struct FaceAxes {
  Vec<S, D> in_face[D - 1];

  FISSURE_HD explicit FaceAxes(Vec<S, D> const (&span)[D - 1]) {
    for (int s = 0; s < D - 1; ++s) {
      in_face[s] = span[s];
      for (int before = 0; before < s; ++before) in_face[s] -= in_face[before].dot(span[s]) * in_face[before];
      in_face[s] /= root(in_face[s].squaredNorm());
    }
  }
};

/// The elements that book the work of a pack's dampers: lane l's.
struct BookedBy {
  Index first, apart;
  FISSURE_HD Index operator()(int l) const { return first + l * apart; }
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
  /// joint; rate(i, l): how fast the gap at point i grows in lane l [m/s].
  template <class S, class Rate>
  FISSURE_HD void pull(Index cell, int a, FaceMotion<D, P, S> const& motion, S const (&area)[P], Rate const& rate,
                       BookedBy booked, Vec<S, D> (&f)[P]) const {
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
    S const k = load<S>(memory.stiffness + blocked(cell, a, F));
    MaskOf<S> const jointed = area[0] > S(0);
    Points<S> const points(memory, cell, a, motion);
    for (int i = 0; i < P; ++i) {
      auto const history = remembered<S>(cell, a, i);
      Point<S> const& point = points.at[i];
      S stored = Law::stored(k, point.opening, point.slip, history);
      if (memory.offset) stored -= Law::stored(k, point.normal, root(point.in_face.squaredNorm()), history);
      stored = select(jointed, S(area[i] * stored), S(0));
      for (int l = 0; l < lane_width<S>; ++l) {
        sum[l] += 0.5 * static_cast<double>(lane(stored, l));
        if (memory.stretch && lane(history.damage, l) > 0 && lane(area[0], l) > 0) {
          Real squared = 0;
          for (int c = 0; c < D; ++c) {
            Real const stretch = memory.stretch[of_point<D, F, P>(cell + l, a, i, c)];
            squared += stretch * stretch;
          }
          Real const rubs = law_of(cell + l, a).rubbing(lane(history.damage, l)) * lane(k, l) * squared / 2;
          sum[l] += 0.5 * static_cast<double>(lane(area[i], l) * rubs);
        }
      }
    }
  }

 private:
  template <class S>
  using HistoryOf = typename Law::template History<S>;
  template <class S>
  FISSURE_HD HistoryOf<S> remembered(Index cell, int a, int i) const {
    return HistoryOf<S>::read([&](int k) { return load<S>(&memory.number(cell, a, i, k)); });
  }
  FISSURE_HD Law const& law_of(Index cell, int a) const {
    std::uint8_t const bond = memory.bond ? memory.bond[blocked(cell, a, F)] : 0;
    return bond > 0 ? bonds[bond - 1] : law;
  }
  /// A point as its law sees it. What it carried when it was inserted is an offset of its gap that damage takes back,
  /// but for what presses: faces that are pressed meet where they did (CrackFace goes on with it). No work was done on
  /// the offset, so energy is counted from there.
  template <class S>
  struct Point {
    Vec<S, D> gap;      // with the offset [m]
    S opening, slip;    // its parts [m]
    S loaded;           // 1 where it carried anything, else 0
    S normal;           // what damage left of the offset along the normal [m]
    Vec<S, D> in_face;  // and in the face [m]

    FISSURE_HD Point<Real> of(int l) const {
      return {lane_of<D>(gap, l), lane(opening, l), lane(slip, l),
              lane(loaded, l),    lane(normal, l),  lane_of<D>(in_face, l)};
    }
    /// Books what its energy, that at the gap less that at the offset alone, loses by the offset that damage takes back
    /// and by what the offset alone no longer holds, beyond what the law has booked at the gap [J/m^2].
    FISSURE_HD void take_back(Law const& its, Real k, Vec<Real, D> const& n, History const& before, History const& now,
                              laws::JointEnergy<Real>& energy) const {
      Real const share = 1 - before.damage, left = share > 0 ? (1 - now.damage) / share : Real(0), o = gap.dot(n);
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

  /// The points of a face as their law sees them, and the tension that it opens across.
  template <class S>
  struct Points {
    Point<S> at[P];
    S cosine = S(0);  // of the angle between tension and normal; 0 or less: there is no tension
    Vec<S, D> pulled = Vec<S, D>::Constant(S(0));  // part in the face of the tension's direction
    MaskOf<S> begun = S(0) > S(0);                 // whether it has damage, was inserted or opens across a tension

    FISSURE_HD Points(JointMemory<F, P, Real> const& memory, Index cell, int a, FaceMotion<D, P, S> const& motion) {
      for (int i = 0; i < P; ++i) {
        at[i] = {motion.gap[i], motion.opening[i], motion.slip[i], S(0), S(0), Vec<S, D>::Constant(S(0))};
        begun = begun || load<S>(&memory.number(cell, a, i, 0)) > S(0);
      }
      if (!memory.offset && !memory.tension) return;
      FaceAxes<D, S> const axes(motion.span);
      for (int i = 0; i < P && memory.offset; ++i) offset(memory, cell, a, i, motion.normal, axes, at[i]);
      if (!memory.tension) return;
      cosine = load<S>(&memory.tension_number(cell, a, 0));
      begun = begun || cosine > S(0);
      for (int c = 1; c < D; ++c)
        pulled += select(cosine > S(0), load<S>(&memory.tension_number(cell, a, c)), S(0)) * axes.in_face[c - 1];
    }
    FISSURE_HD void offset(JointMemory<F, P, Real> const& memory, Index cell, int a, int i, Vec<S, D> const& normal,
                           FaceAxes<D, S> const& axes, Point<S>& point) {
      S const left = S(1) - load<S>(&memory.number(cell, a, i, 0)),
              carried = load<S>(&memory.offset_number(cell, a, i, 0));
      MaskOf<S> loaded = carried != S(0);
      point.normal = select(carried > S(0), S(left * carried), carried);
      for (int c = 1; c < D; ++c) {
        S const slid = load<S>(&memory.offset_number(cell, a, i, c));
        loaded = loaded || slid != S(0);
        point.in_face += (left * slid) * axes.in_face[c - 1];
      }
      point.gap += point.normal * normal + point.in_face;
      point.opening += point.normal;
      Vec<S, D> const along = point.gap - point.gap.dot(normal) * normal;
      point.slip = select(loaded, root(along.squaredNorm()), point.slip);
      point.loaded = select(loaded, S(1), S(0));
      begun = begun || loaded;
    }
    /// For the law at `weak` times the gap of point i.
    FISSURE_HD laws::Tension<S> tension(int i, S const& weak) const {
      return {positive(cosine), weak * at[i].gap.dot(pulled)};
    }
  };

  /// How fast the length of opening and slip grows [m/s], 0 where it does not. `o`, `s`: its parts now.
  FISSURE_HD static Real growth(Vec<Real, D> const& gap, Vec<Real, D> const& normal, Real o, Real s,
                                Vec<Real, D> const& rate) {
    Real const open = positive(o), apart = root(open * open + s * s), opening_rate = rate.dot(normal);
    return apart > 0 ? positive((open * opening_rate + gap.dot(rate) - o * opening_rate) / apart) : Real(0);
  }

  /// Whether both sides have folded about each other; spans and gaps are twice what the middle surface needs.
  template <class S>
  FISSURE_HD static MaskOf<S> has_folded(FaceMotion<D, P, S> const& motion) {
    Eigen::Matrix<S, D, D - 1> middle, turn;
    for (int s = 0; s < D - 1; ++s) {
      middle.col(s) = motion.span[s];
      turn.col(s) = motion.gap[motion.end(s)] - motion.gap[motion.begin(s)];
    }
    return folded<D, S>(middle, turn);
  }

  /// What depends on the opening alone depends on the normal, so on where the middle surface's corners are, half of
  /// which are this side's: where the normal force is not along the gap it turns the face back. With it the force is
  /// that of the energy and has no moment (docs/theory/joints.md, The couple of a slipped joint). `slipped`: the sum of
  /// normal forces beyond what is along the gap, times slips [N m].
  template <class S>
  FISSURE_HD static void turn_back(Vec<S, D> const& slipped, FaceMotion<D, P, S> const& motion, Vec<S, D> (&f)[P]) {
    Eigen::Matrix<S, D, D - 1> along;
    for (int s = 0; s < D - 1; ++s) along.col(s) = motion.span[s];
    Eigen::Matrix<S, D - 1, D - 1> const squares = along.transpose() * along, inverse = squares.inverse();
    Eigen::Matrix<S, D - 1, 1> const parts = along.transpose() * slipped;
    // Shares of the spans in the slips; half of them, as spans are doubled.
    Eigen::Matrix<S, D - 1, 1> const share = inverse * parts;
    for (int s = 0; s < D - 1; ++s) {
      f[motion.end(s)] += share[s] * motion.normal;
      f[motion.begin(s)] -= share[s] * motion.normal;
    }
  }

  /// A joint which has softened has a damper of calming k dt [Pa s/m] beside its stiffness k while it is pressed:
  /// leapfrog gains energy on a spring that is there on one side only, a tenth per bounce where it limits the step
  /// (docs/theory/energy.md).
  static constexpr Real calming = Real(0.1);

  /// The rare path: joints that have begun to give way. Their areas become 0, so that they do not rise as well.
  template <class S, class Rate>
  FISSURE_CALL void soften(Index first, int a, S const& k, FaceMotion<D, P, S> const& motion, S (&area)[P],
                           Rate const& rate, BookedBy booked, Vec<S, D> (&f)[P]) const {
    for (auto& at : f) at = Vec<S, D>::Constant(S(0));
    if (!memory.bond) return soften(law, first, a, k, motion, rate, booked, area, f);
    for (int l = 0; l < lane_width<S>; ++l) {  // each by its law
      Real left[P];
      Vec<Real, D> pulls[P];
      for (int i = 0; i < P; ++i) left[i] = lane(area[i], l), pulls[i] = lane_of<D>(f[i], l);
      soften(
          law_of(first + l, a), first + l, a, lane(k, l), motion.of(l), [&](int i, int) { return rate(i, l); },
          BookedBy{booked(l), 1}, left, pulls);
      for (int i = 0; i < P; ++i) {
        set_lane(area[i], l, left[i]);
        for (int c = 0; c < D; ++c) set_lane(f[i][c], l, pulls[i][c]);
      }
    }
  }

  /// Where damage grows, a lane at a time, for laws branch; then all lanes at once, as damage leaves them.
  template <class S, class Rate>
  FISSURE_HD void soften(Law const& its, Index first, int a, S const& k, FaceMotion<D, P, S> const& motion,
                         Rate const& rate, BookedBy booked, S (&area)[P], Vec<S, D> (&f)[P]) const {
    Points<S> const points(memory, first, a, motion);
    S const at_rest = memory.template weakness_of<S>(first, a);
    MaskOf<S> soft = points.begun, holds = !has_folded(motion);
    for (int i = 0; i < P; ++i) soft = soft || its.past_peak(S(k * at_rest), motion.opening[i], motion.slip[i]);
    soft = soft && area[0] > S(0);
    if (!any_lane(soft)) return;
    memory.softening[(first / layout_width) * F + a] = 1;

    S weak[P], released[P], damage[P];
    for (int i = 0; i < P; ++i) {
      Point<S> const& at = points.at[i];
      auto const history = remembered<S>(first, a, i);
      damage[i] = history.damage, released[i] = S(0), weak[i] = at_rest;
      if (its.faster.points > 0)
        weak[i] /= generate<S>([&](int l) {
          auto const one = at.of(l);
          return its.faster.value(growth(one.gap, lane_of<D>(motion.normal, l), one.opening, one.slip, rate(i, l)));
        });
      holds = holds && its.holds(k, S(weak[i] * at.opening), S(weak[i] * at.slip), history, points.tension(i, weak[i]));
    }
    S const gives = select(soft && !holds, S(1), S(0));
    for (int l = 0; l < lane_width<S>; ++l)
      if (lane(gives, l) > 0) give(its, first, l, a, k, motion, points, area, weak, rate, released);

    Vec<S, D> pulls[P], turned = Vec<S, D>::Constant(S(0));
    for (int i = 0; i < P; ++i) {
      Point<S> const& at = points.at[i];
      auto const now = remembered<S>(first, a, i);
      auto t = Law::spring(k, at.opening, now);
      Vec<S, D> const along = at.gap - at.opening * motion.normal;
      turned += area[i] * (t.normal * motion.along(i) - t.per_slip * motion.opening[i] * along);

      Vec<S, D> stretch = Vec<S, D>::Constant(S(0)), rubs = stretch;
      MaskOf<S> const pressed = soft && now.damage > S(0) && at.opening < S(0);
      MaskOf<S> rubbing = pressed;
      for (int c = 0; c < D && memory.stretch; ++c) {
        stretch[c] = load<S>(memory.stretch + of_point<D, F, P>(first, a, i, c));
        rubbing = rubbing || (soft && stretch[c] != S(0));
      }
      if (any_lane(rubbing)) {
        // A lane at a time into memory: numbers of a pack are slow to set one by one.
        alignas(sizeof(S)) Real asked[lane_width<S>], speeds[D][lane_width<S>] = {};
        store(select(rubbing, S(1), S(0)), asked);
        for (int l = 0; l < lane_width<S>; ++l)
          if (asked[l] > 0) {
            Vec<Real, D> const one = rate(i, l);
            for (int c = 0; c < D; ++c) speeds[c][l] = one[c];
          }
        Vec<S, D> speed;
        for (int c = 0; c < D; ++c) speed[c] = load<S>(speeds[c]);
        if (memory.stretch) {
          Vec<S, D> const move = speed * as<S>(dt);
          Vec<S, D> stretched = stretch;
          S lost = S(0);
          Vec<S, D> const pull = rub(its, k, weak[i], motion.normal, at, move, damage[i], now.damage, stretched, lost);
          released[i] += select(rubbing, lost, S(0));
          for (int c = 0; c < D; ++c) {
            rubs[c] = select(rubbing, pull[c], S(0));
            store(select(rubbing, stretched[c], stretch[c]), memory.stretch + of_point<D, F, P>(first, a, i, c));
          }
        }
        S const opening_rate = speed.dot(motion.normal),
                drag = select(pressed, S(as<S>(calming * dt) * k * opening_rate), S(0));
        t.normal += drag;
        for (int l = 0; l < lane_width<S>; ++l)
          if (Real const lost = lane(S(area[i] * drag * opening_rate), l); lost > 0)
            viscous_work[booked(l)] += 0.5 * static_cast<double>(lost) * dt;
      }
      // What an offset gives back is a loss below nothing; what a law takes is never, but for round-off.
      released[i] = select(soft, S(area[i] * select(at.loaded > S(0), released[i], positive(released[i]))), S(0));
      for (int l = 0; l < lane_width<S>; ++l)
        if (Real const lost = lane(released[i], l); lost != 0)
          memory.dissipated[first + l] += 0.5 * static_cast<double>(lost);
      pulls[i] =
          (area[i] * (t.normal - t.per_slip * at.opening)) * motion.normal + area[i] * (t.per_slip * at.gap + rubs);
    }
    turn_back(turned, motion, pulls);
    for (int i = 0; i < P; ++i) {
      for (int c = 0; c < D; ++c) f[i][c] = select(soft, pulls[i][c], f[i][c]);
      area[i] = select(soft, S(0), area[i]);
    }
  }

  /// Lane l, whose damage grows, and what that releases at each point [J/m^2].
  template <class S, class Rate>
  FISSURE_HD void give(Law const& its, Index first, int l, int a, S const& stiffness, FaceMotion<D, P, S> const& motion,
                       Points<S> const& points, S const (&area)[P], S const (&weaker)[P], Rate const& rate,
                       S (&released)[P]) const {
    Index const cell = first + l;
    Real const k = lane(stiffness, l);
    Vec<Real, D> const normal = lane_of<D>(motion.normal, l);
    bool const gives_way = has_folded(motion.of(l));
    bool news = false;
    for (int i = 0; i < P; ++i) {
      Point<Real> const at = points.at[i].of(l);
      Real const w = lane(area[i], l), weak = lane(weaker[i], l);
      auto const before = remembered<Real>(cell, a, i);
      auto history = before;
      laws::JointEnergy<Real> energy{};
      its.soften(
          k, weak * at.opening, weak * at.slip, history, energy,
          [&] {
            Vec<Real, D> const start =
                at.gap * Real(dt > 0) - rate(i, l) * Real(dt);  // no step led to the first moment
            Real const opened = start.dot(normal);
            return laws::JointGap<Real>{weak * opened, weak * (start - normal * opened).norm()};
          },
          laws::Tension<Real>{positive(lane(points.cosine, l)), weak * at.gap.dot(lane_of<D>(points.pulled, l))});
      if (gives_way) Law::give_way(k, weak * at.opening, weak * at.slip, history, energy);
      energy.dissipated /= weak * weak, energy.by_slip /= weak * weak;
      if (at.loaded > 0) at.take_back(its, k, normal, before, history, energy);
      memory.work[blocked(cell, a * 2 + 0, F * 2)] += w * (energy.dissipated - energy.by_slip);
      memory.work[blocked(cell, a * 2 + 1, F * 2)] += w * energy.by_slip;
      set_lane(released[i], l, energy.dissipated);
      news = news || (history.damage > 0 && !(before.damage > 0)) || (history.damage >= 1 && before.damage < 1);
      FISSURE_EXPECT(history.damage >= before.damage && history.damage <= 1);
      history.write([&](int n, Real value) { memory.number(cell, a, i, n) = value; });
    }
    if (news) memory.events.tell(cell, F, a);
  }

  /// Friction of the damaged share of a point, per area: what it pulls this side along the slip of the other [Pa].
  /// `move`: of the other [m]; adds to `lost` [J/m^2].
  template <class S>
  FISSURE_HD Vec<S, D> rub(Law const& its, S const& k, S const& weak, Vec<S, D> const& normal, Point<S> const& at,
                           Vec<S, D> const& move, S const& damage, S const& damage_now, Vec<S, D>& stretch,
                           S& lost) const {
    S const most = as<S>(its.residual) * positive(-at.opening), share = its.rubbing(damage);
    S share_now = share;
    Vec<S, D> joining = Vec<S, D>::Constant(S(0));
    if (any_lane(damage_now > damage)) {
      share_now = its.rubbing(damage_now);
      joining = at.gap - normal * at.opening;
      S const slip = root(joining.squaredNorm()),
              held = root(its.undamaged(k, S(weak * at.opening), S(weak * slip)) / k);
      joining *= select(slip > S(0), smaller(S(most / slip), held), S(1));
    }
    return damaged_friction<D, S>(normal, move, k, share, share_now, most, joining, stretch, lost);
  }
};

}  // namespace fissure::kernels
