#include "identify/files/study_resume.h"

#include <algorithm>
#include <cmath>

#include "base/numbers.h"
#include "identify/files/columns.h"
#include "identify/files/origin.h"

namespace sinew::files {
namespace {

Status AddImprovements(const std::string& path, const Hdf5Node& study, std::vector<StudyRun>& runs) {
  const Hdf5Node* first = study.Find("improvements/run");
  const std::size_t count = first == nullptr || first->array() == nullptr ? 0 : first->array()->values.size();
  const auto* of_run = NumberColumn(study, "improvements/run", count);
  const auto* evaluation = NumberColumn(study, "improvements/evaluation", count);
  const auto* cost = NumberColumn(study, "improvements/cost", count);
  const auto* seconds = NumberColumn(study, "improvements/seconds", count);
  if (of_run == nullptr || evaluation == nullptr || cost == nullptr || seconds == nullptr)
    return Fail("{}: /study/improvements is not complete", path);
  for (std::size_t i = 0; i < count; ++i) {
    const double run = (*of_run)[i];
    if (!(run >= 0 && run < static_cast<double>(runs.size())))
      return Fail("{}: /study/improvements/run names a run that is not there", path);
    const auto at = WholeNumber((*evaluation)[i]);
    if (!at || *at < 0) return Fail("{}: /study/improvements/evaluation holds no whole number", path);
    runs[static_cast<std::size_t>(run)].improvements.push_back({*at, (*cost)[i], (*seconds)[i]});
  }
  return {};
}

}  // namespace

Result<std::vector<StudyRun>> ReadStudyRuns(const std::string& path, const FitSetup& setup,
                                            const Hdf5Node& origin) {
  SINEW_ASSIGN(const Hdf5Node root, ReadHdf5(path));
  return StudyRunsOf(path, root, setup, origin);
}

Result<std::vector<StudyRun>> StudyRunsOf(const std::string& path, const Hdf5Node& root,
                                          const FitSetup& setup, const Hdf5Node& origin) {
  const Hdf5Node* study = root.Find("study");
  if (study == nullptr || study->Text("sinew_schema") != "study/1")
    return Fail("{}: is not a study file: expected what `sinew compare` writes", path);
  const Hdf5Node* then = study->Find("origin");
  if (then == nullptr) return Fail("--resume: {} does not say what it was made from", path);
  SINEW_TRY(CheckSameOrigin(path, *then, origin));

  const Hdf5Node* names = study->Find("runs/solver");
  const std::size_t count = names == nullptr || names->texts() == nullptr ? 0 : names->texts()->size();
  const auto* solver = TextColumn(*study, "runs/solver", count);
  const auto* stop = TextColumn(*study, "runs/stop_reason", count);
  const auto* test = TextColumn(*study, "runs/stop_test", count);
  const auto* seed = NumberColumn(*study, "runs/seed", count);
  const auto* cost = NumberColumn(*study, "runs/cost", count);
  const auto* seconds = NumberColumn(*study, "runs/seconds", count);
  const auto* evaluations = NumberColumn(*study, "runs/evaluations", count);
  const auto* values = NumberColumn(*study, "runs/values", count * setup.free.size());
  if (solver == nullptr || stop == nullptr || test == nullptr || seed == nullptr || cost == nullptr ||
      seconds == nullptr || evaluations == nullptr || values == nullptr)
    return Fail("{}: /study/runs is not complete", path);
  std::vector<StudyRun> runs(count);
  for (std::size_t r = 0; r < count; ++r) {
    StudyRun& run = runs[r];
    const auto kind = TerminationOf((*stop)[r]);
    if (!kind) return Fail("{}: /study/runs/stop_reason '{}' is unknown", path, (*stop)[r]);
    run.solver = (*solver)[r];
    run.stop = {*kind, (*test)[r]};
    // Seeds of 64 bits were written as doubles, the last ones rounded up to 2^64.
    constexpr double kLastSeed = 18446744073709549568.0;
    const double run_seed = std::min((*seed)[r], kLastSeed);
    const auto evaluated = WholeNumber((*evaluations)[r]);
    if (!(run_seed >= 0) || !evaluated || *evaluated < 0)
      return Fail("{}: /study/runs/seed and evaluations: expected whole numbers", path);
    run.seed = static_cast<std::uint64_t>(run_seed);
    run.cost = (*cost)[r];
    run.seconds = (*seconds)[r];
    run.evaluations = *evaluated;
    if (!run.stop.usable()) continue;
    run.parameters = setup.rest;
    for (std::size_t k = 0; k < setup.free.size(); ++k)
      run.parameters[setup.free[k]] = (*values)[r * setup.free.size() + k];
  }
  SINEW_TRY(AddImprovements(path, *study, runs));
  return runs;
}

}  // namespace sinew::files
