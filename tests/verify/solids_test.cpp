// Ladder A6 and A7: a cantilever, a thick cylinder, a hole in a plate.
#include <Eigen/Dense>

#include "rig.h"

namespace fissure::verify {
namespace {

double const pi = std::numbers::pi;

// ------------------------------------------------------------------------------------------------- A6, cantilever
double const length = 1, depth = 0.05, load = 1000;  // square section; x along the beam, it bends in y [m, N]

/// `n` cells over the depth and as many per length along the beam; in 3D `across` cells over half the width.
struct Cells {
  int n, across;
};

/// The whole beam, or its quarter y > 0, z > 0: bending leaves the middle plane y = 0 unstretched (u_x = u_z = 0) and
/// is even in z. The quarter bends exactly as its mirror images together, as long as the axis does not shorten: its
/// deflections must be small.
void set_cantilever(Rig<>& rig, Cells cells, std::string const& two_d, bool whole) {
  double const h = depth / cells.n, half = depth / 2;
  rig.scene.two_d = two_d;
  rig.scene.out_of_plane = depth;
  rig.add_material(material(steel));
  Vec3 const size(length, whole ? depth : half, (whole ? 2 : 1) * cells.across * h);
  rig.add_box({length / 2, whole ? 0 : half / 2, 0}, size, h);
  for (auto& x : rig.make().nodes) {
    if (flat) break;
    x[2] *= half / (cells.across * h);  // to the beam's width
    if (!whole) x[2] += half / 2;
  }
  rig.hold(0, place("left"), still());
  if (whole) return;
  rig.roller(0, "bottom", 0), rig.roller(0, "bottom", 2);
  rig.roller(0, "back", 2);
}

/// Richardson's limit and order of three grids: f = limit + c/n^order.
std::pair<double, double> limit_of(std::vector<Cells> const& meshes, std::vector<double> const& f) {
  auto const per = [&](int k, double order) { return std::pow(meshes[k].n, -order); };
  double low = 0.1, high = 6;  // (f0 - f1)/(f1 - f2) grows with the order
  while (high - low > 1e-9) {
    double const p = (low + high) / 2;
    ((per(0, p) - per(1, p)) / (per(1, p) - per(2, p)) < (f[0] - f[1]) / (f[1] - f[2]) ? low : high) = p;
  }
  return {f[2] - (f[1] - f[2]) / (per(1, low) - per(2, low)) * per(2, low), low};
}

/// Eigenvalue k L of mode 1, 2, 3 of a slender cantilever, 1 + cosh cos = 0.
double slender_root(int mode) { return std::array{1.8751040687, 4.6940911330, 7.8547574382}[mode - 1]; }

/// Deflection and slope of that mode at x.
std::array<double, 2> mode_shape(int mode, double x) {
  double const kL = slender_root(mode), k = kL / length, z = k * x;
  double const s = (std::cosh(kL) + std::cos(kL)) / (std::sinh(kL) + std::sin(kL));
  return {std::cosh(z) - std::cos(z) - s * (std::sinh(z) - std::sin(z)),
          k * (std::sinh(z) + std::sin(z) - s * (std::cosh(z) - std::cos(z)))};
}

/// Frequency of Timoshenko's beam, with shear and rotatory inertia (T. C. Huang, J. Appl. Mech. 28, 1961, 579-584),
/// or of the slender one without them, which is what the page's numbers are [Hz].
double beam_frequency(int mode, bool plane_strain, bool slender) {
  double const E = plane_strain ? steel.young / (1 - steel.poisson * steel.poisson) : steel.young;
  double const radius = depth * depth / (12 * length * length);         // I/(A L^2) [-]
  double const per_b = std::sqrt(E / steel.density * radius) / length;  // omega = b per_b [1/s]
  double const r = slender ? 0 : radius, s = slender ? 0 : radius * E / (5.0 / 6 * steel.shear());
  auto const residual = [&](double b) {
    double const q = std::sqrt((r - s) * (r - s) + 4 / (b * b));
    double const alpha = std::sqrt((q - r - s) / 2), beta = std::sqrt((q + r + s) / 2);
    return 2 + (b * b * (r - s) * (r - s) + 2) * std::cosh(b * alpha) * std::cos(b * beta) -
           b * (r + s) / std::sqrt(1 - b * b * r * s) * std::sinh(b * alpha) * std::sin(b * beta);
  };
  double high = std::pow(slender_root(mode), 2) * (1 + 1e-6), low = 0.9 * high;
  while (high - low > 1e-12 * high) {
    double const middle = (low + high) / 2;
    ((residual(low) > 0) == (residual(middle) > 0) ? low : high) = middle;
  }
  return low * per_b / (2 * pi);
}

/// A mode's share of a motion: the sum of m phi . v over the vertices, which leaves out the other modes.
class ModeShare {
 public:
  ModeShare(Rig<> const& rig, int mode) : weight_(rig.solver->model().vertices.mass.size(), V::Zero()) {
    rig.each_corner([&](Index, int, Index vertex) {
      V const x = rig.place_of(vertex);
      auto const [deflection, slope] = mode_shape(mode, x[0]);
      weight_[vertex][0] = -x[1] * slope * rig.solver->model().vertices.mass[vertex];
      weight_[vertex][1] = deflection * rig.solver->model().vertices.mass[vertex];
    });
  }
  double of(Buffer<double> const& motion) {
    auto const v = motion.look(copy_);
    double sum = 0;
    for (std::size_t i = 0; i < weight_.size(); ++i)
      for (int c = 0; c < 2; ++c) sum += weight_[i][c] * v[i * D + c];
    return sum;
  }

