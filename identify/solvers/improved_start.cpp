#include "identify/solvers/improved_start.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "identify/solvers/probed_start.h"

namespace sinew::solvers {
namespace {

std::optional<Vector> StartOfProblem(const LeastSquares& fit, const Vector& parameters) {
  std::vector<bool> compared;
  for (const Block& block : fit.problem().layout()) compared.push_back(block.role == BlockRole::kTrain);
  return fit.problem().ImprovedStart(fit.setup().free, compared, parameters);
}

// It may contain fits of its own, which the record of the setup does not see.
std::optional<Vector> RecordedStart(const LeastSquares& fit, const Vector& parameters) {
  FitRecord* const record = fit.setup().record;
  if (record == nullptr) return StartOfProblem(fit, parameters);
  Digest question;
  fit.AddTo(question);
  question.Add("improved start").Add(parameters.data(), static_cast<std::size_t>(parameters.size()));
  if (const auto known = record->Find(question); known) {
    if (known->numbers.empty()) return {};
    if (known->numbers.size() == static_cast<std::size_t>(parameters.size()))
      return Vector(Eigen::Map<const Vector>(known->numbers.data(), parameters.size()));
  }
  auto improved = StartOfProblem(fit, parameters);
  FitRecord::Answer answer;
  if (improved) answer.numbers.assign(improved->data(), improved->data() + improved->size());
  record->Keep(question, std::move(answer));
  return improved;
}

Vector LowerStart(const LeastSquares& fit) {
  Vector start = fit.Start();
  const auto improved = ImprovedStart(fit, fit.Parameters(start));
  return improved ? LowerOf(fit, std::move(start), fit.Variables(*improved)) : start;
}

}  // namespace

std::optional<Vector> ImprovedStart(const LeastSquares& fit, const Vector& parameters) {
  auto improved = RecordedStart(fit, parameters);
  if (!improved) return {};
  for (const int index : fit.setup().free) {
    const Parameter& p = fit.setup().parameters[static_cast<std::size_t>(index)];
    (*improved)[index] = std::clamp((*improved)[index], p.lower, p.upper);
  }
  return improved;
}

Vector BestStart(Evaluator& evaluator) {
  const LeastSquares& fit = evaluator.fit();
  const Vector start = LowerStart(fit);
  if (!HasProbes(fit.setup())) return start;
  // What is found before a limit of time ends the search is the answer then.
  const auto record = [&](const Vector& x) {
    double cost = 0;
    evaluator.Cost(x, cost);
  };
  record(start);
  return ProbedStart(fit, start, {[&] { return evaluator.StopRequested(); }, record});
}

}  // namespace sinew::solvers
