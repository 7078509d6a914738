#include "identify/diagnosis/fit/folds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "identify/keep_samples.h"
#include "identify/solvers/held_out_nuisance.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMaxFolds = 10;
constexpr std::size_t kMinTrials = 4;        // that are left out as a whole
constexpr double kTiedInformation = 0.01;    // of all data
constexpr double kNuisanceTolerance = 1e-5;  // of a left-out trial's values, as of the fits to the others
constexpr std::size_t kWindows = 6;          // of fewer trials together, at least

double TimeOf(const Block& block, std::size_t i) {
  return block.prediction_time[static_cast<std::size_t>(block.sample[i])];
}

std::vector<Fold> WindowsOf(const Problem& problem, const std::vector<std::string>& trials) {
  std::map<std::string, TimeWindow> spans;
  for (const Block& block : problem.layout()) {
    if (block.role != BlockRole::kTrain || block.sample.empty()) continue;
    const double first = TimeOf(block, 0);
    const double last = TimeOf(block, block.sample.size() - 1);
    const auto [found, made] = spans.emplace(block.trial, TimeWindow{first, last});
    found->second = {std::min(found->second.first, first), std::max(found->second.last, last)};
  }
  const std::size_t each = (kWindows + trials.size() - 1) / trials.size();
  std::vector<Fold> folds;
  for (const auto& [trial, span] : spans) {
    const double width = (span.last - span.first) / static_cast<double>(each);
    for (std::size_t k = 0; k < each; ++k) {
      const double first = span.first + static_cast<double>(k) * width;
      const double last = k + 1 < each ? first + width : std::numeric_limits<double>::infinity();
      folds.push_back({{trial}, TimeWindow{first, last}});
    }
  }
  return folds;
}

}  // namespace

bool Fold::Has(const std::string& trial) const {
  return !window && std::binary_search(trials.begin(), trials.end(), trial);
}

bool Fold::LeavesOut(const Block& block, std::size_t i) const {
  if (!window) return Has(block.trial);
  if (block.trial != trials.front()) return false;
  const double t = TimeOf(block, i);
  return window->first <= t && t < window->last;
}

std::vector<std::string> TrainingTrials(const Problem& problem) {
  std::set<std::string> trials;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kTrain) trials.insert(block.trial);
  }
  return {trials.begin(), trials.end()};
}

std::vector<Fold> FoldsOf(const Problem& problem) {
  const std::vector<std::string> trials = TrainingTrials(problem);
  if (!trials.empty() && trials.size() < kMinTrials) return WindowsOf(problem, trials);
  std::vector<Fold> folds(std::min(trials.size(), kMaxFolds));
  for (std::size_t i = 0; i < trials.size(); ++i) folds[i % folds.size()].trials.push_back(trials[i]);
  return folds;
}

FoldView::FoldView(const Problem& inner, const Fold& fold) : ProblemView(inner) {
  for (Block& block : layout_) {
    if (block.role != BlockRole::kTrain) {
      block.role = BlockRole::kPredicted;
    } else if (fold.Has(block.trial)) {
      block.role = BlockRole::kValidate;
    } else if (fold.window && block.trial == fold.trials.front() && !block.measured.empty()) {
      const Block whole = block;
      KeepSamples([&](std::size_t i) { return !fold.LeavesOut(whole, i); }, block);
    }
  }
}

FitSetup WithoutLeftOut(FitSetup setup, const Fold& fold) {
  std::vector<int> free;
  for (const int index : setup.free) {
    if (!fold.Has(setup.parameters[static_cast<std::size_t>(index)].trial)) free.push_back(index);
  }
  setup.free = std::move(free);
  return setup;
}

FitSetup WithTiedNuisance(FitSetup setup, const Fold& fold, const Vector& norms, const Vector& fitted) {
  if (!fold.window) return setup;
  for (std::size_t v = 0; v < setup.free.size(); ++v) {
    const int index = setup.free[v];
    Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    const double norm = norms[static_cast<Eigen::Index>(v)];
    const bool own = std::binary_search(fold.trials.begin(), fold.trials.end(), p.trial);
    if (p.kind != ParameterKind::kNuisance || !own || p.prior || !(norm > 0)) continue;
    // Per variable of the search, of which the norms are.
    const bool logarithmic = p.scale == Scale::kLog;
    const double range = logarithmic ? std::log(p.upper / p.lower) : p.upper - p.lower;
    p.prior = GaussianPrior{logarithmic ? std::log(fitted[index]) : fitted[index],
                            range / (std::sqrt(kTiedInformation) * norm)};
  }
  return setup;
}

Result<Vector> LeftOutResiduals(const Problem& problem, const Fold& fold, const Vector& parameters,
                                FitRecord* record) {
  Vector at = parameters;
  if (!fold.window) {
    solvers::HeldOutSearch search;
    search.tolerance = kNuisanceTolerance;
    at = solvers::FitHeldOutNuisance(FoldView(problem, fold), parameters, record, search);
  }
  const Layout& layout = problem.layout();
  std::vector<bool> wanted(layout.size(), false);
  for (std::size_t b = 0; b < layout.size(); ++b) {
    wanted[b] = layout[b].role == BlockRole::kTrain &&
                std::binary_search(fold.trials.begin(), fold.trials.end(), layout[b].trial);
  }
  Prediction prediction(layout);
  const auto workspace = problem.NewWorkspace();
  SINEW_TRY(problem.Predict({at, wanted, false, nullptr}, *workspace, prediction));
  std::vector<double> residuals;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    if (!wanted[b]) continue;
    const auto values = prediction.values(static_cast<int>(b));
    for (std::size_t i = 0; i < block.measured.size(); ++i) {
      if (fold.LeavesOut(block, i))
        residuals.push_back(block.WeightOf(i) * (values[block.sample[i]] - block.measured[i]));
    }
  }
  return Vector(Eigen::Map<const Vector>(residuals.data(), static_cast<Eigen::Index>(residuals.size())));
}

}  // namespace sinew::diagnosis
