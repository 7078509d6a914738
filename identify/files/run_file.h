// The file that an identification leaves: docs/run_file.md.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "identify/identification/identification.h"

namespace sinew {

/// Where a run came from.
struct Provenance {
  std::string problem;
  std::string data_file;
  std::string data_hash;
  std::string title;
  std::string config;  ///< YAML text, may be empty
  bool synthetic = false;
  int starts = 0;  ///< of solver multistart; 0: of another one
};

/// A finished run. Errors: those of Problem::Describe.
Result<Hdf5Node> RunTree(const Problem& problem, const Identification& identification,
                         const Provenance& provenance);

/// A run that still goes on: what it needs to be resumed, and the best point so far.
Hdf5Node UnfinishedRunTree(const LeastSquares& problem, const std::string& solver, std::uint64_t seed,
                           const Provenance& provenance, const Evaluator& evaluator);

/// What is taken from an earlier run to resume it, or to start from its answer.
struct RecordedRun {
  std::string problem;
  std::string solver;
  std::string data_hash;
  std::uint64_t seed = 1;
  std::string version;
  double cost =
      0;  ///< of its values; NaN if there are none, or of a diagnosis, whose cost is of other residuals
  int starts = 0;  ///< see Provenance
  int steps = 0;   ///< of a stepwise fit: those before the last, of which alone cost and trace are
  bool finished = false;
  std::vector<std::string> variables;  ///< names of the free parameters
  SearchRecord record;
  std::vector<FinishedSearch> finished_searches;
  std::vector<KeptResiduals> kept_residuals;           ///< of an unfinished run
  FitRecord::Answers fits;                             ///< the same
  std::vector<std::pair<std::string, double>> values;  ///< every parameter
  /// Nuisance values of trials or with a prior: other data need not have them.
  std::set<std::string> incidental;
  /// Effect parameters at their null that were not fitted: a model without these effects is the same.
  std::set<std::string> at_null;
};

/// Errors: not a run file, or damaged.
Result<RecordedRun> ReadRun(const std::string& path);
/// The same of a file's content. @param path for messages
Result<RecordedRun> RecordedRunOf(const std::string& path, const Hdf5Node& root);

/// JSON of `identify`, schema sinew.run/1 (CONTRACT).
[[nodiscard]] std::string RunJson(const Problem& problem, const Identification& identification,
                                  const Provenance& provenance);

}  // namespace sinew
