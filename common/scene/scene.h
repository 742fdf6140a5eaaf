// What was asked for: a validated experiment as plain data, in SI units. It knows neither Lua nor the dimension;
// coordinates are always (x, y, z), y is the loading axis and z points out of the plane of a 2D model.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "base/algebra.h"
#include "base/error.h"
#include "laws/laws.h"
#include "scene/shapes.h"

namespace fissure::scene {

/// A number, or a function of time t [s] that a script gave (called between steps, never inside one).
struct TimeFunction {
  double number = 0;
  std::function<double(double)> function;  // empty: the constant `number`

  /// Before the start (of a scene that settles) all is as at the start.
  double operator()(double t) const { return function ? function(std::max(t, 0.0)) : number; }
  bool constant() const { return !function; }
};

/// One time function per direction; an absent one leaves that direction free.
using Directions = std::array<std::optional<TimeFunction>, 3>;

/// Where a mesh has faces, so that a crack can follow them: a straight line in the plane (3D: the plane through it
/// along z), or in 3D a flat polygon instead.
struct Seam {
  std::array<double, 2> from{}, to{};          // [m]
  std::vector<std::array<double, 3>> corners;  // of the polygon, in order around [m]; empty: the line
};

/// Smaller elements about a line in the plane (3D: the plane through it along z), or a point of it.
struct Near {
  std::array<double, 2> from{}, to{};  // [m]
  double radius = 0, size = 0;         // [m]; beyond the radius edges grow to the size of the rest
};

/// How a body is cut into elements.
struct MeshSpec {
  double irregular = 0;                   // inner nodes are moved at random by up to this share of their shortest edge
  double size = 0;                        // target edge length [m]
  std::string cells = "simplex";          // "simplex": "tri" or "tet"; "block": "quad" or "hex"
  std::string integration = "one_point";  // of blocks: or "full", "b_bar", "assumed_strain" (kernels/blocks.h)
  bool structured = false;                // boxes only: a regular grid cut into simplices
  // moves the unstructured mesh's points at random by a little: for mesh-to-mesh scatter
  unsigned seed = 0;
  std::vector<Seam> seams;  // unstructured meshes only
  std::vector<Near> near;   // the same

  bool blocks() const { return cells == "block" || cells == "quad" || cells == "hex"; }
  /// Cells in regular order, where the shape has one.
  bool regular() const { return structured || (blocks() && !seed && seams.empty() && near.empty()); }
};

// ------------------------------------------------------------------------------------------------------- materials
/// How a material flows. Its elastic part is then linear in the strain measure of the flow, whatever `bulk` says.
struct Flow {
  laws::AnyFlow law;
  std::vector<double> curves;  // numbers of a law with curves (laws::Curves)
  std::string sampled;         // how well curves stand for the function they were taken from
  laws::Heat heat;
  bool logarithmic = false;  // strain = "logarithmic"; else the Jaumann rate
  bool bisection = false;    // solver = "bisection"; else Newton's method
  bool averaged = false;     // pressure = "averaged"; else each element's own
};

/// Weibull's distribution of the strengths of joints about those of the material: every joint has its own.
struct Scatter {
  double modulus = 0;  // m: the larger, the less scatter
  // of a face that has the material's strengths on average [m^2]; 0: of any
  double area = 0;
  unsigned seed = 0;
};

struct Material {
  std::string name;
  Source source;
  double density = 0;    // [kg/m^3]
  laws::AnyBulk bulk;    // elastic law
  double viscosity = 0;  // mu of the stress 2 mu D [Pa s] (paper eq. 2)
  // damping = "critical" is 1: mu = share * 2 h sqrt(E rho), h the mean edge
  double critical_share = 0;
  std::optional<Flow> flow;                 // absent: no plasticity
  std::optional<laws::AnyJoint> joint;      // absent: no fracture
  std::optional<Scatter> scatter;           // absent: every joint has the law's strengths
  std::optional<laws::ContactLaw> contact;  // absent: derived from the elastic law (penalty E', no friction)
  bool rigid = false;                       // of rigid bodies: a contact that is absent is that of what they touch

