// Files of a run: whole or not there, readable after a kill, and clear words when the disk does not take them.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "output/checkpoint.h"
#include "output/file.h"
#include "output/hdf5.h"
#include "output/history_file.h"
#include "output/json.h"
#include "output/progress.h"
#include "output/result_file.h"
#include "output/run_folder.h"

namespace fissure::output {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, gone afterwards.
struct Output : testing::Test {
  std::string folder;
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "fissure-output-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder = pattern;
  }
  void TearDown() override { fs::remove_all(folder); }
};
struct Results : Output {};
struct History : Output {};
struct Checkpoints : Output {};
struct RunFolder : Output {};
struct FailingDisk : Output {};

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (Error const& error) {
    return error.what();
  }
  return "no error";
}

/// No file may grow beyond `bytes` while this lives: a disk that is full.
struct SmallDisk {
  rlimit before;
  explicit SmallDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit const small{bytes, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallDisk() { ::setrlimit(RLIMIT_FSIZE, &before); }
};

Topology two_triangles() { return {{0, 1, 2, 3, 4, 5}, {5, 5}}; }

/// Frame number k of two triangles that come apart, with k broken joints.
Frame frame(int k) {
  Frame f;
  f.time = 0.1 * k;
  f.step = 10 * k;
  double const open = 1e-9 * k;
  f.points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1 + open, 0, 0, 1 + open, 1, 0, open, 1, 0};
  f.point_fields = {{"displacement", "m", 3, std::vector<double>(18, open)}};
  f.cell_fields = {{"stress", "Pa", 6, std::vector<double>(12, 1e6 * k)}, {"damage", "", 1, {0, 0.5}}};
  for (int i = 0; i < k; ++i) {
    f.cracks.points.insert(f.cracks.points.end(), {1, 0, 0, 0, 1, 0});
    f.cracks.damage.push_back(1);
    f.cracks.mode.push_back(0.25);
    f.cracks.slip_out_of_plane.push_back(0);
    f.cracks.time.push_back(0.1 * (i + 1));
    f.cracks.opening.push_back(open);
    f.cracks.slip.push_back(0);
  }
  f.cracks.nodes_per_cell = 2;
  return f;
}

using Integers = std::vector<std::int64_t>;

TEST(Json, WritesOrderedObjectsWithAllDigits) {
  Json run;
  run["program"] = "fissure2d";
  run["time"]["dt"] = 0.1;
  run["steps"] = 12;
  run["passed"] = true;
  run["nothing"] = std::numeric_limits<double>::quiet_NaN();
  run["list"] = std::vector<double>{1, 2.5};
  run["plan"].push(Json())["what"] = "joints";
  EXPECT_EQ(run.text(),
            "{\n  \"program\": \"fissure2d\",\n  \"time\": {\n    \"dt\": 0.10000000000000001\n  },\n  \"steps\": 12,\n"
            "  \"passed\": true,\n  \"nothing\": null,\n  \"list\": [1, 2.5],\n  \"plan\": [\n    {\n      \"what\": "
            "\"joints\"\n    }\n  ]\n}\n");
}

TEST(Json, EscapesWhatJsonReservesAndReplacesWhatIsNoText) {
  EXPECT_EQ(Json("a\"b\\c\n\t\x01 µ \xff").text(), "\"a\\\"b\\\\c\\n\\t\\u0001 µ \\ufffd\"\n");
}

