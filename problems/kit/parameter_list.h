// One way for all problems to declare parameters, the effects that release them, and ports of unknown terms.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "identify/effect.h"
#include "identify/parameter.h"

namespace sinew {

struct ParameterList {
  std::vector<Parameter> parameters;
  std::vector<Effect> effects;
  std::vector<DiscrepancyPort> ports;
  /// [slots of the problem's law] index of a slot's parameter; -1: it has none. Empty if the problem has no
  /// slots.
  std::vector<int> index;
};

/// Beyond CheckParameters: effects have distinct names that are not empty, and at least one parameter each,
/// which names its effect; every effect parameter belongs to an effect or to a term of a port.
/// Errors: the first of these that does not hold, with the names.
[[nodiscard]] Status CheckParameterList(const ParameterList& list);

/// Appends to a list. Slots are the places of a problem's law (an enumeration from 0).
class ParameterListBuilder {
 public:
  static constexpr int kNoSlot = -1;

  /// @param list must outlive this.
  explicit ParameterListBuilder(ParameterList& list) : list_(list) {}
  /// @param slots number of the law's slots; none of them has a parameter yet.
  ParameterListBuilder(ParameterList& list, int slots);

  /// Of no effect. @return its index
  int Add(Parameter p, int slot = kNoSlot);

  /// Begins an effect; the numbers that follow belong to it. @param source of the numbers
  /// @param trial the only one that shows it; empty: all
  ParameterListBuilder& BeginEffect(const std::string& name, Level level, const std::string& description,
                                    const std::string& revealing_experiment, const std::string& source = "",
                                    const std::string& trial = "");
  /// Of the effect that was begun last; occasional unless this says otherwise.
  ParameterListBuilder& Is(Occurrence occurrence);
  /// A number of the effect that was begun last. @return its index
  int AddNumber(const std::string& name, const std::string& unit, const std::string& meaning, double lower,
                double upper, double null = 0, int slot = kNoSlot);
  /// Any parameter as a number of that effect: it rests at its start and has no prior. @return its index
  int AddNumber(Parameter p, int slot = kNoSlot);

  ParameterListBuilder& Number(int slot, const std::string& name, const std::string& unit,
                               const std::string& meaning, double lower, double upper, double null = 0);
  /// From 0, its null, to upper.
  ParameterListBuilder& Positive(int slot, const std::string& name, const std::string& unit,
                                 const std::string& meaning, double upper);
  /// From -reach to reach, null 0.
  ParameterListBuilder& TwoSided(int slot, const std::string& name, const std::string& unit,
                                 const std::string& meaning, double reach);
  /// Of the last parameter.
  void Probes(std::vector<double> probes);
  void NullStep(double step);

  /// An effect of one number, as another list has it.
  void Copy(const Effect& effect, const std::vector<Parameter>& parameters, int slot = kNoSlot);

  void BeginPort(const std::string& name, const std::string& unit, const std::string& meaning);
  /// Begins a term PORT(SIGNAL) of the port that was begun last; its knots are added one by one.
  void BeginTerm(const std::string& signal, const std::string& signal_unit, std::vector<double> knots);
  /// The weight at the next knot of that term; it rests at its start. @return its index
  int AddKnot(Parameter p, int slot = kNoSlot);
  /// A term with all its knots, PORT(SIGNAL)[0], ... . @param lower, upper of a weight; its null is 0.
  /// @param meaning of a weight, before "where SIGNAL is knot K". @param first_slot of the first; the others
  /// follow.
  void Term(const std::string& signal, const std::string& signal_unit, const std::vector<double>& knots,
            double lower, double upper, const std::string& meaning, int first_slot);

 private:
  ParameterList& list_;
  std::string source_;
};

}  // namespace sinew
