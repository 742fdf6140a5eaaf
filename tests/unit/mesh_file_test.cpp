// Mesh files: what is read, and what is refused in which words.
#include <filesystem>
#include <fstream>

#include "../../src2d/shapes.h"
#include "mesh/msh_file.h"
#include "mesh_checks.h"

using namespace fissure;
using namespace fissure::mesh;
using namespace fissure::mesh::testing;

namespace {

// The unit square, two triangles, lower side and upper half named; element 4 belongs to two groups.
std::string const square_2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "floor"
2 2 "upper half"
2 3 "left"
$EndPhysicalNames
$Nodes
5
10 0 0 0.5
11 1 0 0.5
12 1 1 0.5
13 0 1 0.5
99 7 7 7
$EndNodes
$Elements
5
1 1 2 1 1 10 11
2 15 2 8 1 12
3 2 2 0 1 10 11 12
4 2 2 2 1 10 12 13
5 2 2 3 1 10 12 13
$EndElements
)";

// Two tetrahedra with a common face, which is named, as is one outer face; an unnamed group of both volumes.
std::string const pair_4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "between"
2 2 "under side"
$EndPhysicalNames
$Entities
1 0 2 1
1 0 0 0 0
1 0 0 0 1 1 1 1 1 0
2 0 0 0 1 1 0 2 2 -5 1 7
1 0 0 0 1 1 1 1 9 2 1 -2
$EndEntities
$Nodes
2 5 1 5
0 1 0 1
1
0 0 0
3 1 1 4
2
3
4
5
1 0 0 0.5 0.5 0.5
0 1 0 0.5 0.5 0.5
0 0 1 0.5 0.5 0.5
1 1 1 0.5 0.5 0.5
$EndNodes
$Elements
3 4 1 4
2 1 2 1
1 2 3 4
2 2 2 1
2 1 2 3
3 1 4 2
3 1 2 3 4
4 2 3 4 5
$EndElements
$NodeData
1 2 3 whatever
$EndNodeData
)";

Mesh read(std::string const& text, CellKind kind) {
  Mesh mesh = no_bodies(kind);
  add_body(mesh, read_msh("part.msh", text, kind), "part", at);
  return mesh;
}

std::string replaced(std::string text, std::string const& what, std::string const& with) {
  std::size_t const found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return text.replace(found, what.size(), with);
}

std::string error_in(std::string const& text, CellKind kind = CellKind::triangle) {
  return error_of([&] { read(text, kind); });
}

}  // namespace

TEST(MeshFile, OfFormat22GivesCellsAndGroups) {
  Mesh const mesh = read(square_2, CellKind::triangle);
  expect_sound(mesh);
  EXPECT_EQ(mesh.n_cells(), 2);
  EXPECT_EQ(mesh.nodes.size(), 4u);
  EXPECT_DOUBLE_EQ(total_measure(mesh), 1);
  EXPECT_EQ(mesh.nodes[0].z(), 0);
  EXPECT_DOUBLE_EQ(measure_of(mesh, "floor"), 1);
  EXPECT_EQ(mesh.named_nodes[0].at("upper half").size(), 3u);
  EXPECT_EQ(mesh.named_nodes[0].at("left").size(), 3u) << "a group wins over a side";
  EXPECT_EQ(mesh.named_faces[0].count("left"), 0u);
  EXPECT_EQ(mesh.named_nodes[0].at("8").size(), 1u);
  EXPECT_DOUBLE_EQ(measure_of(mesh, "right"), 1);
}

TEST(MeshFile, OfFormat41GivesCellsAndGroups) {
  Mesh const mesh = read(pair_4, CellKind::tetrahedron);
  expect_sound(mesh);
  EXPECT_EQ(mesh.n_cells(), 2);
  EXPECT_DOUBLE_EQ(total_measure(mesh), 1.0 / 6 + 1.0 / 3);
  EXPECT_DOUBLE_EQ(measure_of(mesh, "under side"), 0.5);
  EXPECT_EQ(mesh.named_nodes[0].at("between").size(), 3u);
  EXPECT_EQ(mesh.named_faces[0].count("between"), 0u) << "it lies inside";
  EXPECT_DOUBLE_EQ(measure_of(mesh, "5"), 0.5);
  EXPECT_EQ(mesh.named_nodes[0].at("9").size(), 5u);
}

