// Time per step against the floor of the machine it runs on, for discs of several sizes: not a test, it prints a
// Markdown table. docs/performance.md says how bytes and flops are counted.
//
//   floor = max(bytes of an element-step / triad of the same working set, its flops / rate of arithmetic)
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <numbers>

#include "backend/team.h"
#include "counting.h"
#include "dim.h"
#include "kernels/advance.h"
#include "mesh/mesher.h"
#include "model/model.impl.h"
#include "shapes.h"
#include "solver/simulation.h"

namespace fissure {
namespace {

constexpr int D = FISSURE_D;

/// Least bytes that an element-step moves: with intrinsic joints (u and v of its own corners both ways, coordinates of
/// shared nodes, links) and without (all of shared nodes).
struct LeastBytes {
  double split, shared;
};
LeastBytes least_bytes(int d, std::size_t real) {
  if (d == 3) return real == 8 ? LeastBytes{426, 125} : LeastBytes{226, 70};
  return real == 8 ? LeastBytes{230, 104} : LeastBytes{124, 56};
}

std::vector<int> const three_d{10'000, 25'000, 130'000, 620'000}, two_d{14'000, 41'000};

struct Options {
  std::vector<int> sizes = D == 3 ? three_d : two_d;
  std::vector<int> threads = {1, 2};
  std::vector<std::string> precisions = {"double", "single"};
  int gmsh = 130'000;
  int contact = 130'000;
  double seconds = 1;
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Median time [s] of what `run` does, over `seconds`, five times at least.
template <class F>
double median_time(double seconds, F&& run) {
  std::vector<double> times;
  run();
  for (double const start = now(); times.size() < 5 || now() - start < seconds;) {
    double const before = now();
    run();
    times.push_back(now() - before);
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}

/// a = b + s c over arrays of `bytes` altogether [B/s], 24 bytes each time (what is read before it is overwritten does
/// not count, as in STREAM: McCalpin, IEEE TCCA Newsletter, 1995).
double triad(Device& device, double bytes, double seconds) {
  Index const n = static_cast<Index>(bytes / 24) / 64 * 64;
  Buffer<double> a(device, "triad", n), b(device, "triad", n), c(device, "triad", n);
  double* const x = a.data();
  double const *const y = b.data(), *const z = c.data();
  double const time = median_time(seconds, [&] {
    cpu::Team::get().run(device.threads(), n, [&](Index from, Index to) {
      for (Index i = from; i < to; ++i) x[i] = y[i] + 3.0 * z[i];
    });
  });
  return 24.0 * n / time;
}

/// Multiplications and additions of independent packs, in equal numbers and not fused [1/s].
template <class Real>
double arithmetic(Device& device, double seconds) {
  using S = Pack<Real>;
  constexpr int chains = 12, rounds = 20'000;
  std::vector<double> sinks(device.threads(), 0);
  double const time = median_time(seconds, [&] {
    cpu::Team::get().run(device.threads(), device.threads(), [&](Index from, Index to) {
      for (Index me = from; me < to; ++me) {
        S x[chains];
        for (int k = 0; k < chains; ++k) x[k] = S(static_cast<Real>(k));
        S const factor = as<S>(0.999), term = as<S>(0.001);
        for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 12
          for (int k = 0; k < chains; ++k) x[k] = x[k] * factor + term;
        for (int k = 0; k < chains; ++k) add_lanes(x[k], sinks[me]);
      }
    });
  });
  double const flops = 2.0 * chains * rounds * lane_width<S> * device.threads();
  return sinks[0] < 0 ? 0 : flops / time;
}

scene::Scene disc(int cells, bool joints, bool contact, bool gmsh) {
  scene::Scene scene;
  scene::Material rock;
  rock.name = "rock";
  rock.density = 2700;
  laws::Munjiza elastic;
  elastic.young = 50e9;
  elastic.poisson = 0.25;
  rock.bulk = elastic;
  laws::CohesiveJoint joint;
  joint.tension = 3e6;
  joint.shear = 15e6;
  joint.friction_angle = 0.5;
  joint.G1 = joint.G2 = 50;
  joint.penalty = 10 * elastic.young;
  if (joints) rock.joint = joint;
  scene.materials.push_back(rock);
  scene::Body body;
  body.name = "disc";
  body.material = 0;
  double const radius = 25e-3, thickness = 25e-3;
  if (gmsh) {
    double const measure = std::numbers::pi * radius * radius * (D == 3 ? thickness : 1);
    body.shape.is = scene::Disc{Vec3(0, 0, 0), radius, thickness};
    mesh::Mesher const& mesher = FISSURE_MESHER();
    body.mesh.size = std::pow(mesher.cells_per_size() * measure / cells, 1.0 / D);
  } else {  // Gmsh takes minutes for so many: a box of as many cells
    body.shape.is = scene::Box{Vec3(0, 0, 0), Vec3(2 * radius, 2 * radius, D == 3 ? 2 * radius : 0)};
    body.mesh.structured = true;
    body.mesh.size = 2 * radius / std::round(std::pow(cells / (D == 3 ? 6.0 : 2.0), 1.0 / D));
  }
  scene.bodies.push_back(body);
  scene.contact = contact;
  if (contact)
    for (int side : {-1, 1}) {
      scene::Plate plate;
      plate.name = side < 0 ? "bottom" : "top";
      plate.box = {Vec3(0, side * 1.2 * radius, 0), Vec3(2 * radius, 0.4 * radius, 2 * thickness)};
      plate.velocity[1] = scene::TimeFunction{-0.05 * side, {}};
      scene.plates.push_back(plate);
    }
  scene.run.time = 1;
  return scene;
}

/// Small random displacements: every joint carries something, none softens.
template <class Real>
void shake(model::Model<D, Real>& model) {
  auto u = model.vertices.u.download();
  std::uint64_t random = 88172645463325252ull;
  for (auto& x : u) {
    random ^= random << 13, random ^= random >> 7, random ^= random << 17;
    x = static_cast<Real>((static_cast<double>(random >> 11) / (1ull << 53) - 0.5) * 1e-10);
  }
  model.vertices.u.upload(u);
}

template <class Real, class Joint>
auto element_kernel(model::Model<D, Real>& model, scene::Scene const& scene) {
  kernels::ElementForces<D, Real, laws::Munjiza, Joint> kernel;
  kernel.mesh = model.view();
  kernel.bulk = std::get<laws::Munjiza>(scene.materials[0].bulk);
  if constexpr (kernel.jointed) {
    kernel.joints = model.joint_view(model.groups[0]);
    kernel.joint.memory = model.joint_memory();
    kernel.joint.law = std::get<Joint>(*scene.materials[0].joint);
    kernel.joint.law.prepare();
  }
  kernel.force = model.element_force(model.groups[0]);
  kernel.fault = model.flags.data();
  return kernel;
}

template <class Real>
kernels::Advance<D, Real> advance_kernel(model::Model<D, Real>& model) {
  double const dt = 1e-15;
  return {{model.vertices.u.data(),
           model.vertices.v.data(),
           model.vertex_force(),
           model.vertices.inverse_mass.data(),
           {},
           dt,
           dt,
           0},
          false};
}

template <class Real, class Joint>
Counted count(model::Model<D, Real>& model, scene::Scene const& scene) {
  using S = Counting<Real>;
  auto const kernel = element_kernel<Real, Joint>(model, scene);
  auto const advance = advance_kernel(model);
  S::counted = {};
  kernel.template operator()<S>(model.elements.count / 2);
  double const vertices_per_cell = static_cast<double>(model.vertices.count) / model.elements.count;
  Counted total = S::counted;
  S::counted = {};
  advance.template operator()<S>(0);
  total.flops += std::lround(vertices_per_cell * static_cast<double>(S::counted.flops));
  return total;
}

template <class Real, class Joint>
void row(Options const& options, int size, int threads) {
  constexpr bool jointed = !std::is_same_v<Joint, void>;
  constexpr Precision precision = sizeof(Real) == 8 ? Precision::double_ : Precision::single;
  Device device = Device::select("cpu", threads);
  bool const gmsh = size <= options.gmsh;
  auto const scene = disc(size, jointed, false, gmsh);
  auto const mesh = mesh::make_mesh(scene, FISSURE_MESHER());
  model::Model<D, Real> model(device, scene, mesh);
  shake(model);
  double const n = mesh.n_cells();
  double const memory = static_cast<double>(device.bytes()) / n;
  auto const least = least_bytes(D, sizeof(Real));
  double const bytes = jointed ? least.split : least.shared;
  Counted const counted = count<Real, Joint>(model, scene);

  auto const all = element_kernel<Real, Joint>(model, scene);
  auto const bulk = element_kernel<Real, void>(model, scene);
  auto const advance = advance_kernel(model);
  kernels::SumCorners<D, Real> const sum{model.corner_force(), model.slots.first.data(), model.slots.list.data(),
                                         model.vertex_force()};
  double t_bulk = 0, t_elements = 0, t_advance = 0;
  std::vector<double> per_step;
  {
    std::vector<double> a, b, c;
    auto const timed = [&](std::vector<double>& times, auto&& run) {
      double const before = now();
      run();
      times.push_back((now() - before) / n * 1e9);
    };
    for (double const start = now(); a.size() < 5 || now() - start < options.seconds;) {
      timed(a, [&] { for_each(device, 0, model.elements.count, bulk); });
      timed(b, [&] {
        for_each(device, 0, model.elements.count, all);
        if (model.plan.shared) for_each(device, 0, model.vertices.count, sum);
      });
      timed(c, [&] { for_each(device, 0, model.vertices.count, advance); });
      per_step.push_back(b.back() + c.back());
    }
    auto const median = [](std::vector<double>& times) {
      std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
      return times[times.size() / 2];
    };
    t_bulk = median(a), t_elements = median(b), t_advance = median(c);
  }
  auto const middle = per_step.begin() + per_step.size() / 2;
  std::nth_element(per_step.begin(), middle, per_step.end());

  std::string contact = "-";
  if (jointed && size <= options.contact) {
    auto const touching = disc(size, true, true, gmsh);
    auto const simulation = make_simulation<D>(device, touching, mesh, precision);
    auto const step = [&] { simulation->evaluate(), simulation->advance(); };
    for (int i = 0; i < 3; ++i) step();
    simulation->time_stages = true;
    int steps = 0;
    for (double const start = now(); steps < 5 || now() - start < options.seconds; ++steps) step();
    contact = fmt::format("{:.1f}", simulation->stage_times.contact / steps / n * 1e9);
  }
  double const rate = triad(device, memory * n, 0.2 * options.seconds);
  double const peak = arithmetic<Real>(device, 0.2 * options.seconds);
  double const floor = std::max(bytes / rate, static_cast<double>(counted.flops) / peak) * 1e9;
  fmt::print("| {} | {}{} | {} | {} ", mesh.n_cells(), gmsh ? "disc" : "box", jointed ? "" : ", no joints",
             precision == Precision::double_ ? "double" : "single", threads);
  fmt::print("| {:.3f} | {:.1f} | {:.1f} | {:.1f} | {} | {:.1f} ", *middle * n * 1e-6, *middle, t_bulk,
             t_elements - t_bulk, contact, t_advance);
  fmt::print("| {:.0f} | {} + {} + {} | {:.1f} | {:.0f} | {:.1f} | {:.2f} |\n", memory, counted.flops,
             counted.divisions, counted.roots, rate * 1e-9, peak * 1e-9, floor, *middle / floor);
  std::fflush(stdout);
}

void run(Options const& options) {
  std::vector<std::string> const columns{"cells",
                                         "mesh",
                                         "precision",
                                         "threads",
                                         "ms per step",
                                         "ns per cell and step",
                                         "bulk",
                                         "joints or sum of corners",
                                         "contact",
                                         "advance",
                                         "memory [B/cell]",
                                         "flops + divisions + roots",
                                         "triad [GB/s]",
                                         "arithmetic [Gflop/s]",
                                         "floor [ns]",
                                         "ratio"};
  fmt::print("| {} |\n", fmt::join(columns, " | "));
  for (std::size_t i = 0; i < columns.size(); ++i) fmt::print("|---");
  fmt::print("|\n");
  for (int size : options.sizes)
    for (auto const& precision : options.precisions)
      for (int threads : options.threads) {
        if (precision == "double") {
          row<double, laws::CohesiveJoint>(options, size, threads);
          row<double, void>(options, size, threads);
        } else {
          row<float, laws::CohesiveJoint>(options, size, threads);
          row<float, void>(options, size, threads);
        }
      }
}

}  // namespace
}  // namespace fissure

int main(int argc, char** argv) {
  fissure::Options options;
  CLI::App app("Time per step of a disc, with what the machine could do at best");
  app.add_option("--sizes", options.sizes, "numbers of cells wanted");
  app.add_option("--threads", options.threads, "numbers of threads");
  app.add_option("--precision", options.precisions, "double, single")->check(CLI::IsMember({"double", "single"}));
  app.add_option("--gmsh", options.gmsh, "above so many cells a structured box stands for the disc");
  app.add_option("--contact", options.contact, "above so many cells contact is not timed (set-up takes long)");
  app.add_option("--seconds", options.seconds, "for each measurement");
  CLI11_PARSE(app, argc, argv);
  try {
    fissure::run(options);
  } catch (std::exception const& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
