// The formats MSH 4.1 and 2.2 of the Gmsh 4.8 reference manual, as words with their line. Memory grows only with the
// text: a count that the text does not keep is found at its end.
#include "mesh/msh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <tuple>
#include <type_traits>

namespace fissure::mesh {
namespace {

/// Gmsh's element types that come up. Corners: 0 when the shape is not read, -1 when the order is not.
struct ElementType {
  int number, dimension, corners;
  char const* name;
};
constexpr ElementType known_types[] = {
    {1, 1, 2, "line"},
    {2, 2, 3, "triangle"},
    {3, 2, 4, "quadrangle"},
    {4, 3, 4, "tetrahedron"},
    {5, 3, 8, "hexahedron"},
    {6, 3, 0, "prism"},
    {7, 3, 0, "pyramid"},
    {8, 1, -1, "second-order line"},
    {9, 2, -1, "second-order triangle"},
    {10, 2, -1, "second-order quadrangle"},
    {11, 3, -1, "second-order tetrahedron"},
    {12, 3, -1, "second-order hexahedron"},
    {15, 0, 1, "point"},
    {16, 2, -1, "second-order quadrangle"},
    {17, 3, -1, "second-order hexahedron"},
};

/// Words of the text with their line.
class Words {
 public:
  Words(std::string const& file, std::string_view text) : file_(file), text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // a byte order mark
  }

  [[noreturn]] void refuse(std::string const& why) const { refuse_at(line_, why); }
  [[noreturn]] void refuse_at(int line, std::string const& why) const { throw Error(Source{file_, line}, why); }

