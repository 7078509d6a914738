#include "identify/files/run_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/numbers.h"
#include "base/text.h"
#include "identify/files/columns.h"
#include "identify/files/diagnosis_file.h"
#include "identify/files/kept_work.h"
#include "identify/files/run_groups.h"
#include "identify/files/searches.h"
#include "identify/files/trace.h"
#include "identify/text/findings.h"
#include "identify/text/reasons.h"
#include "identify/text/warnings.h"

namespace sinew {
namespace {

std::vector<std::string> FreeNames(const FitSetup& setup) {
  std::vector<std::string> names;
  for (const int index : setup.free) names.push_back(setup.parameters[static_cast<std::size_t>(index)].name);
  return names;
}

void WriteStages(const std::vector<Stage>& stages, Hdf5Node& node) {
  std::vector<std::string> solver, stop;
  std::vector<double> cost, evaluations, x;
  for (const Stage& stage : stages) {
    solver.push_back(stage.solver);
    stop.emplace_back(ToString(stage.stop.kind));
    cost.push_back(stage.cost);
    evaluations.push_back(static_cast<double>(stage.evaluations));
    x.insert(x.end(), stage.x.data(), stage.x.data() + stage.x.size());
  }
  const std::size_t width = stages.empty() ? 0 : static_cast<std::size_t>(stages.front().x.size());
  node.At("solver").data = std::move(solver);
  node.At("stop_reason").data = std::move(stop);
  node.At("cost").SetVector(std::move(cost));
  node.At("evaluations").SetVector(std::move(evaluations));
  node.At("x").SetMatrix(stages.size(), width, std::move(x));
}

std::vector<double> RowMajor(const Matrix& matrix) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
  }
  return values;
}

void WriteUncertainty(const FitSetup& setup, const Uncertainty& uncertainty, Hdf5Node& node) {
  std::vector<std::string> name, verdict, reason, reason_kind, partners, remedy, remedy_kind, interval;
  std::vector<double> error, robust, lower, upper;
  for (const ParameterVerdict& v : uncertainty.parameters) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(v.parameter)];
    name.push_back(p.name);
    verdict.emplace_back(ToString(v.verdict));
    reason.push_back(text::ReasonText(p, v));
    reason_kind.emplace_back(ToString(v.reason.kind));
    partners.push_back(Join(v.reason.partners, ","));
    remedy.push_back(text::RemedyText(p, v.remedy));
    remedy_kind.emplace_back(ToString(v.remedy.kind));
    interval.emplace_back(ToString(v.interval));
    error.push_back(std::isfinite(v.std_error) ? v.std_error : kNaN);
    robust.push_back(std::isfinite(v.std_error_robust) ? v.std_error_robust : kNaN);
    lower.push_back(v.interval == IntervalKind::kNone ? kNaN : v.ci95_lower);
    upper.push_back(v.interval == IntervalKind::kNone ? kNaN : v.ci95_upper);
  }
  const std::size_t n = uncertainty.parameters.size();
  node.At("name").data = std::move(name);
  node.At("verdict").data = std::move(verdict);
  node.At("reason").data = std::move(reason);
  node.At("reason_kind").data = std::move(reason_kind);
  node.At("reason_partners").data = std::move(partners);
  node.At("remedy").data = std::move(remedy);
  node.At("remedy_kind").data = std::move(remedy_kind);
  node.At("interval").data = std::move(interval);
  std::vector<std::string> directions;
  for (const OpenDirection& direction : uncertainty.directions)
    directions.push_back(text::DirectionText(direction));
  node.At("directions").data = std::move(directions);
  node.At("std_error").SetVector(std::move(error));
  node.At("std_error_robust").SetVector(std::move(robust));
  node.At("ci95_lower").SetVector(std::move(lower));
  node.At("ci95_upper").SetVector(std::move(upper));
  node.At("covariance").SetMatrix(n, n, RowMajor(uncertainty.covariance));
  node.At("correlation").SetMatrix(n, n, RowMajor(uncertainty.correlation));
  const Vector& s = uncertainty.singular_values;
  node.At("singular_values").SetVector({s.data(), s.data() + s.size()});
}

