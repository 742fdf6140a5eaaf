#include "app/pages.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/start.h"
#include "scene/scene.h"

namespace fissure::app {
namespace {

/// As troff takes it: no dash is a hyphen, and no line begins with a request.
std::string roff(std::string const& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    bool const begins = i == 0 || text[i - 1] == '\n';
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::vector<CLI::App const*> commands(CLI::App const& app) { return app.get_subcommands({}); }

/// Those that have a name of their own; `--help` stands for itself.
std::vector<CLI::Option const*> options(CLI::App const& app) {
  std::vector<CLI::Option const*> found;
  for (auto const* option : app.get_options())
    if (option != app.get_help_ptr()) found.push_back(option);
  return found;
}

bool takes_value(CLI::Option const& option) { return option.get_expected_max() > 0 && !option.get_positional(); }

/// What stands for its value; CLI11 adds bounds behind a colon.
std::string value_name(CLI::Option const& option) {
  std::string const name = option.get_type_name();
  return name.substr(0, name.find(':'));
}

std::string item(CLI::Option const& option) {
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n",
                     roff(option.get_positional() ? option.get_single_name() : option.get_name(false, true)),
                     takes_value(option) ? " \\fI" + value_name(option) + "\\fR" : "", roff(option.get_description()));
}

std::string usage(std::string const& program, CLI::App const& command) {
  std::string line = fmt::format(".B {} {}\n", program, command.get_name());
  bool more = false;
  for (auto const* option : options(command))
    if (!option->get_positional())
      more = true;
    else if (option->get_required())
      line += fmt::format(".I {}\n", option->get_single_name());
    else
      line += fmt::format(".RI [ {} ]\n", option->get_single_name());
  return line + (more ? "[options]\n" : "") + ".br\n";
}

}  // namespace

std::string manual(CLI::App const& app) {
  std::string const name = app.get_name();
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page = fmt::format(".TH {} 1 \"\" \"Fissure {}\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.nh\n.ad l\n", upper,
                                 FISSURE_VERSION, name, roff(app.get_description()));
  for (auto const* command : commands(app)) page += usage(name, *command);
  page += ".SH DESCRIPTION\nAn experiment is one Lua file, a scene, which fissure2d(1) and fissure3d(1) read alike.\n";
  page += ".SH COMMANDS\n";
  for (auto const* command : commands(app)) {
    page += fmt::format(".SS {}\n{}.\n", command->get_name(), roff(command->get_description()));
    for (auto const* option : options(*command)) page += item(*option);
  }
  page += ".SH STARTING SCENES\n";
  for (auto const& start : starts()) {
    std::string const line(start.text.substr(0, start.text.find('\n')));
    page += fmt::format(".TP\n.B {}\n{}\n", start.kind, roff(line.substr(line.find_first_not_of("- "))));
  }
  page += ".SH EXIT STATUS\n";
  for (auto const& [status, what] : exit_statuses) page += fmt::format(".TP\n.B {}\n{}\n", status, roff(what));
  page += ".SH SEE ALSO\n.B " + name + " reference\nprints every word of the scene language. ";
  page += "The documentation begins at docs/README.md, which an installed package has in share/doc/fissure.\n";
  return page;
}

std::string bash_completion(CLI::App const& app) {
  std::string const name = app.get_name();
  std::vector<std::string> verbs, kinds;
  for (auto const* command : commands(app)) verbs.push_back(command->get_name());
  for (auto const& start : starts()) kinds.emplace_back(start.kind);
  std::string cases;
  for (auto const* command : commands(app)) {
    std::vector<std::string> words{"--help"};
    for (auto const* option : options(*command))
      if (!option->get_positional()) words.push_back(option->get_name(false, true));
    cases += fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), fmt::join(words, " "));
  }
  std::string text = R"(# Completion for bash, written by PROGRAM reference --completion.
_PROGRAM() {
  local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" words="" i scene=""
  [[ $before == "=" && $COMP_CWORD -gt 1 ]] && return
  if [[ $COMP_CWORD -eq 1 ]]; then
    COMPREPLY=($(compgen -W "VERBS --help --version" -- "$word"))
    return
  fi
  case "$before" in
    --backend) COMPREPLY=($(compgen -W "auto cpu cuda" -- "$word")); return ;;
    --precision) COMPREPLY=($(compgen -W "double single" -- "$word")); return ;;
    --out) COMPREPLY=($(compgen -d -- "$word")); return ;;
    --set)  # the scene's own parameters
      for ((i = 2; i < COMP_CWORD; ++i)); do [[ ${COMP_WORDS[i]} == *.lua ]] && scene="${COMP_WORDS[i]}"; done
      [[ -n $scene ]] && words=$("${COMP_WORDS[0]}" params "$scene" 2>/dev/null | awk '/\(default /{ print $1 "=" }')
      compopt -o nospace
      COMPREPLY=($(compgen -W "$words" -- "$word"))
      return ;;
    --threads | --device | --time) return ;;
  esac
  case "${COMP_WORDS[1]}" in
CASES  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  elif [[ ${COMP_WORDS[1]} == new && $COMP_CWORD -eq 2 ]]; then
    COMPREPLY=($(compgen -W "KINDS" -- "$word"))
  elif [[ ${COMP_WORDS[1]} == restart ]]; then
    COMPREPLY=($(compgen -d -- "$word"))
  else
    compopt -o filenames
    COMPREPLY=($(compgen -f -X '!*.lua' -- "$word") $(compgen -d -- "$word"))
  fi
}
complete -F _PROGRAM PROGRAM
_fissure_plot() {
  local word="${COMP_WORDS[COMP_CWORD]}"
  case "${COMP_WORDS[COMP_CWORD - 1]}" in
    --field) COMPREPLY=($(compgen -W "FIELDS" -- "$word")); return ;;
    --only) COMPREPLY=($(compgen -W "curves energy cracks fragments animation" -- "$word")); return ;;
    --frames) return ;;
  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "--field --only --frames --help" -- "$word"))
  else
    COMPREPLY=($(compgen -d -- "$word"))
  fi
}
complete -F _fissure_plot fissure-plot plot.py
)";
  auto const put = [&](std::string const& what, std::string const& with) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
      text.replace(at, what.size(), with);
  };
  put("PROGRAM", name);
  put("VERBS", fmt::format("{}", fmt::join(verbs, " ")));
  put("KINDS", fmt::format("{}", fmt::join(kinds, " ")));
  put("CASES", cases);
  put("FIELDS", fmt::format("{}", fmt::join(scene::output_fields(), " ")));
  return text;
}

}  // namespace fissure::app
