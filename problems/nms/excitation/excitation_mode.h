// The problem nms bound for a mode that finds excitations, and what was found as grids of a data set.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "datasets/dataset.h"
#include "problems/bound_problem.h"
#include "problems/nms/excitation/search.h"

namespace sinew {

/// What is asked for besides the settings.
struct NmsModeChange {
  std::optional<NmsModeType> type;
  std::optional<double> alpha;
  std::optional<double> beta;
  std::optional<double> gamma;
  std::vector<std::string> synthesise;
  std::vector<std::string> adjust;

  /// Whether weights or muscles are given.
  [[nodiscard]] bool HasDetails() const;
  /// The mode of the settings, changed. Lists of another mode in the settings do not count. Errors: weights
  /// or muscles of a mode that is open loop.
  [[nodiscard]] Result<NmsMode> Over(NmsMode mode) const;
};

/// The excitations of a bound problem, once they are found.
class ExcitationMode {
 public:
  /// @param problem made with free.synthesised as unmeasured; must outlive the object
  ExcitationMode(NmsProblem& problem, NmsMode mode, FreeMuscles free)
      : problem_(problem), mode_(std::move(mode)), free_(std::move(free)) {}

  /// Errors: FindExcitations.
  Status Find(const Vector& parameters);
  /// Adds the grids excitations, excitations_measured, activations, muscle_forces and objective, on the
  /// frames' clock. @pre Find
  Status AddTo(std::map<std::string, Trial>& trials, const Vector& parameters) const;

  [[nodiscard]] const std::vector<std::string>& muscles() const { return problem_.data().muscles; }
  [[nodiscard]] const NmsMode& mode() const { return mode_; }
  [[nodiscard]] const FreeMuscles& free() const { return free_; }
  /// One of each trial. @pre Find
  [[nodiscard]] const std::vector<FoundExcitations>& found() const { return found_; }

 private:
  NmsProblem& problem_;
  NmsMode mode_;
  FreeMuscles free_;
  std::vector<FoundExcitations> found_;
};

/// A problem whose excitations are found, and what finds them.
struct BoundMode {
  BoundProblem bound;
  std::unique_ptr<ExcitationMode> mode;  ///< refers to the problem
};

/// @param settings the document of --config, or of the data set's file nms.yaml
/// @return without problem and mode where the mode is open loop. Errors: of the settings, the data, the mode
Result<BoundMode> BindWithMode(const Dataset& data, const YamlReader& settings, const NmsModeChange& change);

}  // namespace sinew
