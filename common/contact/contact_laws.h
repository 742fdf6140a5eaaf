// Which contact law holds between what touches.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "kernels/contact.h"
#include "model/model.h"

namespace fissure {

/// Of pairs of materials, and of each rigid body with each material.
class ContactLaws {
 public:
  ContactLaws() = default;
  /// `material`: of each element. Throws Error where there are more materials than numbers.
  ContactLaws(Device& device, scene::Scene const& scene, std::vector<int> const& body_of_element) {
    using Number = kernels::ContactTable::Number;
    if (std::size_t const most = std::numeric_limits<Number>::max() + std::size_t(1); scene.materials.size() > most)
      throw Error(fmt::format("{}: there are {} materials (contact can tell {} apart); let bodies share them",
                              scene.file, scene.materials.size(), most));
    std::vector<Number> of_element;
    for (int const body : body_of_element)
      of_element.push_back(body < 0 ? Number(0) : static_cast<Number>(scene.bodies[body].material));
    std::vector<laws::ContactLaw> between;
    for (auto const& a : scene.materials)
      for (auto const& b : scene.materials) between.push_back(law_between(a, b));
    rubs_ = std::any_of(between.begin(), between.end(), [](laws::ContactLaw const& one) { return one.friction > 0; });
    n_materials_ = static_cast<Index>(scene.materials.size());
    of_element_ = Buffer<Number>(device, "contact laws", of_element);
    pairs_ = Buffer<laws::ContactLaw>(device, "contact laws", between);
    plates_ = Buffer<laws::ContactLaw>(device, "contact laws", with_rigid(scene.plates, scene.materials));
    walls_ = Buffer<laws::ContactLaw>(device, "contact laws", with_rigid(scene.walls, scene.materials));
  }

  bool rubs() const { return rubs_; }  // some pair of materials has friction
  // [material][material], [body][material]
  Buffer<laws::ContactLaw> const& of_pairs() const { return pairs_; }
  Buffer<laws::ContactLaw> const& of_plates() const { return plates_; }
  Buffer<laws::ContactLaw> const& of_walls() const { return walls_; }
  kernels::ContactTable pairs() const { return table(pairs_); }
  kernels::ContactTable plates() const { return table(plates_); }
  kernels::ContactTable walls() const { return table(walls_); }

 private:
  /// The material's; without one, a penalty of E' (the stiffness of the body itself) and no friction.
  static laws::ContactLaw law_of(scene::Material const& material) {
    if (material.contact) return *material.contact;
    return {material.elastic().confined(), 0};
  }
  /// What is rigid and has no law of its own takes that of what it touches.
  static laws::ContactLaw law_between(scene::Material const& a, scene::Material const& b) {
    bool const by_a = !a.rigid || a.contact, by_b = !b.rigid || b.contact;
    if (by_a == by_b) return laws::ContactLaw::between(law_of(a), law_of(b));
    return law_of(by_a ? a : b);
  }
  /// [body][material]; a rigid body without a law of its own takes the material's.
  template <class Rigid>
  static std::vector<laws::ContactLaw> with_rigid(std::vector<Rigid> const& bodies,
                                                  std::vector<scene::Material> const& materials) {
    std::vector<laws::ContactLaw> laws;
    for (auto const& body : bodies)
      for (auto const& material : materials) {
        auto const own = law_of(material);
        laws.push_back(body.contact ? laws::ContactLaw::between(*body.contact, own) : own);
      }
    return laws;
  }
  kernels::ContactTable table(Buffer<laws::ContactLaw> const& between) const {
    return {.law = of_element_.data(), .between = between.data(), .n_laws = n_materials_};
  }

  bool rubs_ = false;
  Index n_materials_ = 1;
  Buffer<kernels::ContactTable::Number> of_element_;
  Buffer<laws::ContactLaw> pairs_, plates_, walls_;
};

}  // namespace fissure
