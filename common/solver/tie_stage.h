// Tied bodies as a stage of the step: vertices of one hang on cells of another and move with them.
#pragma once
#include <Eigen/SparseCholesky>
#include <array>
#include <map>
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
/// M and m the masses of carriers and of what hangs: constraints by transformation (R. D. Cook et al., Concepts and
/// Applications of Finite Element Analysis, 2002, chapter 13). Its matrix changes only when something leaves the run.
template <int D, class Real>
class TieStage {
 public:
  /// Throws Error at a tie's place where its bodies start with different velocities, or where what hangs is held and
  /// what it hangs on is not.
  TieStage(Device& device, scene::Scene const& scene, model::Model<D, Real>& model, MotionStage<D, Real>& motion);

  /// After other forces, before the reactions of holds, which carry what hangs on them. `more`: again in one step, of
  /// forces that have come since.
  void carry(kernels::VertexView<D, Real> const& vertices, double t, bool more = false);
  /// What hangs is where it hangs.
  void move();

  /// That its first body pulls its second with, and what hangs on that [N].
  Vec3 force(int tie) const { return force_.at(tie); }

 private:
  using Gather = kernels::GatherMotion<D, Real>;
  static constexpr int freely = -1, on_axis = -2;  // else a hold of the scene moves it
  struct Share {
    Index at;  // of a carrier, in list_
    double share;
  };
  struct Row {
    Index at;                       // of what hangs, in list_
    std::vector<Share> direct, on;  // what it hangs on; and what does not hang itself, on which it hangs in the end
    int tie;
    double sign;    // 1: of the tie's second body
    int depth = 0;  // of the chain that it ends
  };
  /// What hangs along one direction, the ends of chains first. What is held there does not.
  struct Along {
    std::vector<Row> rows;
    std::vector<int> unknown;  // of list_: its number among free carriers; -1: it is none
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> mass;
    Buffer<Index> hung, first, carrier;
    Buffer<double> share;
  };
  /// What of the list a hold moves.
  struct Held {
    std::size_t set;
    Index k, at;  // in the hold's list, in list_
    int c;
  };

  Index place_of(Index vertex) const {
    return static_cast<Index>(std::lower_bound(list_.begin(), list_.end(), vertex) - list_.begin());
  }
  int mover(Index at, int c) const { return mover_[static_cast<std::size_t>(at) * D + c]; }
  void list_vertices();
  void find_movers();
  void refuse_held();
  void refuse_torn(model::HungVertex<D> const& one, int c) const;
  void start();
  void place();
  std::vector<Row> rows_along(int c) const;
  static void resolve(std::map<Index, Row>& rows, Row& row);
  void weigh(Along& along);
  std::vector<double> held_push(kernels::VertexView<D, Real> const& vertices, double t,
                                std::vector<double> const& motion);
  void carry_along(int c, std::vector<double> const& motion, std::vector<double> const& held,
                   std::vector<double>& force);
  std::string told(model::HungVertex<D> const& one, int c) const;

  Device& device_;
  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  MotionStage<D, Real>& motion_;
  std::vector<Index> list_;  // all vertices that hang or carry, ascending
  std::vector<int> mover_;   // [listed][D]
  std::vector<Held> held_;   // by set
  std::size_t placed_ = 0;   // of what the model says hangs
  std::array<std::unique_ptr<Along>, D> along_;
  Buffer<Index> listed_;
  Buffer<double> gathered_, found_;
  std::vector<Vec3> force_;  // by tie [N]
};

}  // namespace fissure