TEST(MeshFile, IsReadFromDisk) {
  auto const path = std::filesystem::temp_directory_path() / "fissure_mesh_test.msh";
  std::ofstream(path) << square_2;
  EXPECT_EQ(mesh_of(mesher_2d(), shape(scene::MeshFile{path.string()}), 0).n_cells(), 2);
  EXPECT_EQ(error_of([&] { mesh_of(mesher_2d(), shape(scene::MeshFile{path.string()}), 0, 1); }),
            "scene.lua:7: body \"part\": seed has no meaning for a mesh file (it is already meshed); leave it out");
  std::filesystem::remove(path);
  EXPECT_EQ(error_of([&] { mesh_of(mesher_2d(), shape(scene::MeshFile{"none.msh"}), 0); }),
            "scene.lua:7: body \"part\": cannot read mesh file \"none.msh\" (no such file)");
}

TEST(MeshFile, FromOtherProgramsIsRead) {
  std::string dos;
  for (char const c : square_2) dos += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (std::string const& text :
       {"$Comments\n made by hand: $Nodes\n$EndComments\n" + square_2, "\xEF\xBB\xBF" + square_2, dos,
        replaced(square_2, "11 1 0 0.5", "11 +1.0e+00 +0 +5.0E-01")})
    EXPECT_EQ(error_in(text), "no error") << text.substr(0, 200);
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "11 +-1 0 0.5")), "part.msh:13: x should be a number");
  EXPECT_EQ(error_in("$Comments\n x\n"), "part.msh:1: this section has no $EndComments");
}

TEST(MeshFile, OfNothingIsRefusedBeforeItIsRead) {  // a sparse file of any size
  auto const path = std::filesystem::temp_directory_path() / "fissure_sparse_test.msh";
  std::ofstream(path) << '\0';
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40);
  EXPECT_EQ(error_of([&] { read_msh_file(path.string(), CellKind::triangle); }),
            path.string() + ": this is no Gmsh mesh (it should begin with $MeshFormat)");
  std::ofstream(path) << "$MeshFormat";
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40);
  EXPECT_EQ(error_of([&] { read_msh_file(path.string(), CellKind::triangle); }),
            path.string() + ": the file has 1.1e+03 GB (at most 8 GB are read)");
  std::filesystem::remove(path);
}

TEST(MeshFile, OfAnotherKindIsRefused) {
  EXPECT_EQ(error_in(""), "part.msh:1: the file is empty");
  EXPECT_EQ(error_in("solid cube\n"), "part.msh:1: this is no Gmsh mesh (it should begin with $MeshFormat)");
  EXPECT_EQ(
      error_in(replaced(square_2, "2.2 0", "4 0")),
      "part.msh:2: this version of the format is not read (2.2 and 4.1 are); export with Mesh.MshFileVersion = 4.1");
  EXPECT_EQ(error_in(replaced(square_2, "2.2 0", "2.2 1")),
            "part.msh:2: the mesh is binary (only ASCII is read); export with Mesh.Binary = 0");
  EXPECT_EQ(error_in(replaced(pair_4, "$NodeData", "$PartitionedEntities"), CellKind::tetrahedron),
            "part.msh:41: the mesh is partitioned (its pieces are not joined); save it in one piece");
}

