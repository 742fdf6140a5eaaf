// Tied bodies as a stage of the step: vertices of one hang on cells of another and move with them.
#pragma once
#include <Eigen/SparseCholesky>
#include <array>
#include <memory>
#include <vector>

#include "kernels/advance.h"
#include "kernels/hanging.h"
#include "model/model.h"
#include "solver/motion_stage.h"

namespace fissure {

/// With N the shares by which the accelerations a of carriers give those of what hangs, N a, nothing is lost and ties
/// do no work where
///   (M + N^T m N) a = f + N^T f_hung,   f_carrier <- f + N^T (f_hung - m N a),   f_hung <- m N a,
/// M and m the masses of carriers and of what hangs. Its matrix changes only when something leaves the run.
template <int D, class Real>
class TieStage {
 public:
  /// Throws Error at a tie's place where its bodies start with different velocities.
  TieStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model, MotionStage<D, Real>& motion);

  /// After other forces, before the reactions of holds, which carry what hangs on them.
  /// `more`: again in one step, of forces that have come since.
  void carry(kernels::VertexView<D, Real> const& vertices, double t, bool more = false);
  /// What hangs is where it hangs.
  void move();

  /// That its first body pulls its second with [N].
  Vec3 force(int tie) const { return force_.at(tie); }

 private:
  using Gather = kernels::GatherMotion<D, Real>;
  enum class Moved : char { freely, by_hold, on_axis };  // along a direction
  struct Share {
    Index at;  // of a carrier, in list_
    double share;
  };
  struct Row {
    Index at;  // of what hangs, in list_
    std::vector<Share> on;
    int tie;
    double sign;  // 1: of the tie's second body
  };
  /// What hangs along one direction. A held vertex does not, and what hangs on one goes where it is asked to.
  struct Along {
    std::vector<Row> rows;
    std::vector<int> unknown;  // of list_: its number among free carriers; -1: it is none
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> mass;
    Buffer<Index> hung, first, carrier;
    Buffer<double> share;
  };
  /// A carrier that a hold moves.
  struct Held {
    std::size_t set;
    Index k, at;  // in the hold's list, in list_
    int c;
  };

  Moved moved(Index at, int c) const { return moved_[static_cast<std::size_t>(at) * D + c]; }
  void list_vertices();
  void find_held();
  void place();
  void weigh(Along& along);
  std::vector<Row> rows_along(int c) const;
  void start();
  std::vector<double> held_push(kernels::VertexView<D, Real> const& vertices, double t,
                                std::vector<double> const& motion);
  void carry_along(int c, std::vector<double> const& motion, std::vector<double> const& held,
                   std::vector<double>& force);

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  MotionStage<D, Real>& motion_;
  std::vector<Index> list_;   // all vertices that hang or carry, ascending
  std::vector<double> mass_;  // of them [kg]; 0: it has left
  std::vector<Moved> moved_;  // [listed][D]
  std::vector<Held> held_;
  std::array<std::unique_ptr<Along>, D> along_;
  Buffer<Index> listed_;
  Buffer<double> gathered_, found_;
  std::vector<Vec3> force_;  // by tie [N]
};

}  // namespace fissure
