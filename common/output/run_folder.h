// The folder of a run: made with its parents, replaced only when an earlier run made it, never when it holds anything
// else.
#pragma once
#include <string>

namespace fissure::output {

/// Makes `folder` and its parents and marks it with a file ".fissure". A folder that carries the mark loses the files
/// of the earlier run (results, frames, history, run.json, checkpoint); other files in it stay. Throws Error when the
/// folder is a file, is not writable, or holds files but no mark.
void make_run_folder(std::string const& folder);

}  // namespace fissure::output
