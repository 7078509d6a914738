// The modes of `sinew simulate nms` that find excitations: words, binding and output.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/binding.h"
#include "cli/command.h"
#include "problems/nms/excitation/search.h"

namespace sinew {

struct ModeWords {
  std::string type;
  std::optional<double> alpha;
  std::optional<double> beta;
  std::optional<double> gamma;
  std::vector<std::string> synthesise;
  std::vector<std::string> adjust;

  void AddTo(Command command);
  /// Errors: a problem without modes; words that need --mode.
  [[nodiscard]] Status CheckFor(const std::string& problem) const;
  /// What the settings ask for, changed by the words. Lists of another mode in the settings do not count.
  [[nodiscard]] Result<NmsMode> Over(NmsMode mode) const;
};

/// The excitations of a bound nms problem, once they are found.
class ExcitationMode {
 public:
  ExcitationMode(NmsProblem& problem, NmsMode mode, FreeMuscles free)
      : problem_(problem), mode_(std::move(mode)), free_(std::move(free)) {}

  /// Errors: FindExcitations.
  Status Find(const Vector& parameters);
  /// Grids excitations, excitations_measured, activations, muscle_forces and objective, on the frames' clock.
  Status AddTo(std::map<std::string, Trial>& trials, const Vector& parameters) const;
  /// What was minimised, per trial; notes to stderr.
  void Print() const;

 private:
  NmsProblem& problem_;
  NmsMode mode_;
  FreeMuscles free_;
  std::vector<FoundExcitations> found_;
};

/// @param mode stays empty where the mode is open loop; then there is no problem in the binding.
Result<Binding> BindWithMode(const BindingOptions& options, const ModeWords& words,
                             std::unique_ptr<ExcitationMode>& mode);

}  // namespace sinew
