// The fields of a run over time, readable by ParaView and VisIt at every moment, also after a kill:
//   frames/mesh.h5, frames/000012.h5   the data: one HDF5 file per frame, complete or not there
//   results.vtkhdf, cracks.vtkhdf      VTKHDF with time inside: virtual datasets over the frames (ParaView 5.12 on)
//   results.xdmf, cracks.xdmf          the same data for ParaView 5.11 and VisIt
// A frame is written first and the four indices after it, each beside its name and then renamed: no file that a reader
// can see is ever half written. An HDF5 file that is appended to in place cannot promise that.
// HDF5 takes time to join many frames. So the XDMF files follow every frame, the VTKHDF files as often as a tenth of
// the time allows (with a hundred frames: every 0.1 s) and at finish(). While nothing is broken, the cracks are one
// undamaged cell without extent: damage > 0 tells cracks from it.
#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "output/results.h"

namespace fissure::output {

class ResultFile {
 public:
  /// Starts a new set of results in an existing folder. Throws Error with path and reason when it cannot be written.
  static ResultFile create(std::string const& folder, Topology const& topology);

  /// Continues a set of results; frames later than `time` [s] are taken away. Throws Error when the folder holds
  /// no results, those of another mesh, or lacks one of the `written` frames before a later one.
  static ResultFile reopen(std::string const& folder, Topology const& topology, double time, int written);

  /// One more frame, later than all before, with the fields of the first one. Points are stored in double precision, so
  /// that strains and openings computed from them are not rounded away; fields in single. When it throws, the frames
  /// before it are intact.
  void append(Frame const& frame);

  /// Brings the VTKHDF files up to the last frame: at the end of a run, also of one that was stopped.
  void finish() const { write_vtkhdf(); }

  int frames() const { return static_cast<int>(body_.frames.size()); }

 private:
  // a field without its values
  struct Kind {
    std::string name, unit;
    int components = 1;
  };
  // a part of a frame: its sizes
  struct Written {
    double time;
    std::int64_t points, cells;
  };
  /// The body, its cracks and what is rigid are unstructured grids over time that are written alike.
  struct Part {
    std::string file, group;          // "results" holds "/body", "cracks" "/cracks", "rigid" "/rigid"
    bool fixed_cells = false;         // cells are those of the mesh file at all times
    int type = 0;                     // VTK's, when all cells are alike; else 0
    std::int64_t cells = 0, ids = 0;  // and their corners, when they are fixed
    std::vector<Kind> point_fields, cell_fields;
    std::vector<Written> frames;
    std::string xdmf;  // the grids of the first in_xdmf frames
    std::size_t in_xdmf = 0;
  };

  ResultFile(std::string const& folder, Topology const& topology);
  std::string path(std::string const& name) const { return folder_ + "/" + name; }
  void check(Frame const& frame) const;
  void write_frame(Frame const& frame, Cracks const& cracks) const;
  void write_vtkhdf() const;
  struct Steps;
  void write_vtkhdf(Part const& part) const;
  void write_xdmf(Part& part) const;

  std::string folder_;
  std::vector<Part*> parts();
  std::vector<Part const*> parts() const;

  Part body_, cracks_, rigid_;  // the last has no cells when there are neither plates nor walls
  std::chrono::steady_clock::time_point next_vtkhdf_{};
};

}  // namespace fissure::output
