// Everything that touches: pairs of elements, plates, walls, and the faces of broken joints until they have slid apart.
#pragma once
#include <map>
#include "model/model.h"

namespace fissure {

/// A joint that broke: its faces still press and rub on each other as a joint does, until they have moved apart.
struct BrokenJoint {
  Index element = 0, face = 0, other = 0, other_face = 0;
  double time = 0;             // when it broke [s]
  double area = 0;             // [m^2]; 2D: times thickness
  double mode = 0;             // share of slip in the work that softening took
  double out_of_plane = 0;     // share of mode III in the slip
  bool released = false;       // left to general contact
};

template <int D, class Real>
class ContactStage {
 public:
  ContactStage(Device& device, scene::Scene const& scene, mesh::Mesh const& mesh, model::Model<D, Real>& model);

  void add_forces(double time, double dt) ;
  void book_after(double dt);
  void add_broken(BrokenJoint const& joint);
  double omega_squared() const { return 0; }
  double largest_penetration() const { return 0; }
  double external_work() const { return 0; }
  double stored() const { return 0; }
  double friction() const { return 0; }
  Vec3 plate_force(int) const { return {0,0,0}; }
  Vec3 plate_displacement(int) const { return {0,0,0}; }
  Vec3 wall_force(int) const { return {0,0,0}; }
  void save(std::map<std::string, std::vector<std::uint8_t>>&) const {}
  void restore(std::map<std::string, std::vector<std::uint8_t>> const&) {}
  std::vector<BrokenJoint> const& broken() const { return broken_; }
 private:
  std::vector<BrokenJoint> broken_;
};
template <int D, class Real>
ContactStage<D,Real>::ContactStage(Device&, scene::Scene const&, mesh::Mesh const&, model::Model<D, Real>&) {}
template <int D, class Real> void ContactStage<D,Real>::add_forces(double,double){}
template <int D, class Real> void ContactStage<D,Real>::book_after(double){}
template <int D, class Real> void ContactStage<D,Real>::add_broken(BrokenJoint const& j){broken_.push_back(j);}
}  // namespace fissure