  laws::ElasticConstants const& elastic() const {
    return std::visit([](auto const& law) -> laws::ElasticConstants const& { return law; }, bulk);
  }
};

// ---------------------------------------------------------------------------------------------------------- bodies
/// A named part of a body ("left", "top", "all", a physical group) or the points where `inside(x, y, z)` holds.
struct Region {
  std::string name;  // empty when a predicate was given
  std::function<bool(double, double, double)> inside;
};

struct Body {
  std::string name;
  Source source;
  Shape shape;
  MeshSpec mesh;
  int material = -1;                                                         // index into Scene::materials
  std::array<double, 3> velocity{0, 0, 0};                                   // initial, uniform [m/s]
  std::function<std::array<double, 3>(double, double, double)> velocity_at;  // initial, by place; overrides `velocity`
  std::function<std::array<double, 6>(double, double, double)> stress_at;    // initial: xx yy zz xy yz zx [Pa]
  std::optional<double> temperature;                                         // initial [K]; else its material's
  bool rigid = false;                                                        // it moves, but does not deform
};

/// Faces of a body with strengths of their own: weak planes, joint sets, cracks that are there from the start.
struct JointSet {
  std::string name;
  Source source;
  int body = -1;
  std::optional<Seam> seam;                            // faces that lie on it
  std::function<bool(double, double, double)> inside;  // faces whose middle is inside; empty: anywhere
  std::optional<Vec3> facing;                          // faces whose normal is within an angle of it, either way
  double within = 0;                                   // that angle [rad]
  // over the material's; fracture energies: its square; 0: broken from the start
  double strength = 0;
};

/// Joints between bodies that meet: of any two of them.
struct Bond {
  std::string name;
  Source source;
  std::vector<int> bodies;
  laws::CohesiveJoint joint;  // its `residual` is the smaller friction of the two bodies
  std::optional<Scatter> scatter;
  std::function<bool(double, double, double)> inside;  // faces whose middle is inside; empty: all that meet
};

/// Two bodies that hang together where their surfaces meet, whatever their meshes: the nodes of one move with the cells
/// of the other.
struct Tie {
  std::string name;
  Source source;
  std::array<int, 2> bodies{-1, -1};
  std::optional<double> within;                        // nodes nearer to the other body are tied [m]; else by edges
  std::function<bool(double, double, double)> inside;  // nodes that are tied; empty: all that are near enough
};

class Now;

/// How fast a plate moves, as its scene finds right from time to time: along directions that nothing else drives.
struct Servo {
  double every = 0;                                           // [s]
  std::function<std::array<double, 3>(Now const&)> velocity;  // [m/s]
};

/// A rigid box that moves as told and records what the bodies push it with.
struct Plate {
  std::string name;
  Source source;
  Box box;                                  // where it stands at t = 0
  Directions velocity;                      // [m/s]; absent directions stand still, or a force drives it
  std::optional<laws::ContactLaw> contact;  // absent: the touching body's own
  Directions force{};                       // [N]; 2D: on the scene's thickness, or once around the axis
  double mass = 0;                          // of one that a force drives [kg]
  std::optional<Servo> servo{};
};

/// A rigid half-space: everything must stay on the side its normal points to.
struct Wall {
  std::string name;
  Source source;
  Vec3 point{0, 0, 0}, normal{0, 1, 0};
  std::optional<laws::ContactLaw> contact;
};

// ----------------------------------------------------------------------------------------------------------- loads
/// Motion about an axis, which stands still: of a place at x, turning a x (x - through) and outward, away from the
/// axis.
struct Around {
  Vec3 through{0, 0, 0}, axis{0, 0, 1};  // [m], [-]
  TimeFunction turning, outward;         // [rad/s], [m/s]
  double reach = 0;                      // of the body from the axis at rest, known once it is meshed [m]