void WriteAlternatives(const Identification& identification, Hdf5Node& root) {
  if (identification.alternatives.empty()) return;
  std::vector<std::string> prediction, trial, channel;
  std::vector<double> rmse, half_width;
  for (const AlternativeQuality& alternative : identification.alternatives) {
    half_width.insert(half_width.end(), alternative.half_width.begin(), alternative.half_width.end());
    for (const FitQuality& quality : alternative.quality) {
      prediction.push_back(alternative.name);
      trial.push_back(quality.trial);
      channel.push_back(quality.channel);
      rmse.push_back(quality.rmse);
    }
  }
  Hdf5Node& node = root.At("alternatives");
  node.At("prediction").data = std::move(prediction);
  node.At("trial").data = std::move(trial);
  node.At("channel").data = std::move(channel);
  node.At("rmse").SetVector(std::move(rmse));
  node.At("band95_half_width").SetVector(std::move(half_width));
}

// Beside the prediction of each channel.
void WriteUnmeasured(const Identification& identification, Hdf5Node& root) {
  for (const UnmeasuredChannel& channel : identification.unmeasured) {
    Hdf5Node& node = root.At("prediction/" + channel.trial + "/" + channel.channel);
    node.attributes["from"] = channel.from;
    node.At("band95_half_width")
        .SetVector({channel.half_width.data(), channel.half_width.data() + channel.half_width.size()});
  }
}

void WriteDerived(const Identification& identification, Hdf5Node& root) {
  if (!identification.figures.empty()) {
    Hdf5Node& node = root.At("figures");
    std::vector<std::string> name, meaning;
    std::vector<double> value;
    for (const FigureOfMerit& figure : identification.figures) {
      name.push_back(figure.name);
      meaning.push_back(text::Meaning(figure));
      value.push_back(figure.value);
    }
    node.At("name").data = std::move(name);
    node.At("meaning").data = std::move(meaning);
    node.At("value").SetVector(std::move(value));
  }
  if (identification.derived.empty()) return;
  Hdf5Node& node = root.At("derived");
  std::vector<std::string> name, unit, meaning, from;
  std::vector<double> value, lower, upper;
  for (const DerivedResult& one : identification.derived) {
    name.push_back(one.name);
    unit.push_back(one.unit);
    meaning.push_back(one.meaning);
    from.push_back(Join(one.from, ","));
    value.push_back(one.value);
    lower.push_back(one.interval ? one.ci95_lower : kNaN);
    upper.push_back(one.interval ? one.ci95_upper : kNaN);
  }
  node.At("name").data = std::move(name);
  node.At("unit").data = std::move(unit);
  node.At("meaning").data = std::move(meaning);
  node.At("from").data = std::move(from);
  node.At("value").SetVector(std::move(value));
  node.At("ci95_lower").SetVector(std::move(lower));
  node.At("ci95_upper").SetVector(std::move(upper));
}

// A seed has 64 bits, more than a double holds: it is read as the integer that was written.
std::uint64_t SeedOf(const Hdf5Node& run) {
  const auto seed = run.attributes.find("seed");
  const auto* integer = seed == run.attributes.end() ? nullptr : std::get_if<std::int64_t>(&seed->second);
  return integer == nullptr ? 1 : static_cast<std::uint64_t>(*integer);
}