  bool at_end() {
    skip_space();
    return at_ == text_.size();
  }
  std::string_view word(char const* what) {
    if (at_end()) refuse(fmt::format("the file ends where {} should be (it may be cut short); export it again", what));
    std::size_t const start = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }
  template <class Number>
  Number number(char const* what) {
    std::string_view w = word(what);
    if (w.size() > 1 && w[0] == '+' && w[1] != '-') w.remove_prefix(1);  // +1.0e-02, which from_chars does not take
    Number value{};
    auto const [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc() || end != w.data() + w.size()) refuse(fmt::format("{} should be a number", what));
    if constexpr (std::is_floating_point_v<Number>)
      if (!std::isfinite(value)) refuse(fmt::format("{} is not a finite number", what));
    return value;
  }
  long long integer(char const* what) { return number<long long>(what); }
  /// How many of something follow.
  long long count(char const* what) {
    long long const n = integer(what);
    if (n < 0 || n > most_) refuse(fmt::format("{} must lie between 0 and {}", what, most_));
    return n;
  }
  /// A name in quotes.
  std::string quoted(char const* what) {
    if (at_end() || text_[at_] != '"') refuse(fmt::format("{} should be in quotes", what));
    std::size_t const end = text_.find_first_of("\"\n", at_ + 1);
    if (end == std::string_view::npos || text_[end] == '\n') refuse(fmt::format("{} has no closing quote", what));
    std::string name(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    if (name.empty()) refuse(fmt::format("{} is empty", what));
    return name;
  }
  void expect(std::string const& keyword) {
    if (word(keyword.c_str()) != keyword) refuse(fmt::format("{} expected here", keyword));
  }
  /// Past a section that does not matter.
  void skip_to(std::string const& keyword) {
    int const start = line_;
    while (!at_end())
      if (word(keyword.c_str()) == keyword) return;
    refuse_at(start, fmt::format("this section has no {}", keyword));
  }
  int line() const { return line_; }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
  void skip_space() {
    for (; at_ < text_.size() && is_space(text_[at_]); ++at_) line_ += text_[at_] == '\n';
  }

  static constexpr long long most_ = 300'000'000;  // six times the cells that a model may have
  std::string const& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

class MshReader {
 public:
  MshReader(std::string const& file, std::string_view text, CellKind kind)
      : file_(file), in_(file, text), corners_(node_count(kind)) {}

  Part read() {
    read_format();
    while (!in_.at_end()) {
      std::string const section(in_.word("a section"));
      if (section == "$PhysicalNames")
        read_names();
      else if (section == "$Entities")
        read_entities();
      else if (section == "$Nodes")
        v4_ ? read_nodes_4() : read_nodes_2();
      else if (section == "$Elements")
        v4_ ? read_elements_4() : read_elements_2();
      else if (section == "$PartitionedEntities")
        in_.refuse("the mesh is partitioned (its pieces are not joined); save it in one piece");
      else if (section.size() < 2 || section[0] != '$')
        in_.refuse("a section (a word that begins with $) expected here");
      else
        in_.skip_to("$End" + section.substr(1));
    }
    return assemble();
  }

 private:
  struct Element {
    long long label;
    int type_dimension, corners;
    std::array<long long, 8> node;
    int line;
    int groups;
  };
  using GroupTags = std::vector<int>;

  void read_format() {
    if (in_.at_end()) in_.refuse("the file is empty");
    std::string_view first = in_.word("$MeshFormat");
    for (; first == "$Comments"; first = in_.word("$MeshFormat")) in_.skip_to("$EndComments");
    if (first != "$MeshFormat") in_.refuse("this is no Gmsh mesh (it should begin with $MeshFormat)");
    std::string_view const version = in_.word("the version");
    if (version != "2.2" && version != "4.1")
      in_.refuse("this version of the format is not read (2.2 and 4.1 are); export with Mesh.MshFileVersion = 4.1");
    v4_ = version == "4.1";
    if (in_.integer("the file type") != 0)
      in_.refuse("the mesh is binary (only ASCII is read); export with Mesh.Binary = 0");
    in_.integer("the size of a number");
    in_.expect("$EndMeshFormat");
  }

  void read_names() {
    long long const n = in_.count("the number of names");
    for (long long i = 0; i < n; ++i) {
      int const dimension = read_dimension();
      int const tag = in_.number<int>("a physical group's number");
      names_[{dimension, tag}] = in_.quoted("a physical group's name");
    }
    in_.expect("$EndPhysicalNames");
  }

  int read_dimension() {
    int const dimension = in_.number<int>("a dimension");
    if (dimension < 0 || dimension > 3) in_.refuse("a dimension must lie between 0 and 3");
    return dimension;
  }

  void read_entities() {
    if (!v4_) in_.refuse("$Entities does not belong into a file of format 2.2");
    long long count[4];
    for (long long& n : count) n = in_.count("the number of entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      for (long long i = 0; i < count[dimension]; ++i) {
        int const tag = in_.number<int>("an entity's number");
        for (int k = 0; k < (dimension ? 6 : 3); ++k) in_.number<double>("a coordinate");
        GroupTags groups;
        for (long long left = in_.count("the number of physical groups"); left > 0; --left)
          groups.push_back(read_group());
        entity_groups_[{dimension, tag}] = keep(groups);
        if (dimension)
          for (long long left = in_.count("the number of bounding entities"); left > 0; --left)
            in_.integer("a bounding entity");
      }
    in_.expect("$EndEntities");
  }

  /// A negative number marks a reversed orientation, which means nothing here.
  int read_group() {
    int const tag = in_.number<int>("a physical group's number");
    if (tag == std::numeric_limits<int>::min()) in_.refuse("a physical group's number is out of range");
    return std::abs(tag);
  }

  /// The number under which a list of groups is kept, so that elements hold one int.
  int keep(GroupTags const& groups) {
    auto const [it, is_new] = group_lists_.try_emplace(groups, static_cast<int>(lists_.size()));
    if (is_new) lists_.push_back(groups);
    return it->second;
  }

  void read_point(long long tag) {
    double const x = in_.number<double>("x");
    node_lines_.push_back(in_.line());
    double const y = in_.number<double>("y"), z = in_.number<double>("z");
    node_tags_.push_back({tag, static_cast<int>(nodes_.size())});
    nodes_.emplace_back(x, y, z);
  }

  void read_nodes_2() {
    long long const n = in_.count("the number of nodes");
    for (long long i = 0; i < n; ++i) read_point(in_.integer("a node's number"));
    in_.expect("$EndNodes");
  }

  void read_nodes_4() {
    long long const blocks = in_.count("the number of blocks");
    for (int i = 0; i < 3; ++i) in_.integer("a count of nodes");
    std::vector<long long> tags;
    for (long long b = 0; b < blocks; ++b) {
      int const dimension = read_dimension();
      in_.integer("an entity's number");
      bool const parametric = in_.integer("whether nodes are parametric") != 0;
      tags.clear();
      for (long long left = in_.count("the number of nodes"); left > 0; --left)
        tags.push_back(in_.integer("a node's number"));
      for (long long tag : tags) {
        read_point(tag);
        if (parametric)
          for (int i = 0; i < dimension; ++i) in_.number<double>("a parameter");
      }
    }
    in_.expect("$EndNodes");
  }

  /// The type, or a refusal that names the element.
  ElementType const& type_of(int number, long long label) const {
    std::string const programs =
        corners_ == node_count(CellKind::triangle) ? "triangles and quadrangles" : "tetrahedra and hexahedra";
    auto const* const type = std::find_if(std::begin(known_types), std::end(known_types),
                                          [&](ElementType const& t) { return t.number == number; });
    if (type == std::end(known_types))
      in_.refuse(fmt::format(
          "element {} is of Gmsh's type {} (only {} of first order are read); export with Mesh.ElementOrder = 1", label,
          number, programs));
    if (type->corners < 0)
      in_.refuse(fmt::format("element {} is a {} (only {} of first order are read); export with Mesh.ElementOrder = 1",
                             label, type->name, programs));
    if (type->dimension > corners_ - 1)
      in_.refuse(fmt::format("element {} is a {} (a mesh of volumes in a program for the plane); run it with fissure3d",
                             label, type->name));
    if (type->corners == 0)
      in_.refuse(fmt::format("element {} is a {} (only {} are read); mesh again without this kind", label, type->name,
                             programs));
    return *type;
  }

  void read_element(long long label, ElementType const& type, int groups, int line) {
    Element element{label, type.dimension, type.corners, {-1, -1, -1, -1, -1, -1, -1, -1}, line, groups};
    for (int i = 0; i < type.corners; ++i) element.node[i] = in_.integer("a node of an element");
    elements_.push_back(element);
  }

  void read_elements_2() {
    long long const n = in_.count("the number of elements");
    for (long long i = 0; i < n; ++i) {
      long long const label = in_.integer("an element's number");
      int const line = in_.line();
      ElementType const& type = type_of(in_.number<int>("an element's type"), label);
      GroupTags groups;
      long long const tags = in_.count("the number of tags");
      for (long long k = 0; k < tags; ++k) {
        int const tag = read_group();
        if (k == 0 && tag != 0) groups.push_back(tag);
      }
      read_element(label, type, keep(groups), line);
    }
    in_.expect("$EndElements");
  }

  void read_elements_4() {
    long long const blocks = in_.count("the number of blocks");
    for (int i = 0; i < 3; ++i) in_.integer("a count of elements");
    for (long long b = 0; b < blocks; ++b) {
      int const dimension = read_dimension();
      int const entity = in_.number<int>("an entity's number");
      int const type_number = in_.number<int>("an element type");
      long long const n = in_.count("the number of elements");
      auto const it = entity_groups_.find({dimension, entity});
      int const groups = it == entity_groups_.end() ? keep({}) : it->second;
      for (long long i = 0; i < n; ++i) {
        long long const label = in_.integer("an element's number");
        ElementType const& type = type_of(type_number, label);
        if (type.dimension != dimension)
          in_.refuse(fmt::format("element {} is a {} in a block of dimension {}", label, type.name, dimension));
        read_element(label, type, groups, in_.line());
      }
    }
    in_.expect("$EndElements");
  }

  int node_index(long long tag, Element const& element) const {
    auto const it = std::lower_bound(node_tags_.begin(), node_tags_.end(), std::pair(tag, 0));
    if (it == node_tags_.end() || it->first != tag)
      in_.refuse_at(element.line,
                    fmt::format("element {} refers to node {}, which is not in the file", element.label, tag));
    return it->second;
  }

  std::string group_name(int dimension, int tag) const {
    auto const it = names_.find({dimension, tag});
    return it == names_.end() ? std::to_string(tag) : it->second;
  }

  Part assemble() {
    int const dimension = corners_ - 1;
    std::sort(node_tags_.begin(), node_tags_.end());
    for (std::size_t i = 1; i < node_tags_.size(); ++i)
      if (node_tags_[i].first == node_tags_[i - 1].first)
        in_.refuse_at(node_lines_[node_tags_[i].second], fmt::format("node {} is given twice", node_tags_[i].first));

    Part part;
    part.file = file_;
    std::vector<Element> cells;
    for (Element const& e : elements_)
      if (e.type_dimension == dimension) cells.push_back(e);
    if (cells.empty()) refuse_no_cells();
    if (!v4_) merge_repeated(cells);

    std::vector<char> used(nodes_.size(), 0);
    for (bool const blocks : {false, true})
      for (Element const& e : cells) {
        if ((e.corners != corners_) != blocks) continue;
        part.labels.push_back(e.label);
        auto& corners = blocks ? part.blocks : part.cells;
        for (int i = 0; i < e.corners; ++i) {
          corners.push_back(node_index(e.node[i], e));
          used[corners.back()] = 1;
        }
      }
    flatten(used);
    part.nodes = std::move(nodes_);
    for (Element const& e : elements_) {
      for (int tag : lists_[e.groups]) {
        std::string const name = group_name(e.type_dimension, tag);
        auto& nodes = part.group_nodes[name];
        for (int i = 0; i < e.corners; ++i) nodes.push_back(node_index(e.node[i], e));
        if (e.type_dimension != dimension - 1) continue;
        // A quadrilateral stands for the triangles of its corners: those of its parts are among them.
        auto* const face = &nodes[nodes.size() - e.corners];
        auto& faces = part.group_faces[name];
        if (e.corners == 4)
          for (int skip = 0; skip < 4; ++skip)
            faces.push_back({face[skip == 0], face[1 + (skip <= 1)], face[2 + (skip <= 2)]});
        else
          faces.push_back({face[0], e.corners > 1 ? face[1] : -1, e.corners > 2 ? face[2] : -1});
      }
    }
    return part;
  }

  [[noreturn]] void refuse_no_cells() const {
    bool const flat =
        std::any_of(elements_.begin(), elements_.end(), [](Element const& e) { return e.type_dimension == 2; });
    if (flat)
      in_.refuse(
          "the mesh has surfaces but no volumes (a mesh of surfaces in a program for solids); mesh the volume, or run "
          "it with fissure2d");
    in_.refuse(fmt::format("the mesh has no {}; mesh it in Gmsh before export, with every physical group that matters",
                           corners_ == node_count(CellKind::triangle) ? "triangles" : "tetrahedra"));
  }

  /// Format 2.2 writes a cell once per physical group: those are one cell. The same cell twice in one group stays, to
  /// be refused.
  void merge_repeated(std::vector<Element>& cells) const {
    std::vector<std::tuple<std::array<long long, 8>, int, int>> keys;  // sorted nodes, groups, place
    for (std::size_t c = 0; c < cells.size(); ++c) {
      auto nodes = cells[c].node;
      std::sort(nodes.begin(), nodes.end());
      keys.push_back({nodes, cells[c].groups, static_cast<int>(c)});
    }
    std::sort(keys.begin(), keys.end());
    std::vector<char> repeated(cells.size(), 0);
    for (std::size_t i = 1; i < keys.size(); ++i)
      if (std::get<0>(keys[i]) == std::get<0>(keys[i - 1]) && std::get<1>(keys[i]) != std::get<1>(keys[i - 1]))
        repeated[std::get<2>(keys[i])] = 1;
    std::size_t kept = 0;
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (!repeated[c]) cells[kept++] = cells[c];
    cells.resize(kept);
  }

  /// Coordinates that a program does not have must be the same everywhere; they become 0.
  void flatten(std::vector<char> const& used) {
    std::size_t const first = std::find(used.begin(), used.end(), 1) - used.begin();
    double size = 0;
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (used[n]) size = std::max(size, (nodes_[n] - nodes_[first]).cwiseAbs().maxCoeff());
    for (int axis = corners_ - 1; axis < 3; ++axis) {
      double const height = nodes_[first][axis];
      for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (used[n] && std::abs(nodes_[n][axis] - height) > 1e-9 * size)
          in_.refuse_at(
              node_lines_[n],
              fmt::format("a node of the mesh is out of plane (z = {:g} here, {:g} elsewhere; a plane mesh has one z)",
                          nodes_[n][axis], height));
        nodes_[n][axis] = 0;
      }
    }
  }

  std::string const& file_;
  Words in_;
  int corners_;
  bool v4_ = false;
  std::map<std::pair<int, int>, std::string> names_;  // (dimension, tag)
  std::map<std::pair<int, int>, int> entity_groups_;  // (dimension, tag) -> list
  std::map<GroupTags, int> group_lists_;
  std::vector<GroupTags> lists_;
  std::vector<Vec3> nodes_;
  std::vector<int> node_lines_;
  std::vector<std::pair<long long, int>> node_tags_;  // (number in the file, index)
  std::vector<Element> elements_;
};

}  // namespace

namespace {

// a tetrahedron takes some 30 bytes with its share of a node, and 50 million are the most
constexpr double most_bytes = 8e9;

}  // namespace

Part read_msh(std::string const& file, std::string_view text, CellKind kind) {
  return MshReader(file, text, kind).read();
}

Part read_msh_file(std::string const& path, CellKind kind) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(fmt::format("cannot read mesh file \"{}\"", path));
  char first = ' ';
  while (stream.get(first) && (first == ' ' || first == '\n' || first == '\r' || first == '\t')) {
  }
  if (stream && first != '$' && first != '\xEF')
    throw Error(fmt::format("{}: this is no Gmsh mesh (it should begin with $MeshFormat)", path));
  stream.clear();
  stream.seekg(0, std::ios::end);
  auto const size = static_cast<double>(stream.tellg());
  if (!(size <= most_bytes))
    throw Error(
        fmt::format("{}: the file has {:.3g} GB (at most {:.3g} GB are read)", path, size / 1e9, most_bytes / 1e9));
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.seekg(0);
  if (!stream.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw Error(fmt::format("{}: cannot be read to its end", path));
  return read_msh(path, text, kind);
}

}  // namespace fissure::mesh
