// Bodies that are whole until they reach their strength: which vertices move as one, where joints are inserted, and how
// nodes split (docs/theory/joints.md, On demand).
#pragma once
#include <map>
#include <vector>

#include "kernels/insertion.h"
#include "model/model.h"
#include "model/state.h"
#include "solver/element_launch.h"

namespace fissure {

template <int D, class Real>
class InsertionStage {
 public:
  using Model = model::Model<D, Real>;

  InsertionStage(Device& device, scene::Scene const& scene, Model& model);

  /// Before forces, now and then: rounding leaves no gap between what is tied.
  void tie_motion();
  /// Where start_by_stress() tells of faces that have reached their strength; hear() has to follow.
  FacesFound found();
  void hear();
  /// After all forces but those of holds: splits nodes about which inserted joints part the cells, one cut at each in a
  /// step, then gives what is tied its common acceleration. A new joint carries at once what the tie has carried.
  void tie_forces(bool looks);

  /// The vertex moves as one with others at its node.
  bool tied(Index vertex) const;

  void save(State& state) const;
  /// After the model's arrays.
  void restore(State const& state);

 private:
  /// A corner of a face between two cells, seen from one of them.
  struct Point {
    int body;
    Index node, mine, theirs;  // the last two are vertices
    Index element;             // that is the cell or a part of it
    int face, i;               // of the cell, point of the face
  };

  /// A point of a joint between vertices of one group, by their places in it.
  struct Joint {
    Point const* point;
    Index mine, theirs;
    bool whole;  // then no more is known of it
    double area = 0, weakness = 1;
    Vec<double, D> normal_at_rest = Vec<double, D>::Zero();
    // As it lies now: outward; direction of the tension that opens it, and its cosine to the normal, 0: there is none
    Vec<double, D> normal = normal_at_rest, way = normal_at_rest;
    double cosine = 0;
  };
  /// Some vertices of a group, inside, and the others.
  struct Cut {
    std::vector<char> inside;
    double area = 0;                               // of the joints between both [m^2]
    double weakest = 0;                            // no pull of less than 1/weakest parts them [1/N]
    Vec<double, D> pull = Vec<double, D>::Zero();  // of the others on those inside [N]
    double reach = 0;                              // how far that is on the way to the peak of the joints
  };
  /// A group of vertices in several pieces that no whole face holds together, and the ways in which it may part.
  struct Seam {
    Index begin, end;
    std::vector<Joint> joints;
    std::vector<Cut> cuts;
  };
  using Seams = std::vector<Seam>;
  /// A face as it lies.
  struct Frame {
    Vec<Real, D> normal;
    kernels::FaceAxes<D, Real> axes;
    Real stiffness, weakness;
  };

  /// A number of an array; on a CPU from any thread.
  template <class T>
  T value(Buffer<T> const& array, std::size_t at) const {
    return device_.backend() == Backend::cpu ? array.data()[at] : array.download_one(at);
  }
  void list_points();
  Vec<double, D> inward(Index head, Index vertex) const;
  bool whole(Point const& point) const;
  std::vector<Index> pieces(Index begin, Index end, Index node) const;
  Index gather(Index begin, Index end, std::vector<char> const& inside);
  void set_shares(Index begin, Index end);
  Seams survey(Index node) const;
  std::vector<Joint> joints_within(Index begin, Index end, Index node) const;
  bool measure(Cut& cut, std::vector<Joint> const& joints) const;
  Cut const* look(Seam& seam, std::span<Real const> u, std::span<Real const> force) const;
  void place(std::vector<Joint>& joints, std::span<Real const> u) const;
  void weigh(Cut& cut, std::vector<Joint> const& joints) const;
  void part(Seam const& seam, Cut const& cut, std::span<Real const> u, std::span<Real const> force);
  laws::AnyJoint const& law_of(Joint const& joint) const {
    return *scene_.materials[scene_.bodies[joint.point->body].material].joint;
  }
  double area(Point const& point) const;
  void load(Point const& point, Vec<double, D> const& traction, std::span<Real const> u);
  template <class Visit>
  void with_frame(Point const& point, std::span<Real const> u, Visit&& visit) const;
  template <class Set>
  Frame frame(Set const& set, Index cell, Point const& point, std::span<Real const> u) const;
  kernels::TieView ties() const { return {first_.data(), vertex_.data(), starts_.data()}; }

  static constexpr int C = Model::C;

  Device& device_;
  scene::Scene const& scene_;
  Model& model_;
  std::vector<Index> host_first_, host_vertex_;  // as TieView, and
  std::vector<std::uint8_t> host_starts_;
  Buffer<Index> first_, vertex_;
  Buffer<std::uint8_t> starts_;
  Buffer<Real> share_;                              // as TieForces
  std::vector<Vec<double, D>> inward_;              // of each vertex, into its cell
  std::vector<Index> node_of_vertex_;               // -1: of no body that is whole
  std::vector<Point> points_;                       // node by node
  std::vector<std::size_t> first_point_;            // of each node
  std::array<std::vector<std::uint8_t>, 2> whole_;  // as JointArrays::whole, by kind of cell
  std::array<Buffer<Index>, 2> found_;              // faces that reached their strength
  Buffer<int> count_;                               // of those
  // Nodes at a joint that still hang together, and what is known of them until another joint is inserted there or they
  // part; none: nobody has looked.
  std::map<Index, Seams> waiting_;
};

}  // namespace fissure
