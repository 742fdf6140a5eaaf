// Which elements hang together, so that they must not touch, and which lie bare, so that they may.
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "model/model.h"
#include "model/state.h"

namespace fissure {

/// Corners at a node hang together when a chain of joints leads from one to the other there of which none has been
/// loosened.
template <int D, class Real>
class Bonds {
 public:
  static constexpr int C = D + 1;

  Bonds(mesh::Mesh const& mesh, model::Model<D, Real> const& model);

  /// The joint on a face holds no neighbourhood together any more (FractureStage says when): its elements may meet
  /// others across it; each other they meet through the joint, or as crack faces. False: that was known.
  bool loosen(FaceId face);
  /// Follows what has loosened since; to be called before the questions below.
  void connect();

  /// Two elements share a node and hang together there.
  bool hang_together(Index a, Index b) const;
  /// They must not touch: of a body that cannot touch itself, sides of a joint, or hanging together.
  bool joined(Index a, Index b) const;
  /// The corner (element (D + 1) + corner) that stands for those that hang together with this one.
  Index root_of(Index corner) const;

  bool loose(FaceId face) const { return loose_[at(face)] != 0; }
  /// Nothing is bonded to the face, or its joint has been loosened.
  bool bare(FaceId face) const { return bare_[at(face)] != 0; }
  /// The element has a node on a face that may touch.
  bool exposed(Index e) const { return exposed_[e] != 0; }
  /// What the element may touch has changed since this was forgotten.
  bool changed(Index e) const { return changed_[e] != 0; }
  void forget_changes() { std::fill(changed_.begin(), changed_.end(), 0); }
  /// Test hook: every element may touch, not only those with a corner at a bare face.
  void expose_everything();

  void save(State& state) const;
  void restore(State const& state);

 private:
  static std::size_t at(FaceId face) { return static_cast<std::size_t>(face.element) * C + face.face; }
  void expose_around(std::span<int const> nodes);
  void connect_everything();

  model::Model<D, Real> const& model_;
  std::vector<char> touches_itself_;              // per body: it can crack or is not convex
  std::vector<Index> node_first_, node_element_;  // elements at each mesh node
  std::vector<char> exposed_, changed_;           // per element
  std::vector<char> loose_;                       // per face of the lower element
  std::vector<char> bare_;                        // per face
  mutable std::vector<Index> parent_;             // union-find over corners; finding shortens its paths
  std::vector<int> loosened_nodes_;               // where `parent_` no longer holds
};

}  // namespace fissure