// What other data, or a model without some effects, need not have. A nuisance value of a trial, or one with a
// prior, belongs to the data; one without is part of the model, as a control point of a curve. An effect at
// its null is part of neither. Runs of earlier versions may not have these columns; then nothing is marked,
// and without `null` every effect that was not fitted counts as at its null.
void FindDispensable(const Hdf5Node& root, RecordedRun& run) {
  const std::size_t count = run.values.size();
  const auto texts = [&](const char* name) {
    const Hdf5Node* node = root.Find(std::string("parameters/") + name);
    const auto* column = node == nullptr ? nullptr : node->texts();
    return column != nullptr && column->size() == count ? column : nullptr;
  };
  const auto numbers = [&](const char* name) {
    const Hdf5Node* node = root.Find(std::string("parameters/") + name);
    const auto* column = node == nullptr ? nullptr : node->array();
    return column != nullptr && column->values.size() == count ? &column->values : nullptr;
  };
  const auto* kinds = texts("kind");
  const auto* trials = texts("trial");
  const auto* free = numbers("free");
  const auto* priors = numbers("prior_deviation");
  const auto* nulls = numbers("null");
  if (kinds == nullptr || trials == nullptr || free == nullptr || priors == nullptr) return;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [name, value] = run.values[i];
    const bool of_data = !(*trials)[i].empty() || !std::isnan((*priors)[i]);
    if ((*kinds)[i] == "nuisance" && of_data) run.incidental.insert(name);
    const bool null = nulls == nullptr || value == (*nulls)[i];
    if ((*kinds)[i] == "effect" && (*free)[i] == 0 && null) run.at_null.insert(name);
  }
}

}  // namespace

Result<Hdf5Node> RunTree(const Problem& problem, const Identification& identification,
                         const Provenance& provenance) {
  Hdf5Node root;
  Hdf5Node& run = root.At("run");
  files::WriteProvenance(provenance, identification.solver, identification.solver_options.seed, run);
  const SolverResult& result = identification.result;
  run.attributes["finished"] = std::int64_t{identification.interrupted ? 0 : 1};
  run.attributes["stop_reason"] = std::string(ToString(result.stop.kind));
  run.attributes["stop_test"] = result.stop.test;
  run.attributes["converged"] = std::int64_t{result.stop.converged() ? 1 : 0};
  run.attributes["usable"] = std::int64_t{result.stop.usable() ? 1 : 0};
  run.attributes["evaluations"] = static_cast<std::int64_t>(identification.record.evaluations());
  run.attributes["failures"] = static_cast<std::int64_t>(identification.failures);
  run.attributes["iterations"] = std::int64_t{result.iterations};
  run.attributes["steps"] = static_cast<std::int64_t>(identification.steps.size());
  run.attributes["seconds"] = identification.seconds;
  run.attributes["cost"] = result.cost;
  run.attributes["objective"] = problem.objective();
  files::WriteSentences(text::Findings(identification), identification.warnings,
                        text::Warnings(identification), run);
  files::WriteTrace(identification.record, FreeNames(identification.setup), root);
  if (!identification.finished.empty())
    files::WriteSearches(identification.finished, FreeNames(identification.setup).size(),
                         root.At("searches"));
  if (identification.interrupted)
    files::WriteKeptWork(identification.kept_residuals, identification.setup.record, root);
  if (!result.stages.empty()) WriteStages(result.stages, root.At("stages"));
  if (!result.stop.usable()) return root;

  files::WriteParameters(identification.setup, identification.parameters, root.At("parameters"));
  files::WritePredictions(problem.layout(), identification.prediction, root);
  WriteUncertainty(identification.setup, identification.uncertainty, root.At("uncertainty"));
  WriteDerived(identification, root);
  WriteAlternatives(identification, root);
  WriteUnmeasured(identification, root);
  SINEW_TRY(problem.WriteDetails(identification.parameters, root.At("details")));
  return root;
}

