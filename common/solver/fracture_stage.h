// Fracture as a stage of the step: joints that soften, and those that break.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "contact/contact_stage.h"
#include "model/model.h"
#include "solver/simulation.h"

namespace fissure {

template <int D, class Real>
class FractureStage {
 public:
  static constexpr int C = D + 1;

  FractureStage(scene::Scene const& scene, model::Model<D, Real>& model, ContactStage<D, Real>& contact)
      : scene_(scene), model_(model), contact_(contact) {}

  /// Joints of which a corner came to hold nothing in this step make the elements around them eligible for contact; and
  /// joints that began to soften, if they open wide before. Those whose every corner reached full damage leave the
  /// elements, which have already used their traction, and become faces that may only press and rub. `told`: how many
  /// faces of simplices and of blocks did either. True: some broke.
  bool follow(std::array<int, 2> const& told, double time);

  std::vector<BrokenJoint> const& broken() const { return broken_; }
  double area() const;    // of broken joints [m^2]
  double energy() const;  // what damage took of them until they broke [J]
  long count() const;     // the face of a block counts once
  /// Of joints inside each body and, last, of all bonds.
  std::vector<Softened> softened(std::vector<Index> const& cells) const;

  void save(State& state) const { state["broken"] = state_bytes(broken_); }
  void restore(State const& state);

 private:
  /// A joint that is about to break.
  struct Breaking {
    FaceId at;    // face of an element
    double work;  // what softening took of it [J]
  };
  static constexpr double wide = 0.1;  // final gap over an edge
  bool opens_wide(FaceId face) const;
  template <class Joints>
  std::vector<Index> hear(Joints& joints, int flag, int told);
  void release(Breaking const& joint, model::BreakingView<Real> const& now, model::JointRecords<D, Real> const& records,
               double time);

  scene::Scene const& scene_;
  model::Model<D, Real>& model_;
  ContactStage<D, Real>& contact_;
  std::vector<BrokenJoint> broken_;
};

}  // namespace fissure
