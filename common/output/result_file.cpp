#include "output/result_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "output/file.h"
#include "output/hdf5.h"

namespace fissure::output {

namespace {

using Integers = std::vector<std::int64_t>;

std::string const mesh_file = "frames/mesh.h5";

std::string frame_file(std::size_t number) { return fmt::format("frames/{:06}.h5", number); }

/// A kind of cell: VTK's number, its corners, XDMF's word and number.
struct CellName {
  int vtk, nodes;
  char const* xdmf;
  int xdmf_number;
};

CellName const& cell_name(int vtk) {
  static CellName const names[] = {{3, 2, "TopologyType=\"Polyline\" NodesPerElement=\"2\"", 2},
                                   {5, 3, "TopologyType=\"Triangle\"", 4},
                                   {9, 4, "TopologyType=\"Quadrilateral\"", 5},
                                   {10, 4, "TopologyType=\"Tetrahedron\"", 6},
                                   {12, 8, "TopologyType=\"Hexahedron\"", 9}};
  for (auto const& name : names)
    if (name.vtk == vtk) return name;
  throw Error(fmt::format("results: no cells of VTK's type {} are written", vtk));
}

int crack_type(Cracks const& cracks) { return cracks.nodes_per_cell == 2 ? 3 : 5; }

void write_cells(h5::Image& image, std::string const& group, std::vector<int> const& types,
                 Integers const& connectivity) {
  Integers offsets{0};
  for (int type : types) offsets.push_back(offsets.back() + cell_name(type).nodes);
  Integers const numbers(types.begin(), types.end());
  image.dataset(group + "/connectivity", {connectivity.size()}, connectivity.data());
  image.dataset(group + "/offsets", {offsets.size()}, offsets.data());
  image.dataset(group + "/types", {numbers.size()}, numbers.data(), H5T_STD_U8LE);
}

/// XDMF tells cells of several kinds apart by a number before the corners of each.
Integers mixed(Topology const& topology) {
  Integers numbers;
  std::size_t next = 0;
  for (int type : topology.types) {
    numbers.push_back(cell_name(type).xdmf_number);
    for (int k = 0; k < cell_name(type).nodes; ++k) numbers.push_back(topology.cells.at(next++));
  }
  return numbers;
}

h5::Shape field_shape(std::size_t values, int components) {
  if (components == 1) return {values};
  return {values / static_cast<std::size_t>(components), static_cast<hsize_t>(components)};
}

h5::Shape row_shape(int components) {
  return components == 1 ? h5::Shape{} : h5::Shape{static_cast<hsize_t>(components)};
}

void write_fields(h5::Image& image, std::string const& group, std::vector<Field> const& fields) {
  image.group(group);
  for (auto const& field : fields) {
    std::string const at = group + "/" + field.name;
    image.dataset(at, field_shape(field.values.size(), field.components), field.values.data(), H5T_IEEE_F32LE);
    image.attribute(at, "unit", field.unit);
  }
}

std::vector<Field> crack_fields(Cracks const& cracks) {
  return {{"damage", "", 1, cracks.damage},
          {"mode", "", 1, cracks.mode},
          {"slip_out_of_plane", "", 1, cracks.slip_out_of_plane},
          {"time_broken", "s", 1, cracks.time},
          {"opening", "m", 1, cracks.opening},
          {"slip", "m", 1, cracks.slip}};
}

/// Readers up to VTK 9.3 and XDMF 2 stumble over a grid without cells: while nothing is broken, one undamaged cell
/// without extent stands for it.
Cracks placeholder(int nodes_per_cell, std::vector<double> const& points) {
  Cracks none{nodes_per_cell, {}, {0}, {0}, {0}, {-1}, {0}, {0}};
  for (int i = 0; i < nodes_per_cell; ++i) none.points.insert(none.points.end(), points.begin(), points.begin() + 3);
  return none;
}

std::string xml(std::string const& text) {
  std::string out;
  for (char const c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

}  // namespace

ResultFile::ResultFile(std::string const& folder, Topology const& topology) : folder_(folder) {
  bool const alike =
      std::all_of(topology.types.begin(), topology.types.end(), [&](int type) { return type == topology.types[0]; });
  bool const flat = !topology.types.empty() && (topology.types[0] == 5 || topology.types[0] == 9);
  std::size_t corners = 0;
  for (int type : topology.types) corners += static_cast<std::size_t>(cell_name(type).nodes);
  if (corners != topology.cells.size())
    throw Error(folder + ": the results' cells and their corners do not fit each other");
  body_ = {"results",
           "/body",
           true,
           alike ? topology.types.at(0) : 0,
           static_cast<std::int64_t>(topology.types.size()),
           static_cast<std::int64_t>(corners),
           {},
           {},
           {},
           {},
           0};
  cracks_ = {"cracks", "/cracks", false, flat ? 3 : 5, 0, 0, {}, {}, {}, {}, 0};
  if (topology.rigid_cells > 0)
    rigid_ = {"rigid",
              "/rigid",
              true,
              topology.rigid_type,
              topology.rigid_cells,
              std::int64_t{topology.rigid_cells} * cell_name(topology.rigid_type).nodes,
              {},
              {},
              {},
              {},
              0};
  for (auto const& field : crack_fields({})) cracks_.cell_fields.push_back({field.name, field.unit, field.components});
}

std::vector<ResultFile::Part*> ResultFile::parts() {
  if (rigid_.cells == 0) return {&body_, &cracks_};
  return {&body_, &cracks_, &rigid_};
}

std::vector<ResultFile::Part const*> ResultFile::parts() const {
  auto const all = const_cast<ResultFile*>(this)->parts();
  return {all.begin(), all.end()};
}

ResultFile ResultFile::create(std::string const& folder, Topology const& topology) {
  ResultFile results(folder, topology);
  std::string const frames = results.path("frames");
  if (::mkdir(frames.c_str(), 0777) != 0 && errno != EEXIST) throw file_error(frames, "created", errno);
  h5::Image image(topology.cells.size() * 16 + (1 << 16));
  write_cells(image, "/body", topology.types, topology.cells);
  if (results.body_.type == 0) {
    Integers const numbers = mixed(topology);
    image.dataset("/body/mixed", {numbers.size()}, numbers.data());
  }
  image.dataset("/body/held", {topology.held.size()}, topology.held.data());
  if (results.rigid_.cells > 0) {
    Integers corners(static_cast<std::size_t>(results.rigid_.ids));
    std::iota(corners.begin(), corners.end(), 0);
    write_cells(image, "/rigid", std::vector<int>(static_cast<std::size_t>(topology.rigid_cells), topology.rigid_type),
                corners);
  }
  write_whole(results.path(mesh_file), image.bytes());
  return results;
}

ResultFile ResultFile::reopen(std::string const& folder, Topology const& topology, double time, int written) {
  ResultFile results(folder, topology);
  h5::Reader const mesh(results.path(mesh_file));
  if (mesh.integers("/body/connectivity") != topology.cells)
    throw Error(results.path(mesh_file) +
                ": is of another mesh than the run that is to go on; choose the folder of that run");

  auto const kinds = [](h5::Reader const& frame, std::string const& group) {
    std::vector<Kind> found;
    for (auto const& name : frame.members(group)) {
      h5::Shape const shape = frame.shape(group + "/" + name);
      found.push_back(
          {name, frame.text(group + "/" + name, "unit"), shape.size() > 1 ? static_cast<int>(shape[1]) : 1});
    }
    return found;
  };
  std::size_t kept = 0;
  for (; std::filesystem::exists(results.path(frame_file(kept))); ++kept) {
    h5::Reader const frame(results.path(frame_file(kept)));
    double const frame_time = frame.number("/", "time");
    if (kept > 0 && !(frame_time > results.body_.frames.back().time))
      throw Error(fmt::format(
          "{}: its time, {:.6g} s, is not after that of the frame before; put the frames in order, then restart",
          results.path(frame_file(kept)), frame_time));
    if (frame_time > time) break;
    if (kept == 0) {
      results.body_.point_fields = kinds(frame, "/body/point");
      results.body_.cell_fields = kinds(frame, "/body/cell");
    }
    auto const rows = [&](std::string const& dataset) { return static_cast<std::int64_t>(frame.shape(dataset).at(0)); };
    results.body_.frames.push_back({frame_time, rows("/body/points"), results.body_.cells});
    results.cracks_.frames.push_back({frame_time, rows("/cracks/points"), rows("/cracks/types")});
    results.rigid_.frames.push_back({frame_time, results.rigid_.ids, results.rigid_.cells});
  }
  for (std::size_t later = kept + 1; later < static_cast<std::size_t>(written); ++later)
    if (!std::filesystem::exists(results.path(frame_file(kept))) &&
        std::filesystem::exists(results.path(frame_file(later))))
      throw Error(results.path(frame_file(kept)) +
                  ": is missing, and later frames are there; put it back (or take them away), then restart");
  std::size_t last = kept;
  while (std::filesystem::exists(results.path(frame_file(last)))) ++last;
  if (kept > 0) {
    results.write_vtkhdf();
    for (auto* part : results.parts()) results.write_xdmf(*part);
  }
  while (last-- > kept) ::unlink(results.path(frame_file(last)).c_str());  // from the end, so that a kill leaves no gap
  return results;
}

void ResultFile::append(Frame const& frame) {
  if (frames() == 0) {
    auto const kinds = [](std::vector<Field> const& fields) {
      std::vector<Kind> found;
      for (auto const& field : fields) found.push_back({field.name, field.unit, field.components});
      return found;
    };
    body_.point_fields = kinds(frame.point_fields);
    body_.cell_fields = kinds(frame.cell_fields);
  }
  check(frame);
  Cracks const cracks =
      frame.cracks.damage.empty() ? placeholder(cell_name(cracks_.type).nodes, frame.points) : frame.cracks;
  try {
    write_frame(frame, cracks);
  } catch (Error const&) {
    try {
      finish();  // the run ends here: what is written is shown, if the disk takes that much
    } catch (Error const&) {
    }
    throw;
  }
  auto const points = [](std::vector<double> const& coordinates) {
    return static_cast<std::int64_t>(coordinates.size() / 3);
  };
  body_.frames.push_back({frame.time, points(frame.points), body_.cells});
  cracks_.frames.push_back({frame.time, points(cracks.points), static_cast<std::int64_t>(cracks.damage.size())});
  rigid_.frames.push_back({frame.time, rigid_.ids, rigid_.cells});
  for (auto* part : parts()) write_xdmf(*part);
  if (auto const begin = std::chrono::steady_clock::now(); begin >= next_vtkhdf_) {
    write_vtkhdf();
    auto const end = std::chrono::steady_clock::now();
    next_vtkhdf_ = end + 10 * (end - begin);
  }
}

/// A frame that contradicts itself or the first one is a mistake of the caller, told before anything is written.
void ResultFile::check(Frame const& frame) const {
  auto const refuse = [&](std::string const& what) {
    throw Error(fmt::format("{}: frame at step {} cannot be written ({})", folder_, frame.step, what));
  };
  if (frames() > 0 && !(frame.time > body_.frames.back().time)) refuse("it is not later than the one before");
  if (frame.points.empty()) refuse("it has no vertices");
  std::size_t const points = frames() > 0 ? static_cast<std::size_t>(body_.frames[0].points) : frame.points.size() / 3;
  if (frame.points.size() != 3 * points) refuse("the number of vertices has changed");
  auto const check_fields = [&](std::vector<Field> const& fields, std::vector<Kind> const& kinds, std::size_t rows) {
    bool same = fields.size() == kinds.size();
    for (std::size_t i = 0; same && i < fields.size(); ++i)
      same = fields[i].name == kinds[i].name && fields[i].components == kinds[i].components;
    if (!same) refuse("its fields are not those of the first frame");
    for (auto const& field : fields)
      if (field.components < 1 || field.values.size() != rows * static_cast<std::size_t>(field.components))
        refuse(fmt::format("field \"{}\" has {} values where {} x {} belong", field.name, field.values.size(), rows,
                           field.components));
  };
  check_fields(frame.point_fields, body_.point_fields, points);
  check_fields(frame.cell_fields, body_.cell_fields, static_cast<std::size_t>(body_.cells));
  if (frame.rigid_points.size() != 3 * static_cast<std::size_t>(rigid_.ids))
    refuse("the corners of its plates and walls do not fit their number");
  std::size_t const broken = frame.cracks.damage.size();
  if (frame.cracks.points.size() != 3 * broken * static_cast<std::size_t>(cell_name(cracks_.type).nodes))
    refuse("the points of its cracks do not fit their number");
  check_fields(crack_fields(frame.cracks), cracks_.cell_fields, broken);
}

void ResultFile::write_frame(Frame const& frame, Cracks const& cracks) const {
  std::size_t values = 3 * (frame.points.size() + cracks.points.size()) + 16 * cracks.damage.size();
  for (auto const* fields : {&frame.point_fields, &frame.cell_fields})
    for (auto const& field : *fields) values += field.values.size();
  h5::Image image(values * 4 + (1 << 16));
  image.attribute("/", "time", frame.time);
  image.attribute("/", "step", std::int64_t{frame.step});
  image.dataset("/body/points", {frame.points.size() / 3, 3}, frame.points.data(), H5T_IEEE_F64LE);
  write_fields(image, "/body/point", frame.point_fields);
  write_fields(image, "/body/cell", frame.cell_fields);

  Integers connectivity(cracks.points.size() / 3);
  std::iota(connectivity.begin(), connectivity.end(), 0);
  write_cells(image, "/cracks", std::vector<int>(cracks.damage.size(), crack_type(cracks)), connectivity);
  image.dataset("/cracks/points", {connectivity.size(), 3}, cracks.points.data(), H5T_IEEE_F64LE);
  write_fields(image, "/cracks/point", {});
  write_fields(image, "/cracks/cell", crack_fields(cracks));
  if (rigid_.cells > 0) {
    image.dataset("/rigid/points", {frame.rigid_points.size() / 3, 3}, frame.rigid_points.data(), H5T_IEEE_F64LE);
    write_fields(image, "/rigid/point", {});
    write_fields(image, "/rigid/cell", {});
  }
  write_whole(path(frame_file(body_.frames.size())), image.bytes());
}

void ResultFile::write_vtkhdf() const {
  if (frames() == 0) return;
  for (auto const* part : parts()) write_vtkhdf(*part);
}

/// Where each frame of a part begins, and how much it has.
struct ResultFile::Steps {
  Integers point_start, cell_start, topology_start, id_start, part_start, points, cells, ids;
  std::vector<double> times;

  explicit Steps(Part const& part) {
    std::int64_t point_total = 0, cell_total = 0;
    for (std::size_t f = 0; f < part.frames.size(); ++f) {
      Written const& now = part.frames[f];
      times.push_back(now.time);
      point_start.push_back(point_total);
      cell_start.push_back(cell_total);
      topology_start.push_back(part.fixed_cells ? 0 : cell_total);
      id_start.push_back(part.fixed_cells ? 0 : topology_start.back() * cell_name(part.type).nodes);
      part_start.push_back(part.fixed_cells ? 0 : static_cast<std::int64_t>(f));
      point_total += now.points;
      cell_total += now.cells;
      if (f > 0 && part.fixed_cells) continue;
      points.push_back(now.points);
      cells.push_back(now.cells);
      ids.push_back(part.fixed_cells ? part.ids : now.cells * cell_name(part.type).nodes);
    }
  }
};

/// The VTKHDF 2.0 layout: every array is the concatenation of its frames, and `Steps` says where each begins.
void ResultFile::write_vtkhdf(Part const& part) const {
  std::size_t const frames = part.frames.size();
  Steps const steps(part);
  h5::Image image(frames * 4096 + (1 << 16));
  auto const integers = [&](std::string const& name, Integers const& values, bool as_column = false) {
    image.dataset("/VTKHDF/" + name, as_column ? h5::Shape{values.size(), 1} : h5::Shape{values.size()}, values.data());
  };
  auto const joined = [&](std::string const& to, std::string const& from, int components, hid_t stored, auto rows) {
    std::vector<h5::Piece> pieces;
    for (std::size_t f = 0; f < frames; ++f)
      pieces.push_back({frame_file(f), part.group + "/" + from, static_cast<hsize_t>(rows(part.frames[f]))});
    image.virtual_dataset("/VTKHDF/" + to, row_shape(components), pieces, stored);
  };
  auto const topology = [&](std::string const& to, std::string const& from, hid_t stored, auto rows) {
    if (!part.fixed_cells) return joined(to, from, 1, stored, rows);
    image.virtual_dataset("/VTKHDF/" + to, {},
                          {{mesh_file, part.group + "/" + from, static_cast<hsize_t>(rows(part.frames[0]))}}, stored);
  };

  image.group("/VTKHDF");
  image.attribute("/VTKHDF", "Version", Integers{2, 0});
  image.attribute("/VTKHDF", "Type", "UnstructuredGrid");
  integers("NumberOfPoints", steps.points);
  integers("NumberOfCells", steps.cells);
  integers("NumberOfConnectivityIds", steps.ids);
  joined("Points", "points", 3, H5T_IEEE_F64LE, [](Written const& now) { return now.points; });
  topology("Connectivity", "connectivity", H5T_STD_I64LE,
           [&](Written const& now) { return part.fixed_cells ? part.ids : now.cells * cell_name(part.type).nodes; });
  topology("Offsets", "offsets", H5T_STD_I64LE, [](Written const& now) { return now.cells + 1; });
  topology("Types", "types", H5T_STD_U8LE, [](Written const& now) { return now.cells; });

  image.group("/VTKHDF/Steps");
  image.attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(frames));
  image.dataset("/VTKHDF/Steps/Values", {frames}, steps.times.data(), H5T_IEEE_F64LE);
  integers("Steps/NumberOfParts", Integers(frames, 1));
  integers("Steps/PartOffsets", steps.part_start);
  integers("Steps/PointOffsets", steps.point_start);
  integers("Steps/CellOffsets", steps.topology_start, true);
  integers("Steps/ConnectivityIdOffsets", steps.id_start, true);

  for (auto const& group : {"PointData", "CellData", "Steps/PointDataOffsets", "Steps/CellDataOffsets"})
    image.group(std::string("/VTKHDF/") + group);
  for (auto const& field : part.point_fields) {
    joined("PointData/" + field.name, "point/" + field.name, field.components, H5T_IEEE_F32LE,
           [](Written const& now) { return now.points; });
    integers("Steps/PointDataOffsets/" + field.name, steps.point_start);
  }
  for (auto const& field : part.cell_fields) {
    joined("CellData/" + field.name, "cell/" + field.name, field.components, H5T_IEEE_F32LE,
           [](Written const& now) { return now.cells; });
    integers("Steps/CellDataOffsets/" + field.name, steps.cell_start);
  }
  write_whole(path(part.file + ".vtkhdf"), image.bytes());
}

void ResultFile::write_xdmf(Part& part) const {
  std::string& out = part.xdmf;
  for (std::size_t& f = part.in_xdmf; f < part.frames.size(); ++f) {
    auto const [time, points, cells] = part.frames[f];
    auto const item = [&](std::string const& file, std::string const& dataset, char const* type, int precision,
                          std::int64_t rows, int columns) {
      std::string const size = columns == 1 ? fmt::format("{}", rows) : fmt::format("{} {}", rows, columns);
      return fmt::format(
          "<DataItem Format=\"HDF\" NumberType=\"{}\" Precision=\"{}\" Dimensions=\"{}\">{}:{}/{}</DataItem>", type,
          precision, size, file, part.group, xml(dataset));
    };
    std::string const file = frame_file(f);
    auto const attributes = [&](std::vector<Kind> const& fields, std::string const& group, char const* center,
                                std::int64_t rows) {
      for (auto const& field : fields) {
        std::string const all = item(file, group + "/" + field.name, "Float", 4, rows, field.components);
        auto const attribute = [&](std::string const& name, char const* type, std::string const& data) {
          out += fmt::format("    <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n",
                             xml(name), type, center, data);
        };
        if (field.components != 6) {
          attribute(field.name, field.components == 1 ? "Scalar" : "Vector", all);
          continue;
        }
        // Readers agree on no kind of tensor: six scalars.
        constexpr char const* names[] = {"xx", "yy", "zz", "xy", "yz", "zx"};
        for (int c = 0; c < 6; ++c)
          attribute(field.name + " " + names[c], "Scalar",
                    fmt::format("<DataItem ItemType=\"HyperSlab\" Dimensions=\"{} 1\"><DataItem Dimensions=\"3 2\" "
                                "Format=\"XML\">0 {} 1 1 {} 1</DataItem>{}</DataItem>",
                                rows, c, rows, all));
      }
    };
    out += fmt::format("   <Grid Name=\"{}\" GridType=\"Uniform\"><Time Value=\"{:.17g}\"/>\n", part.file, time);
    bool const alike = part.type != 0;
    std::int64_t const ids = part.fixed_cells ? part.ids : cells * cell_name(part.type).nodes;
    out += fmt::format("    <Topology {} NumberOfElements=\"{}\">{}</Topology>\n",
                       alike ? cell_name(part.type).xdmf : "TopologyType=\"Mixed\"", cells,
                       item(part.fixed_cells ? mesh_file : file, alike ? "connectivity" : "mixed", "Int", 8,
                            alike ? ids : ids + cells, 1));
    out +=
        fmt::format("    <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", item(file, "points", "Float", 8, points, 3));
    attributes(part.point_fields, "point", "Node", points);
    attributes(part.cell_fields, "cell", "Cell", cells);
    out += "   </Grid>\n";
  }
  write_whole(path(part.file + ".xdmf"), "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n <Domain>\n  <Grid Name=\"" +
                                             part.file + "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
                                             out + "  </Grid>\n </Domain>\n</Xdmf>\n");
}

}  // namespace fissure::output