  Vec3 velocity(Vec3 const& x, double t) const {
    Vec3 const across = x - through - (x - through).dot(axis) * axis;
    return turning(t) * axis.cross(across) + outward(t) * across.normalized();
  }
  /// Whether a place does not move along a direction: on the axis, or along it, or nothing turns.
  bool still(int c, Vec3 const& x, double t) const {
    return std::abs(axis[c]) > 1 - 1e-9 || on_axis(x) || (turning(t) == 0 && outward(t) == 0);
  }
  /// But for rounding.
  bool on_axis(Vec3 const& x) const { return (x - through).cross(axis).norm() <= 1e-9 * reach; }
  bool same_axis(Around const& other) const { return (axis - other.axis).norm() < 1e-9 && on_axis(other.through); }
};

// prescribed velocity [m/s], or motion about an axis
struct Hold {
  Source source;
  int body = -1;
  Region where;
  Directions velocity;
  std::optional<Around> around{};

  /// Along a direction that it prescribes, of a place at rest [m/s].
  double velocity_at(int c, Vec3 const& x, double t) const {
    return around ? around->velocity(x, t)[c] : (*velocity[c])(t);
  }
  /// Whether both move a place in the same way along a direction, then and as long as they go on like that: about the
  /// same axis, or where nothing moves.
  bool agrees(Hold const& other, int c, Vec3 const& x, double t) const {
    if (!around && !other.around) return (*velocity[c])(t) == (*other.velocity[c])(t);
    if (around && other.around)
      return around->same_axis(*other.around) && around->turning(t) == other.around->turning(t) &&
             around->outward(t) == other.around->outward(t);
    auto const& [turned, straight] = around ? std::tie(*this, other) : std::tie(other, *this);
    return turned.around->still(c, x, t) && (*straight.velocity[c])(t) == 0;
  }
};
// force per reference area [Pa]
struct Traction {
  Source source;
  int body = -1;
  Region where;
  Directions value;
};
// between two points, of bodies or of the space around them
struct Spring {
  std::string name;
  Source source;
  std::array<int, 2> bodies{-1, -1};  // -1: a place that stands still
  std::array<Vec3, 2> at{Vec3::Zero(), Vec3::Zero()};
  double stiffness = 0;                                       // [N/m]; 2D: of the scene's thickness
  std::optional<double> length;                               // without force [m]; else what it is drawn with
  double damping = 0;                                         // [N s/m]
  double strength = std::numeric_limits<double>::infinity();  // pulled beyond this it breaks [N]
  bool slack = false;                                         // it never pushes
};
// on all faces of the part together, spread evenly, or at the vertex nearest to a point [N]
struct Force {
  Source source;
  int body = -1;
  Region where;
  std::optional<Vec3> point;
  Directions value;
};
// per volume at rest [N/m^3], times a function of time
struct BodyForce {
  Source source;
  int body = -1;
  std::array<double, 3> value{0, 0, 0};                                   // everywhere alike
  std::function<std::array<double, 3>(double, double, double)> value_at;  // by place at rest; overrides `value`
  TimeFunction times{1, {}};
};
// a body, or its cells whose middles at rest lie within, leave the run
struct Excavation {
  Source source;
  int body = -1;
  double time = 0;                                     // with the first step from here on [s]
  std::function<bool(double, double, double)> within;  // none: all of it
};
// a part of the surface that takes up the waves that reach it
struct Absorb {
  Source source;
  int body = -1;
  Region where;
};
// inward [Pa]; per area and along the normal at rest, or as they are now
struct Pressure {
  Source source;
  int body = -1;
  Region where;
  TimeFunction value;
  bool follows = false;
};

// -------------------------------------------------------------------------------------------------------- what to see
/// A piece of the bodies that hangs together by faces which are not broken.
struct Fragment {
  double mass = 0;               // without what mass scaling adds [kg]; 2D: of the thickness, or once around the axis
  Vec3 center = Vec3::Zero();    // of mass, now [m]
  Vec3 velocity = Vec3::Zero();  // mass average [m/s]
  Vec3 size = Vec3::Zero();      // how far it reaches now along each axis [m]
};

/// Where one body presses on another.
struct Touch {
  double area = 0;  // of the surface of the first, as it is now [m^2]; 2D: times thickness
  double push = 0;  // along its normals, inward [N]
};

/// What a measure, a stop condition or an expectation may ask a running experiment.
class Now {
 public:
  virtual ~Now() = default;
  virtual double time() const = 0;  // [s]
  virtual long step() const = 0;
  // what the bodies push it with [N]; 2D: times thickness
  virtual Vec3 plate_force(int plate) const = 0;
  virtual Vec3 plate_displacement(int plate) const = 0;      // [m]
  virtual Vec3 wall_force(int wall) const = 0;               // [N]
  virtual double energy(std::string const& name) const = 0;  // [J]; names: energy_names()
  // of the vertex nearest to the reference point [m]
  virtual Vec3 displacement(int body, Vec3 const& point) const = 0;
  virtual Vec3 velocity(int body, Vec3 const& point) const = 0;  // [m/s]
  // xx yy zz xy yz zx of the element there [Pa]
  virtual std::array<double, 6> stress(int body, Vec3 const& point) const = 0;
  virtual Vec3 mean_velocity(int body) const = 0;  // mass average [m/s]
  virtual Vec3 reaction(int hold) const = 0;       // force that a prescribed motion needs [N]
  virtual double torque(int hold) const = 0;       // that it needs about its axis [N m]
  // what the contacts of another body push and rub a body with; 2D: times thickness [N]
  virtual Vec3 contact_force(int body, int other) const = 0;
  virtual Touch touch(int body, int other) const = 0;
  virtual double pull(int spring) const = 0;  // what it pulls its ends together with [N]
  virtual Vec3 tie_force(int tie) const = 0;  // that its first body pulls its second with [N]
  // broken joints [m^2]; 2D: length times thickness
  virtual double crack_area() const = 0;
  // what damage took of them until they broke [J]
  virtual double crack_energy() const = 0;
  virtual long broken_joints() const = 0;
  virtual long removed_pieces() const = 0;                      // that were crushed
  virtual double removed_mass() const = 0;                      // [kg]
  virtual std::vector<Fragment> fragments(int body) const = 0;  // of a body, -1: of all; heaviest first
  virtual double field(std::string const& field, int body, Vec3 const& point) const = 0;  // of the element there
  /// Mean by volume at rest, over the cells of a body whose middle at rest is inside (empty: all), of a field with one
  /// component, or of a component of stress: xx yy zz xy yz zx [Pa].
  virtual double average(std::string const& field, int body,
                         std::function<bool(double, double, double)> const& inside) const = 0;
  virtual std::array<Vec3, 2> bounds(int body) const = 0;      // least and largest coordinates now [m]
  virtual double extreme(std::string const& field) const = 0;  // largest value of an output field now
  virtual std::optional<double> latest(std::string const& measure) const = 0;
  virtual std::optional<double> peak(std::string const& measure) const = 0;  // largest so far
  virtual std::optional<double> peak_time(std::string const& measure) const = 0;
  virtual std::optional<double> mean(std::string const& measure, double duration) const = 0;  // over the last [s]
  /// Whether in the last tenth of the time, and the last ten samples, none had more kinetic energy than this share of
  /// the most there was.
  virtual bool at_rest(double share) const = 0;
};

struct Measure {
  std::string name, unit;
  Source source;
  std::function<double(Now const&)> value;
};

/// What scripts/study varies and asks where its command line says nothing: words of that.
struct Study {
  std::vector<std::string> vary;
  std::string measure, of = "peak", reference = "finest";
  double tolerance = 1;
};
// measure over "time" or another measure
struct Plot {
  std::string name, against;
  Source source;
};

struct Output {
  double every = 0;                 // [s]; 0: first and last frame only
  double measure_every = 0;         // [s]; 0: a thousandth of the run
  double checkpoint_every = 0;      // [s]; 0: only at the end and on Ctrl-C
  std::vector<std::string> fields;  // see output_fields()
};

/// A number that the finished run must show: |value - number| <= tolerance, or least <= value <= most.
struct Expect {
  std::string name;
  Source source;
  double least = 0, most = 0;
  std::function<double(Now const&)> value;
  std::string why;  // where the number comes from
};

// ------------------------------------------------------------------------------------------------------------- scene
struct Run {
  double time = 0;                       // [s]
  std::optional<double> dt;              // [s]; absent: automatic
  double safety = 0.8;                   // share of the stable step
  std::function<bool(Now const&)> stop;  // empty: run to the end
  double mass_damping = 0;               // alpha of c = alpha m [1/s]
  double mass_scaling = 1;               // factor on every inertia (slow loading only); weights stay
  // share of the ledger's largest term or of the energy turned over; from it on the exit status is 1
  double allowed_residual = 0.05;
  bool remove_crushed = false;  // lone cells that are pressed flat leave the run; else they stop it
  Source source;
};

// before the start: bodies come to rest under what acts on them at t = 0, and nothing that is driven moves
struct Settling {
  Source source;
  std::optional<double> time, damping;  // [s]; alpha of the damping force alpha m v [1/s]; absent: from size and waves
};

struct ScriptParameter {
  std::string name, help;
  double value = 0, fallback = 0;
  std::optional<double> least, most;
  Source source;
};

struct Scene {
  std::string file;
  std::string text;  // the script, for the run's record
  // what it requires, by name; those of the built-in library have no file
  struct Module {
    std::string text, file;
  };
  std::map<std::string, Module> modules;
  std::string two_d = "plane strain";  // or "plane stress", "axisymmetric" (revolution about y)
  std::vector<ScriptParameter> parameters;
  std::vector<Material> materials;
  std::vector<Body> bodies;
  std::vector<JointSet> joint_sets;
  std::vector<Bond> bonds;
  std::vector<Tie> ties;
  std::vector<Plate> plates;
  std::vector<Wall> walls;
  std::vector<Hold> holds;
  std::vector<Traction> tractions;
  std::vector<Pressure> pressures;
  std::vector<Spring> springs;
  std::vector<Force> forces;
  std::vector<BodyForce> body_forces;
  std::vector<Excavation> excavations;
  std::vector<Absorb> absorbers;
  std::array<double, 3> gravity{0, 0, 0};  // [m/s^2]
  std::optional<Settling> settling;
  // assume{ contact = false }: nothing touches but plates and walls
  bool contact = true;
  double out_of_plane = 1;  // thickness of a 2D model [m], so that forces compare with 3D
  std::vector<Measure> measures;
  std::vector<Plot> plots;
  std::optional<Study> study;
  Output output;
  std::vector<Expect> expects;
  std::vector<std::function<void(Now const&, std::string&)>> finishes;  // adds what the script says of the finished run
  Run run;
  std::vector<std::string> warnings;  // sanity ranges, in the error grammar
  std::shared_ptr<void> keeps_alive;  // the script's interpreter, for the functions above