 private:
  std::vector<V> weight_;
  std::vector<double> copy_;
};

/// Steps on until a mode's velocity passes through zero and says when [s]; calls each() after every step.
template <class F>
double time_of_standstill(Rig<>& rig, int mode, F&& each) {
  ModeShare share(rig, mode);
  double before = 0, t_before = 0;
  while (true) {
    for (int k = 0; k < 8; ++k) rig.step(), each();
    double const now = share.of(rig.solver->model().vertices.v);
    double const t = rig.solver->time() - 0.5 * rig.solver->dt();  // where leapfrog keeps velocities
    if (before * now < 0) return t_before + (t - t_before) * before / (before - now);
    before = now, t_before = t;
  }
}

/// Set off with the velocities of a mode, the straight beam stands still after a quarter of the mode's period. [Hz]
double measured_frequency(Cells cells, std::string const& two_d, int mode, bool whole = flat) {
  Rig<> rig;
  set_cantilever(rig, cells, two_d, whole);
  rig.scene.bodies[0].velocity_at = [mode](double x, double y, double) -> std::array<double, 3> {
    auto const [deflection, slope] = mode_shape(mode, x);
    return {-1e-3 * y * slope, 1e-3 * deflection, 0};  // it moves by micrometres
  };
  rig.start();
  return 1 / (4 * time_of_standstill(rig, mode, [] {}));
}

/// The page's frequencies are those of a slender beam. A solid of this depth has Timoshenko's, lower by 0.2, 1.4 and
/// 3.1 %: it is these that a body can be asked to reach within 1 %, and the page's own for the first mode. That grids
/// close in on them and on no others is asked of their limit (in 2D, where cells are halved in every direction).
TEST(Verify, A6_CantileverFrequencies) {
  double const page[2][3] = {{41.519, 260.20, 728.56}, {43.384, 271.88, 761.27}};
  std::vector<Cells> const meshes{{4, 1}, {8, 2}, {16, 3}};
  bool const blocks = test_cells()[0] == "block";
  for (int strain = 0; strain < (flat ? 2 : 1); ++strain)
    for (int mode = 1; mode <= 3; ++mode) {
      double const exact = beam_frequency(mode, strain, false), slender = page[strain][mode - 1];
      EXPECT_NEAR(beam_frequency(mode, strain, true) / slender, 1, 2e-5);
      std::vector<double> f;
      for (auto const& cells : meshes) {
        f.push_back(measured_frequency(cells, strain ? "plane strain" : "plane stress", mode));
        std::printf("%smode %d, %2d cells: %.3f Hz, %+.2f %% of %.3f, %+.2f %% of the page's %.2f\n",
                    !flat    ? ""
                    : strain ? "plane strain, "
                             : "plane stress, ",
                    mode, cells.n, f.back(), 100 * (f.back() / exact - 1), exact, 100 * (f.back() / slender - 1),
                    slender);
        if (blocks) {  // of one point: their springs are a quarter as stiff as bending, so they come from below
          EXPECT_LT(f.back(), exact * (1 + 3e-3));
        } else {
          EXPECT_GT(f.back(), exact);
        }
        if (f.size() > 1) {
          EXPECT_LT(std::abs(f.back() - exact), std::abs(f[f.size() - 2] - exact));
        }
      }
      EXPECT_NEAR(f.back() / exact, 1, 0.01);
      if (mode == 1) {
        EXPECT_NEAR(f.back() / slender, 1, 0.01);
      }
      if (!flat) continue;
      auto const [limit, order] = limit_of(meshes, f);
      std::printf("  order %.2f, limit %.3f Hz, %+.2f %%\n", order, limit, 100 * (limit / exact - 1));
      EXPECT_NEAR(limit / exact, 1, 3e-3);
    }
  if (flat) return;
  double const quarter = measured_frequency({4, 2}, "", 1), whole = measured_frequency({4, 2}, "", 1, true);
  std::printf("quarter of the beam %.6f Hz, whole beam %.6f Hz\n", quarter, whole);
  EXPECT_NEAR(quarter / whole, 1, 3e-4);  // what is left of other modes moves the standstill by 1e-4
}

/// Deflection of the tip under the end load [m]. The load comes at once, the beam swings about its new place, and the
/// mean from rest to rest of the first mode is that place; the second mode, 2.5 % of the deflection, leaves -0.07 %.
double tip_deflection(Cells cells, bool whole = flat, std::string const& cell_name = "simplex",
                      std::string const& integration = "one_point") {
  double const share = flat ? 1 : 0.01;  // of the load, for the quarter; what comes out is linear
  Rig<> rig;
  rig.cell_name = cell_name, rig.integration = integration;
  set_cantilever(rig, cells, "plane stress", whole);
  rig.pull(0, place("right"), along(1, constant(share * load / (depth * depth))));
  rig.start();
  Index tip = 0;
  double nearest = length;
  rig.each_corner([&](Index, int, Index vertex) {
    V const x = rig.place_of(vertex);
    double const distance = std::hypot(x[0] - length, x[1], flat ? 0 : x[D - 1]);
    if (distance < nearest) nearest = distance, tip = vertex;
  });
  std::vector<std::pair<double, double>> record;
  double const half = time_of_standstill(rig, 1, [&] {
    record.push_back({rig.solver->time(), rig.solver->model().vertices.u.download_one(std::size_t(tip) * D + 1)});
  });
  double sum = 0, until = 0;
  for (auto const& [t, u] : record)
    if (t <= half) sum += (t - until) * u, until = t;
  return sum / until / share;
}

/// Grids are too stiff. In 3D one that reaches 1 % would take many minutes (12 cells are 2.3 % off): there it is the
/// limit of three grids, with the order that they show, that must.
TEST(Verify, A6_CantileverTipDeflection) {
  double const exact = 3.0993e-3;
  std::vector<Cells> meshes{{5, 1}, {10, 1}, {20, 1}};
  if (!flat) meshes = {{4, 1}, {8, 2}, {12, 3}};
  std::vector<double> u;
  for (auto const& cells : meshes) {
    u.push_back(tip_deflection(cells));
    std::printf("%2d cells: %.5f mm, %+.2f %%\n", cells.n, u.back() / mm, 100 * (u.back() / exact - 1));
    EXPECT_LT(u.back(), exact);
    if (u.size() > 1) {
      EXPECT_GT(u.back(), u[u.size() - 2]);
    }
  }
  auto const [limit, order] = limit_of(meshes, u);
  std::printf("order %.2f, limit %.5f mm, %+.2f %%\n", order, limit / mm, 100 * (limit / exact - 1));
  EXPECT_NEAR(order, 2, 0.5);
  EXPECT_NEAR(limit / exact, 1, 0.01);
  if (flat) {
    EXPECT_NEAR(u.back() / exact, 1, 0.01);
  }
}

/// Blocks bend well where simplices are too stiff: four over the depth within 5 %, a single one with assumed strains
/// within 10 %. Fully integrated blocks that are one thick lock in shear.
TEST(Verify, F_BendingOfABeamOfBlocks) {
  double const exact = 3.0993e-3;
  auto const ratio = [&](int n, char const* integration) {
    double const u = tip_deflection({n, std::max(1, n / 2)}, true, "block", integration);
    std::printf("%d over the depth, %s: %.4f of the deflection\n", n, integration, u / exact);
    return u / exact;
  };
  for (char const* integration : {"one_point", "assumed_strain", "full"})
    EXPECT_NEAR(ratio(4, integration), 1, 0.05) << integration;
  EXPECT_NEAR(ratio(1, "assumed_strain"), 1, 0.1);
  EXPECT_LT(ratio(1, "full"), 0.8);
}

// ------------------------------------------------------------------------------------------- A7, cylinder and hole
/// Coefficients of `terms(x)` that come closest to values: least squares.
template <int N>
struct Fit {
  Eigen::Matrix<double, N, N> normal = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> right = Eigen::Matrix<double, N, 1>::Zero();
  using Terms = Eigen::Matrix<double, N, 1>;