TEST(MeshFile, OfAnotherDimensionIsRefused) {
  EXPECT_EQ(error_in(square_2, CellKind::tetrahedron),
            "part.msh:26: the mesh has surfaces but no volumes (a mesh of surfaces in a program for solids); mesh "
            "the volume, "
            "or run it with fissure2d");
  EXPECT_EQ(
      error_in(pair_4),
      "part.msh:38: element 3 is a tetrahedron (a mesh of volumes in a program for the plane); run it with fissure3d");
  EXPECT_EQ(error_in(replaced(square_2, "12 1 1 0.5", "12 1 1 0.7")),
            "part.msh:14: a node of the mesh is out of plane (z = 0.7 here, 0.5 elsewhere; a plane mesh has one z)");
}

TEST(MeshFile, WithOtherCellsIsRefused) {
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0 1 10 11 12", "3 16 2 0 1 10 11 12 13 14 15 16 17")),
            "part.msh:22: element 3 is a second-order quadrangle (only triangles and quadrangles of first order are "
            "read); export with "
            "Mesh.ElementOrder = 1");
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0 1 10 11 12", "3 9 2 0 1 10 11 12 13 14 15")),
            "part.msh:22: element 3 is a second-order triangle (only triangles and quadrangles of first order are "
            "read); export with "
            "Mesh.ElementOrder = 1");
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0", "3 77 2 0")),
            "part.msh:22: element 3 is of Gmsh's type 77 (only triangles and quadrangles of first order are read); "
            "export with "
            "Mesh.ElementOrder = 1");
  EXPECT_EQ(
      error_in(replaced(square_2, "$Elements\n5", "$Elements\n2\n1 1 2 1 1 10 11\n2 15 2 8 1 12\n$EndElements\n$Rest") +
               "$EndRest\n"),
      "part.msh:31: the mesh has no triangles; mesh it in Gmsh before export, with every physical group that matters");
}

TEST(MeshFile, WithBrokenTextIsRefusedByLine) {
  EXPECT_EQ(error_in(square_2.substr(0, square_2.find("13 0 1"))),
            "part.msh:15: the file ends where a node's number should be (it may be cut short); export it again");
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "11 one 0 0.5")), "part.msh:13: x should be a number");
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "11 nan 0 0.5")), "part.msh:13: x is not a finite number");
  EXPECT_EQ(error_in(replaced(square_2, "11 1 0 0.5", "10 1 0 0.5")), "part.msh:13: node 10 is given twice");
  EXPECT_EQ(error_in(replaced(square_2, "10 11 12\n", "10 11 55\n")),
            "part.msh:22: element 3 refers to node 55, which is not in the file");
  EXPECT_EQ(error_in(replaced(square_2, "$Nodes\n5", "$Nodes\n-5")),
            "part.msh:11: the number of nodes must lie between 0 and 300000000");
  EXPECT_EQ(error_in(replaced(square_2, "$EndNodes", "$EndNode")), "part.msh:17: $EndNodes expected here");
  EXPECT_EQ(error_in(replaced(square_2, "\"floor\"", "floor")),
            "part.msh:6: a physical group's name should be in quotes");
  EXPECT_EQ(error_in(replaced(square_2, "$Nodes", "$Nods")), "part.msh:10: this section has no $EndNods");
  EXPECT_EQ(error_in(replaced(square_2, "$Nodes", "Nodes")),
            "part.msh:10: a section (a word that begins with $) expected here");
}

TEST(MeshFile, WithBrokenCellsIsRefusedByElement) {
  EXPECT_EQ(error_in(replaced(square_2, "3 2 2 0 1 10 11 12", "3 2 2 0 1 10 11 11")),
            "scene.lua:7: body \"part\": element 3 of part.msh near (0.6667, 0, 0) is degenerate (its radius ratio is "
            "0, a regular "
            "one has 1); repair the mesh");
  EXPECT_EQ(error_in(replaced(square_2, "5 2 2 3", "5 2 2 2")),
            "scene.lua:7: body \"part\": element 4 of part.msh near (0.3333, 0.6667, 0) and element 5 of part.msh near "
            "(0.3333, 0.6667, 0) "
            "have the same corners; remove one of them");
}