Hdf5Node UnfinishedRunTree(const LeastSquares& problem, const std::string& solver, std::uint64_t seed,
                           const Provenance& provenance, const Evaluator& evaluator) {
  Hdf5Node root;
  Hdf5Node& run = root.At("run");
  files::WriteProvenance(provenance, solver, seed, run);
  run.attributes["finished"] = std::int64_t{0};
  run.attributes["stop_reason"] = std::string("running");
  run.attributes["stop_test"] = std::string();
  run.attributes["converged"] = std::int64_t{0};
  run.attributes["usable"] = std::int64_t{evaluator.has_best() ? 1 : 0};
  run.attributes["evaluations"] = static_cast<std::int64_t>(evaluator.evaluations());
  run.attributes["failures"] = static_cast<std::int64_t>(evaluator.failures());
  run.attributes["iterations"] = std::int64_t{0};
  run.attributes["seconds"] = evaluator.seconds();
  run.attributes["cost"] = evaluator.has_best() ? evaluator.best().cost : kNaN;
  run.attributes["objective"] = problem.problem().objective();
  files::WriteTrace(evaluator.record(), FreeNames(problem.setup()), root);
  if (!evaluator.finished().empty())
    files::WriteSearches(evaluator.finished(), problem.setup().free.size(), root.At("searches"));
  files::WriteKeptWork(evaluator.kept_residuals(), problem.setup().record, root);
  const Vector best = evaluator.has_best() ? problem.Parameters(evaluator.best().x) : problem.setup().rest;
  files::WriteParameters(problem.setup(), best, root.At("parameters"));
  return root;
}

Result<RecordedRun> ReadRun(const std::string& path) {
  SINEW_ASSIGN(const Hdf5Node root, ReadHdf5(path));
  return RecordedRunOf(path, root);
}

Result<RecordedRun> RecordedRunOf(const std::string& path, const Hdf5Node& root) {
  const Hdf5Node* run = root.Find("run");
  if (run == nullptr || run->Text("sinew_schema") != "run/1") {
    return Fail("{}: is not a run file: expected /run with attribute sinew_schema = run/1", path);
  }
  RecordedRun recorded;
  recorded.problem = run->Text("problem");
  recorded.solver = run->Text("solver");
  recorded.data_hash = run->Text("data_hash");
  recorded.seed = SeedOf(*run);
  recorded.version = run->Text("version");
  const bool diagnosed = root.Find("diagnosis") != nullptr || recorded.solver == kDiagnoseSolver;
  recorded.cost = diagnosed ? kNaN : run->Number("cost", kNaN);
  const auto steps = WholeNumber(run->Number("steps", 0));
  constexpr long kMostSteps = 1000000;
  if (!steps || *steps < 0 || *steps > kMostSteps)
    return Fail("{}: /run: steps is {}, expected a count", path, run->Number("steps", 0));
  recorded.steps = static_cast<int>(*steps);
  recorded.finished = run->Number("finished", 0) == 1;
  const double starts = run->Number("starts", 0);
  recorded.starts = starts > 0 && starts <= kMostSteps ? static_cast<int>(starts) : 0;

  const Hdf5Node* names = root.Find("parameters/name");
  const Hdf5Node* values = root.Find("parameters/value");
  if (names != nullptr && values != nullptr) {
    if (names->texts() == nullptr || values->array() == nullptr ||
        names->texts()->size() != values->array()->values.size()) {
      return Fail("{}: /parameters/name and /parameters/value do not belong together", path);
    }
    for (std::size_t i = 0; i < names->texts()->size(); ++i) {
      recorded.values.emplace_back((*names->texts())[i], values->array()->values[i]);
    }
    FindDispensable(root, recorded);
  }
  SINEW_ASSIGN(files::RecordedTrace trace, files::ReadTrace(path, root));
  recorded.variables = std::move(trace.variables);
  recorded.record = std::move(trace.record);
  const auto evaluations = static_cast<std::size_t>(recorded.record.evaluations());
  SINEW_ASSIGN(recorded.finished_searches,
               files::ReadSearches(path, root, evaluations, recorded.variables.size()));
  SINEW_ASSIGN(files::KeptWork kept, files::ReadKeptWork(path, root, evaluations));
  recorded.kept_residuals = std::move(kept.residuals);
  recorded.fits = std::move(kept.fits);
  return recorded;
}

}  // namespace sinew