TEST_F(Results, AreAVtkhdfFileWithTimeInside) {
  auto results = ResultFile::create(folder, two_triangles());
  for (int k = 0; k < 4; ++k) results.append(frame(k));
  results.finish();

  h5::Reader const body(folder + "/results.vtkhdf");
  EXPECT_EQ(body.text("VTKHDF", "Type"), "UnstructuredGrid");
  EXPECT_EQ(body.number("VTKHDF/Steps", "NSteps"), 4);
  EXPECT_EQ(body.integers("VTKHDF/NumberOfPoints"), (Integers{6}));
  EXPECT_EQ(body.integers("VTKHDF/Connectivity"), two_triangles().cells);
  EXPECT_EQ(body.integers("VTKHDF/Offsets"), (Integers{0, 3, 6}));
  EXPECT_EQ(body.integers("VTKHDF/Types"), (Integers{5, 5}));
  EXPECT_EQ(body.integers("VTKHDF/Steps/PointOffsets"), (Integers{0, 6, 12, 18}));
  EXPECT_EQ(body.integers("VTKHDF/Steps/PartOffsets"), (Integers{0, 0, 0, 0}));
  EXPECT_EQ(body.integers("VTKHDF/Steps/CellDataOffsets/stress"), (Integers{0, 2, 4, 6}));
  EXPECT_EQ(body.shape("VTKHDF/Points"), (h5::Shape{24, 3}));
  EXPECT_EQ(body.shape("VTKHDF/CellData/stress"), (h5::Shape{8, 6}));
  EXPECT_EQ(body.integers("VTKHDF/CellData/stress")[6 * 2 * 3], 3'000'000);  // step 3 begins after 3 steps of 2 tensors

  h5::Reader const cracks(folder + "/cracks.vtkhdf");
  EXPECT_EQ(cracks.integers("VTKHDF/NumberOfCells"), (Integers{1, 1, 2, 3}));  // a placeholder first
  EXPECT_EQ(cracks.integers("VTKHDF/CellData/damage"), (Integers{0, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(cracks.integers("VTKHDF/Steps/CellOffsets"), (Integers{0, 1, 2, 4}));
  EXPECT_EQ(cracks.integers("VTKHDF/Connectivity"), (Integers{0, 1, 0, 1, 0, 1, 2, 3, 0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(cracks.integers("VTKHDF/Offsets"), (Integers{0, 2, 0, 2, 0, 2, 4, 0, 2, 4, 6}));
}

TEST_F(Results, HoldPlatesAndWallsWhereThereAreSome) {
  auto topology = two_triangles();
  EXPECT_EQ(ResultFile::create(folder, topology).frames(), 0);
  topology.held = {0, 4};
  topology.rigid_cells = 2, topology.rigid_type = 9;
  auto moved = [](int k) {
    Frame f = frame(k);
    f.rigid_points = std::vector<double>(24, 0.5 * k);
    return f;
  };
  {
    auto results = ResultFile::create(folder, topology);
    EXPECT_NE(message_of([&] { results.append(frame(0)); }).find("the corners of its plates and walls"),
              std::string::npos);
    for (int k = 0; k < 3; ++k) results.append(moved(k));
    results.finish();
  }
  auto results = ResultFile::reopen(folder, topology, moved(1).time, 1);
  results.append(moved(2));
  results.finish();
  EXPECT_EQ(h5::Reader(folder + "/frames/mesh.h5").integers("/body/held"), (Integers{0, 4}));
  h5::Reader const rigid(folder + "/rigid.vtkhdf");
  EXPECT_EQ(rigid.integers("VTKHDF/Connectivity"), (Integers{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(rigid.integers("VTKHDF/Types"), (Integers{9, 9}));
  EXPECT_EQ(rigid.integers("VTKHDF/Steps/PointOffsets"), (Integers{0, 8, 16}));
  EXPECT_EQ(rigid.integers("VTKHDF/Points")[3 * 16], 1);  // of the third frame
}

TEST_F(Results, GoOnAfterARestartAsIfNothingHadHappened) {
  {
    auto results = ResultFile::create(folder, two_triangles());
    for (int k = 0; k < 3; ++k) results.append(frame(k));
    results.finish();
  }
  auto const expected = read_whole(folder + "/results.xdmf") + read_whole(folder + "/cracks.xdmf");
  {
    auto results = ResultFile::reopen(folder, two_triangles(), frame(1).time, 1);
    EXPECT_EQ(results.frames(), 2);
    EXPECT_FALSE(fs::exists(folder + "/frames/000002.h5"));
    EXPECT_EQ(h5::Reader(folder + "/results.vtkhdf").number("VTKHDF/Steps", "NSteps"), 2);
    results.append(frame(2));
    results.finish();
  }
  EXPECT_EQ(read_whole(folder + "/results.xdmf") + read_whole(folder + "/cracks.xdmf"), expected);
  h5::Reader const index(folder + "/results.vtkhdf");  // HDF5 leaves bytes between its records as it finds them
  EXPECT_EQ(index.number("VTKHDF/Steps", "NSteps"), 3);
  EXPECT_EQ(index.integers("VTKHDF/Steps/PointOffsets"), (Integers{0, 6, 12}));
}

TEST_F(Results, RefuseAFrameThatContradictsTheFirst) {
  auto results = ResultFile::create(folder, two_triangles());
  results.append(frame(1));
  EXPECT_EQ(message_of([&] { results.append(frame(1)); }),
            folder + ": frame at step 10 cannot be written (it is not later than the one before)");
  Frame other = frame(2);
  other.cell_fields.pop_back();
  EXPECT_EQ(message_of([&] { results.append(other); }),
            folder + ": frame at step 20 cannot be written (its fields are not those of the first frame)");
  other = frame(2);
  other.cell_fields[1].values.pop_back();
  EXPECT_EQ(message_of([&] { results.append(other); }),
            folder + ": frame at step 20 cannot be written (field \"damage\" has 1 values where 2 x 1 belong)");
  results.append(frame(2));
  EXPECT_EQ(results.frames(), 2);
}

TEST_F(Results, RefuseToGoOnWithAnotherMesh) {
  ResultFile::create(folder, two_triangles());
  EXPECT_EQ(
      message_of([&] {
        ResultFile::reopen(folder, {{0, 1, 2}, {5}}, 1, 0);
      }),
      folder + "/frames/mesh.h5: is of another mesh than the run that is to go on; choose the folder of that run");
  fs::remove_all(folder + "/frames");
  EXPECT_EQ(
      message_of([&] { ResultFile::reopen(folder, two_triangles(), 1, 0); }),
      folder + "/frames/mesh.h5: cannot be read (it lacks an HDF5 header; not written by this program, or damaged)");
}

TEST_F(Results, SurviveAKillAtAnyMoment) {
  for (int attempt = 0; attempt < 12; ++attempt) {
    fs::remove_all(folder);
    fs::create_directory(folder);
    pid_t const child = ::fork();
    if (child == 0) {
      auto results = ResultFile::create(folder, two_triangles());
      for (int k = 0;; ++k) results.append(frame(k));
    }
    ::usleep(static_cast<useconds_t>(20'000 + 7'919 * attempt));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (!fs::exists(folder + "/results.vtkhdf")) continue;
    int const shown = static_cast<int>(h5::Reader(folder + "/results.vtkhdf").number("VTKHDF/Steps", "NSteps"));
    auto const stress = h5::Reader(folder + "/results.vtkhdf").integers("VTKHDF/CellData/stress");
    ASSERT_EQ(stress.size(), static_cast<std::size_t>(12 * shown));
    for (int k = 0; k < shown; ++k) ASSERT_EQ(stress[static_cast<std::size_t>(12 * k)], 1'000'000 * k);
    auto results = ResultFile::reopen(folder, two_triangles(), 1e9, 0);
    EXPECT_GE(results.frames(), shown);
    results.append(frame(results.frames()));
  }
}

TEST_F(FailingDisk, StopsAFrameAndLeavesTheOnesBefore) {
  auto results = ResultFile::create(folder, two_triangles());
  results.append(frame(0));
  Frame large = frame(1);
  for (int i = 0; i < 14; ++i) {  // doubles the cracks until the frame cannot fit
    auto& c = large.cracks;
    for (auto* values : {&c.points, &c.damage, &c.mode, &c.slip_out_of_plane, &c.time, &c.opening, &c.slip}) {
      auto const copy = *values;
      values->insert(values->end(), copy.begin(), copy.end());
    }
  }
  {
    SmallDisk const disk(100'000);
    EXPECT_EQ(message_of([&] { results.append(large); }),
              folder +
                  "/frames/000001.h5: cannot be written (File too large); the file size limit of the shell or file "
                  "system is reached (ulimit -f)");
  }
  EXPECT_EQ(results.frames(), 1);
  EXPECT_FALSE(fs::exists(folder + "/frames/000001.h5.part"));
  EXPECT_EQ(h5::Reader(folder + "/results.vtkhdf").number("VTKHDF/Steps", "NSteps"), 1);
  results.append(frame(1));
  results.finish();
  EXPECT_EQ(h5::Reader(folder + "/results.vtkhdf").number("VTKHDF/Steps", "NSteps"), 2);
}

TEST_F(FailingDisk, LeavesTheLastCheckpointAndWholeRowsOfTheHistory) {
  Checkpoint state;
  state.step = 7;
  save(folder + "/checkpoint.bin", state);
  auto history = HistoryFile::create(folder, {{"force", "N"}});
  history.append(0, {1});
  std::string const before = read_whole(folder + "/history.csv");
  {
    SmallDisk const disk(before.size() + 2);
    state.step = 8;
    state.put("u", std::vector<double>(1000, 1.0));
    EXPECT_EQ(message_of([&] { save(folder + "/checkpoint.bin", state); }),
              folder +
                  "/checkpoint.bin: cannot be written (File too large); the file size limit of the shell or file "
                  "system is reached (ulimit -f)");
    EXPECT_NE(message_of([&] { history.append(1, {2}); }), "no error");
  }
  EXPECT_EQ(load(folder + "/checkpoint.bin").step, 7);
  EXPECT_EQ(read_whole(folder + "/history.csv"), before);
}

TEST_F(FailingDisk, NamesAFolderThatIsMissingOrAFileOrForbidden) {
  EXPECT_EQ(message_of([&] { write_whole(folder + "/no/run.json", "x"); }),
            folder + "/no/run.json: cannot be written (No such file or directory); does its folder exist?");
  write_whole(folder + "/file", "x");
  EXPECT_EQ(message_of([&] { ResultFile::create(folder + "/file", two_triangles()); }),
            folder + "/file/frames: cannot be created (Not a directory); a part of the path is a file, not a folder");
  fs::create_directory(folder + "/folder");
  EXPECT_EQ(message_of([&] { write_whole(folder + "/folder", "x"); }),
            folder + "/folder: cannot be written (Is a directory)");
  if (::geteuid() == 0) return;  // root may write anywhere
  fs::permissions(folder + "/folder", fs::perms::owner_read);
  EXPECT_EQ(
      message_of([&] { write_whole(folder + "/folder/a", "x"); }),
      folder + "/folder/a: cannot be written (Permission denied); choose a folder that you may write to with --out");
}

TEST_F(History, IsCommaSeparatedWithUnitsAndTheSameInHdf5) {
  auto history = HistoryFile::create(folder, {{"force", "N"}, {"a, \"b\"", ""}});
  history.append(0, {1, 2});
  history.append(0.1, {-1e-300, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(read_whole(folder + "/history.csv"),
            "time [s],force [N],\"a, \"\"b\"\" []\"\n0,1,2\n0.10000000000000001,-1e-300,inf\n");
  history.write_hdf5();
  h5::Reader const hdf5(folder + "/history.h5");
  EXPECT_EQ(hdf5.integers("history/force"), (Integers{1, 0}));
  EXPECT_EQ(hdf5.text("history/force", "unit"), "N");
  EXPECT_EQ(message_of([&] { history.append(1, {1}); }),
            folder + "/history.csv: a row of 1 values cannot be written (2 columns)");
}

TEST_F(History, LosesLaterAndUnfinishedRowsAtARestart) {
  { HistoryFile::create(folder, {{"force", "N"}}); }
  std::ofstream(folder + "/history.csv", std::ios::app) << "0,1\n0.10000000000000001,2\n0.20000000000000001,3\n0.3";
  { HistoryFile::reopen(folder, {{"force", "N"}}, 0.1).append(0.2, {4}); }
  EXPECT_EQ(read_whole(folder + "/history.csv"),
            "time [s],force [N]\n0,1\n0.10000000000000001,2\n0.20000000000000001,4\n");
  EXPECT_EQ(message_of([&] {
              HistoryFile::reopen(folder, {{"force", "kN"}}, 1);
            }),
            folder + "/history.csv:1: has other columns than the run that is to go on; choose the folder of that run");
}

TEST_F(Checkpoints, ComeBackBitForBit) {
  Checkpoint state{"fissure3d", "0.1.0", "abc", "double", 3, 123456789012, 0.1, {}};
  std::vector<double> const odd{-0.0, 5e-324, std::numeric_limits<double>::quiet_NaN(),
                                -std::numeric_limits<double>::infinity(), 0.1};
  state.put("u", odd);
  state.put("state", std::vector<std::uint8_t>{0, 255, 3});
  state.put("empty", std::vector<float>{});
  save(folder + "/c", state);
  Checkpoint const back = load(folder + "/c");
  EXPECT_EQ(back.program, "fissure3d");
  EXPECT_EQ(back.precision, "double");
  EXPECT_EQ(back.scene_hash, "abc");
  EXPECT_EQ(back.dimension, 3);
  EXPECT_EQ(back.step, 123456789012);
  EXPECT_EQ(back.time, 0.1);
  EXPECT_EQ(back.blobs, state.blobs);
  EXPECT_EQ(std::memcmp(back.get<double>("u").data(), odd.data(), odd.size() * sizeof(double)), 0);
  EXPECT_TRUE(back.get<float>("empty").empty());
  EXPECT_EQ(message_of([&] { back.get<double>("v"); }),
            "checkpoint: lacks \"v\" (written by another version of the program?)");
  EXPECT_EQ(message_of([&] { back.get<double>("state"); }),
            "checkpoint: \"state\" has 3 bytes, no multiple of 8 (written by another version of the program?)");
}

TEST_F(Checkpoints, AreRefusedWhenForeignCutOffOrDamaged) {
  std::string const path = folder + "/c";
  EXPECT_EQ(message_of([&] { load(path); }),
            path + ": cannot be read (No such file or directory); does its folder exist?");
  write_whole(path, "a letter");
  EXPECT_EQ(message_of([&] { load(path); }), path + ": is no checkpoint (it does not begin as one)");

  Checkpoint state;
  state.put("u", std::vector<double>{1, 2, 3});
  save(path, state);
  std::string const whole = read_whole(path);
  for (std::size_t size = 0; size < whole.size(); ++size) {  // cut anywhere
    write_whole(path, std::string_view(whole).substr(0, size));
    ASSERT_NE(message_of([&] { load(path); }), "no error") << size;
  }
  EXPECT_EQ(message_of([&] { load(path); }), path + ": is cut off (" + std::to_string(whole.size() - 1) + " of " +
                                                 std::to_string(whole.size()) +
                                                 " bytes); go on from another checkpoint");
  for (std::size_t at = 0; at < whole.size(); ++at) {  // any byte changed
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_whole(path, damaged);
    ASSERT_NE(message_of([&] { load(path); }), "no error") << at;
  }
  EXPECT_EQ(message_of([&] { load(path); }),
            path + ": is damaged (its checksum is wrong); go on from another checkpoint");
  int const ours = whole[19];  // behind the magic word, lowest byte first
  std::string newer = whole;
  newer[19] = static_cast<char>(ours + 1);
  write_whole(path, newer);
  EXPECT_EQ(message_of([&] { load(path); }), path + ": is a checkpoint of format " + std::to_string(ours + 1) +
                                                 " (this program reads format " + std::to_string(ours) + ")");
}

TEST_F(RunFolder, IsMadeWithItsParentsAndReplacedOnlyWhenARunMadeIt) {
  std::string const run = folder + "/a/b/run";
  make_run_folder(run);
  ResultFile::create(run, two_triangles()).append(frame(0));
  write_whole(run + "/notes.txt", "mine");
  make_run_folder(run);
  EXPECT_TRUE(fs::exists(run + "/results.xdmf"));  // until the run has the folder for itself
  {
    RunLock const lock(run);
    EXPECT_EQ(message_of([&] { RunLock const second(run); }),
              run + ": a run is going on there; wait for its end or choose another folder with --out");
    remove_earlier_run(run);
  }
  RunLock const free(run);
  EXPECT_FALSE(fs::exists(run + "/results.xdmf"));
  EXPECT_FALSE(fs::exists(run + "/frames/000000.h5"));
  EXPECT_TRUE(fs::exists(run + "/notes.txt"));

  EXPECT_EQ(message_of([&] { make_run_folder(folder); }),
            folder + ": already holds files that are no run of Fissure (\"a\"); choose another folder with --out");
  fs::create_directory(folder + "/killed");  // right after its start
  write_whole(folder + "/killed/.fissure.part", "This fol");
  make_run_folder(folder + "/killed");
  EXPECT_TRUE(fs::exists(folder + "/killed/.fissure"));
  EXPECT_EQ(message_of([&] { make_run_folder(run + "/notes.txt"); }),
            run + "/notes.txt: is a file (results need a folder); choose another name with --out");
  EXPECT_EQ(message_of([&] { make_run_folder(run + "/notes.txt/x"); }),
            run +
                "/notes.txt/x: cannot be made ready for results (Not a directory); a part of the path is a file, not a "
                "folder");
}

TEST(Progress, ShowsTimeShareSpeedAndTimeLeft) {
  EXPECT_EQ(progress_line(0.9e-3, 2e-3, 0.8512, 80),
            "[==========              ]  45 %  900 us of 2.00 ms  0.85 ns per element and step  1 min 20 s left");
  EXPECT_EQ(short_time(35e-6), "35.0 us");
  EXPECT_EQ(clock_time(7500), "2 h 05 min");
}

TEST(Progress, IsSilentWhenNobodyWatches) {
  std::FILE* const file = std::tmpfile();
  { Progress(0, 1, 0, 1000, file).update(0.5, 10); }
  EXPECT_EQ(std::ftell(file), 0);
  std::fclose(file);
}

}  // namespace
}  // namespace fissure::output
