#include "app/start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"

namespace fissure::app {
namespace {

std::string_view sentence(Start const& start) {
  std::string_view const line = start.text.substr(0, start.text.find('\n'));
  return line.substr(std::min(line.size(), line.find_first_not_of("- ")));
}

}  // namespace

std::string list_starts() {
  std::string text;
  for (auto const& start : starts()) text += fmt::format("  {:<10}  {}\n", start.kind, sentence(start));
  return text;
}

int write_start(std::string const& program, std::string const& kind, std::string file) {
  if (kind.empty()) {
    fmt::print(
        "Starting scenes:\n\n{}\n{} new KIND writes KIND.lua here; {} new KIND FILE.lua gives it another name.\n",
        list_starts(), program, program);
    return 0;
  }
  auto const found =
      std::find_if(starts().begin(), starts().end(), [&](Start const& start) { return start.kind == kind; });
  if (found == starts().end()) {
    std::vector<std::string> kinds;
    for (auto const& start : starts()) kinds.emplace_back(start.kind);
    throw Error(fmt::format("new {}: there is no starting scene of that kind (known: {}){}", kind,
                            fmt::join(kinds, ", "), suggestion(kind, kinds)));
  }
  if (file.empty()) file = kind + ".lua";
  std::FILE* const out = std::fopen(file.c_str(), "wx");
  if (!out && errno == EEXIST)
    throw Error(fmt::format("{} is there already and stays as it is; choose another name: {} new {} FILE.lua", file,
                            program, kind));
  bool good = out && std::fwrite(found->text.data(), 1, found->text.size(), out) == found->text.size();
  int why = errno;
  if (out && std::fclose(out) != 0) good = false, why = errno;
  if (!good) throw Error(fmt::format("{}: cannot be written ({})", file, std::strerror(why)));
  fmt::print("{}: {}\n  {} check {}  says what would be computed\n  {} run {}    computes it\n", file, sentence(*found),
             program, file, program, file);
  return 0;
}

}  // namespace fissure::app