  void add(Terms const& terms, double value) { normal += terms * terms.transpose(), right += value * terms; }
  double at(Terms const& terms) const { return terms.dot(normal.ldlt().solve(right).eval()); }
};

/// A quarter of a body about the z axis, in plane strain: a grid of `rows` from the inside out by `sectors`, one cell
/// thick in 3D, whose node at (share of the rows, angle) comes to lie at radius(share, angle). "left" is its inner
/// face.
struct Quarter {
  Rig<> rig;
  std::vector<int> grid_cell;  // by cell of the mesh

  template <class F>
  Quarter(int rows, int sectors, double thickness, F&& radius) {
    rig.add_material(material(steel));
    rig.add_box({rows / 2.0, sectors / 2.0, 0.5}, {1.0 * rows, 1.0 * sectors, 1}, 1);
    auto& mesh = rig.make();
    for (int k = 0; k < mesh.n_cells(); ++k) {
      Vec3 middle(0, 0, 0);
      for (int a = 0; a < C; ++a) middle += mesh.nodes[mesh.cells[k * C + a]] / C;
      grid_cell.push_back(static_cast<int>(middle[0]) * sectors + static_cast<int>(middle[1]));
    }
    for (auto& x : mesh.nodes) {
      double const angle = pi / 2 * x[1] / sectors, r = radius(x[0] / rows, angle);
      x = {r * std::cos(angle), r * std::sin(angle), thickness * x[2]};
    }
    rig.roller(0, "bottom", 1), rig.roller(0, "top", 0);
    rig.roller(0, "back", 2), rig.roller(0, "front", 2);
  }