  /// Gravity over the mass that moves [m/s^2]: mass that scaling adds weighs nothing.
  double weight_per_mass(int c) const { return gravity[c] / run.mass_scaling; }
};

/// Names that output{ fields = } and now.extreme() accept.
inline std::vector<std::string> const& output_fields() {
  static std::vector<std::string> const names{
      "displacement", "velocity", "stress",         "pressure",     "von_mises",   "principal",   "damage",
      "body",         "material", "plastic_strain", "plastic_rate", "temperature", "yield_ratio", "fragment"};
  return names;
}

/// Components of stress in the order in which fields have them.
inline std::vector<std::string> const& stress_components() {
  static std::vector<std::string> const names{"xx", "yy", "zz", "xy", "yz", "zx"};
  return names;
}

/// Names that now.energy() accepts: every term of the ledger, their sum and its residual. [J]
inline std::vector<std::string> const& energy_names() {
  static std::vector<std::string> const names{
      "kinetic",  "elastic", "hourglass", "plastic",   "joint",  "fracture",    "viscous",  "mass_damping", "contact",
      "friction", "gravity", "removed",   "excavated", "spring", "spring_lost", "external", "residual"};
  return names;
}

/// Columns of every history, which no measure may be called: name and unit.
inline std::vector<std::array<std::string, 2>> const& standard_columns() {
  static std::vector<std::array<std::string, 2>> const columns = [] {
    std::vector<std::array<std::string, 2>> list;
    for (auto const& name : energy_names()) list.push_back({"energy " + name, "J"});
    list.push_back({"time step", "s"}), list.push_back({"broken joints", ""});
    return list;
  }();
  return columns;
}

}  // namespace fissure::scene
