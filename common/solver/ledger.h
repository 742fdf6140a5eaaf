// The energies of a run, told once: what is there, what came in, what was taken.
#pragma once
#include <array>
#include <string>

namespace fissure {

/// Energies [J] at the time of the last evaluate(); work terms are totals since the start.
struct Ledger {
  double kinetic = 0, elastic = 0, hourglass = 0, plastic = 0, joint = 0, fracture = 0, viscous = 0, mass_damping = 0,
         contact = 0, friction = 0, gravity = 0, removed = 0, excavated = 0, spring = 0, spring_lost = 0;
  double external = 0;  // work of loads and prescribed motion
  double plates = 0;    // work of plates
  double start = 0;     // what was stored at t = 0

  enum class Kind { stored, taken, given };
  struct Term {
    char const* name;
    Kind kind;
    double Ledger::*value;
  };
  /// By the names that scenes and files use; what plates do is shown as external, too.
  static constexpr std::array terms{
      Term{"kinetic", Kind::stored, &Ledger::kinetic},        Term{"elastic", Kind::stored, &Ledger::elastic},
      Term{"hourglass", Kind::stored, &Ledger::hourglass},    Term{"joint", Kind::stored, &Ledger::joint},
      Term{"gravity", Kind::stored, &Ledger::gravity},        Term{"contact", Kind::stored, &Ledger::contact},
      Term{"plastic", Kind::taken, &Ledger::plastic},         Term{"fracture", Kind::taken, &Ledger::fracture},
      Term{"viscous", Kind::taken, &Ledger::viscous},         Term{"mass_damping", Kind::taken, &Ledger::mass_damping},
      Term{"friction", Kind::taken, &Ledger::friction},       Term{"removed", Kind::taken, &Ledger::removed},
      Term{"excavated", Kind::taken, &Ledger::excavated},     Term{"spring", Kind::stored, &Ledger::spring},
      Term{"spring_lost", Kind::taken, &Ledger::spring_lost}, Term{"external", Kind::given, &Ledger::external},
      Term{"external", Kind::given, &Ledger::plates}};

  double sum(Kind kind, double from = 0) const {
    for (auto const& term : terms)
      if (term.kind == kind) from += this->*term.value;
    return from;
  }
  /// What came in minus what is there and what was taken: 0 but for errors of the method.
  double residual() const { return sum(Kind::given, start) - sum(Kind::stored) - sum(Kind::taken); }
};

}  // namespace fissure