  /// Calls f(r, angle, hoop stress) for each cell of the grid: the mean of its simplices at their mean centroid. One
  /// simplex has the hoop strain of its edge along the row, not of its centroid.
  template <class F>
  void each_hoop_stress(F&& f) {
    auto const stress = rig.stresses();
    std::vector<std::array<double, 4>> sums(grid_cell.size(), {0, 0, 0, 0});
    auto& model = rig.solver->model();
    for (Index e = 0; e < model.elements.count; ++e) {
      if (model.elements.cell[e] < 0) continue;
      V const x = rig.centroid(e);
      double const r = std::hypot(x[0], x[1]), c = x[0] / r, s = x[1] / r;
      double const hoop = s * s * stress[e][0] + c * c * stress[e][1] - 2 * s * c * stress[e][3];
      auto& sum = sums[grid_cell[model.elements.cell[e]]];
      sum[0] += r, sum[1] += std::atan2(x[1], x[0]), sum[2] += hoop, sum[3] += 1;
    }
    for (auto const& sum : sums)
      if (sum[3] > 0) f(sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]);
  }
};

/// Strains of 8e-4 at the full load: what both laws add to the linear answer is of their order, far below 2 %.
TEST(Verify, A7_ThickCylinder) {
  double const a = 0.1, b = 0.2, hoop_a = 166.667 * MPa, hoop_b = 66.667 * MPa, u_a = 9.18608e-5;
  std::array<double, 3> error{1, 1, 1};
  for (int rows : {10, 20}) {
    Quarter quarter(rows, 2 * rows, (b - a) / rows, [&](double s, double) { return a + (b - a) * s; });
    auto& rig = quarter.rig;
    rig.press(0, place("left"), constant(100 * MPa));
    rig.come_to_rest(pi / 2 * (a + b) / 2, steel.bar(), 6);  // breathing has the wave that goes once around
    double u = 0;
    int n = 0;
    auto const moved = rig.displacements();
    rig.each_corner([&](Index, int, Index vertex) {
      V const x = rig.place_of(vertex);
      double const r = std::hypot(x[0], x[1]);
      if (r < a * (1 + 1e-9)) u += (x[0] * moved[vertex][0] + x[1] * moved[vertex][1]) / r, ++n;
    });
    u /= n;
    // To the surfaces by Lame's form, from the third of the wall next to each.
    Fit<2> inner, outer;
    quarter.each_hoop_stress([&](double r, double, double hoop) {
      auto& fit = r < a + (b - a) / 2 ? inner : outer;
      if (std::abs(r - (a + b) / 2) > (b - a) / 6) fit.add({1, a * a / (r * r)}, hoop);
    });
    double const at_a = inner.at({1, 1}), at_b = outer.at({1, a * a / (b * b)});
    std::array<double, 3> const now{at_a / hoop_a - 1, at_b / hoop_b - 1, u / u_a - 1};
    std::printf("%d rows: hoop %.3f MPa (%+.2f %%) inside, %.3f MPa (%+.2f %%) outside, u %.3f um (%+.2f %%)\n", rows,
                at_a / MPa, 100 * now[0], at_b / MPa, 100 * now[1], u / 1e-6, 100 * now[2]);
    for (int k = 0; k < 3; ++k) {
      // the strains' own size: what both laws add to the linear answer
      EXPECT_LT(std::abs(now[k]), std::max(error[k], 1e-3));
      error[k] = std::abs(now[k]);
    }
  }
  for (double e : error) EXPECT_LT(e, 0.02);
}

/// Stress at a hole's edge where it is largest, over the stress that pulls far away in y; `biaxiality` times that
/// pulls in x. Cells are as long as radius/per_radius at the hole.
double hole_factor(int per_radius, double biaxiality) {
  // A square of 40 a is less than endless: its factor is 0.7 % larger, that of a square of 80 a 0.2 %.
  double const a = 10 * mm, W = 20 * a, S = 10 * MPa;
  int const sectors = 2 * static_cast<int>(std::lround(pi / 4 * per_radius)), rows = 2 * sectors;
  // Every row is longer than the one before by the same factor, so that cells stay about as long as wide.
  double const growth = std::pow(W / a, 1.0 / rows);
  Quarter quarter(rows, sectors, a / per_radius, [&](double s, double angle) {
    double const end = W / std::max(std::cos(angle), std::sin(angle));
    return a + (end - a) * (std::pow(growth, s * rows) - 1) / (std::pow(growth, rows) - 1);
  });
  auto& rig = quarter.rig;
  rig.pull(0, where([W](double, double y, double) { return y > W * (1 - 1e-9); }), along(1, constant(S)));
  rig.pull(0, where([W](double x, double, double) { return x > W * (1 - 1e-9); }), along(0, constant(biaxiality * S)));
  rig.come_to_rest(W, steel.bar(), 8);
  // To the edge of the hole by the form of a stress with this symmetry (Kirsch's with free coefficients).
  Fit<4> fit;
  quarter.each_hoop_stress([&](double r, double angle, double hoop) {
    double const q = a * a / (r * r), c = std::cos(2 * angle);
    if (r < 1.5 * a) fit.add({1, q, c, q * q * c}, hoop);
  });
  return fit.at({1, 1, 1, 1}) / S;
}

TEST(Verify, A7_HoleInAPlate) {
  for (auto const& [biaxiality, factor] : {std::pair{0.0, 3.0}, {0.5, 2.5}}) {
    double k = 0;
    for (int per_radius : {5, 10}) {
      k = hole_factor(per_radius, biaxiality);
      std::printf("biaxiality %g, h = a/%d: %.4f (%+.2f %%)\n", biaxiality, per_radius, k, 100 * (k / factor - 1));
    }
    EXPECT_NEAR(k / factor, 1, 0.02);
  }
}

#if FISSURE_D == 2
/// A strip that is pulled to twice its length and free across: force over the present area, thickness included.
TEST(Verify, F_StressInPlaneStressIsForceOverPresentArea) {
  double const pulled = 2, mu = rock.shear(), lambda = rock.confined() - 2 * mu;
  double low = 0.3, high = 1;  // of the stretch across, where mu (a^2 - 1) + lambda (J - 1) J = 0
  while (high - low > 1e-15) {
    double const a = 0.5 * (low + high), J = pulled * a * a;
    (mu * (a * a - 1) + lambda * (J - 1) * J > 0 ? high : low) = a;
  }
  double const J = pulled * low * low, stress = (mu * (pulled * pulled - 1) + lambda * (J - 1) * J) / J;
  for (char const* way : {"one_point", "full", "b_bar"}) {
    Rig<> rig;
    rig.scene.two_d = "plane stress", rig.integration = way;
    rig.add_material(material<laws::NeoHookean>(rock));
    rig.add_box({0, 0, 0}, {0.02, 0.01, 0}, 0.005);
    rig.start();
    Mat<double, D> F = Mat<double, D>::Identity() * low;
    F(0, 0) = pulled;
    F = (turn(1.9) * F).eval();
    rig.displace([&](Index, int, V const& x) { return V(F * x - x); });
    V const along = turn(1.9).col(0);
    for (auto const& s : rig.stresses()) {
      if (s[0] == 0 && s[1] == 0) continue;  // padding
      EXPECT_NEAR(along[0] * along[0] * s[0] + along[1] * along[1] * s[1] + 2 * along[0] * along[1] * s[3], stress,
                  1e-9 * stress)
          << way;
      EXPECT_NEAR(s[0] + s[1], stress, 1e-9 * stress) << way;
    }
  }
}
#endif

}  // namespace
}  // namespace fissure::verify
