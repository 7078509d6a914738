#include "identify/diagnosis/fit/base_fit_record.h"

#include <utility>

#include "base/numbers.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kNumbers = 3;  // before the point: cost, iterations, kind of the stop

}  // namespace

BaseFitRecord::BaseFitRecord(const LeastSquares& fit, const std::string& solver, std::uint64_t seed)
    : record_(fit.setup().record), variables_(static_cast<std::size_t>(fit.variables())) {
  question_.Add("base fit").Add(solver).Add(seed);
  fit.AddTo(question_);
}

std::optional<SolverResult> BaseFitRecord::Find() const {
  const auto known = record_ == nullptr ? std::nullopt : record_->Find(question_);
  if (!known || known->numbers.size() != kNumbers + variables_) return std::nullopt;
  const auto iterations = WholeNumber(known->numbers[1]);
  const auto kind = WholeNumber(known->numbers[2]);
  constexpr long kLastUsable = static_cast<long>(Termination::kSolverFailed);
  if (!iterations || *iterations != static_cast<int>(*iterations) || !kind || *kind < 0 ||
      *kind > kLastUsable)
    return std::nullopt;
  SolverResult result;
  result.cost = known->numbers[0];
  result.iterations = static_cast<int>(*iterations);
  result.stop = {static_cast<Termination>(*kind), known->text};
  result.x = Eigen::Map<const Vector>(known->numbers.data() + kNumbers,
                                      static_cast<Eigen::Index>(known->numbers.size() - kNumbers));
  return result;
}

void BaseFitRecord::Keep(const SolverResult& result) const {
  if (record_ == nullptr || result.stop.kind == Termination::kInterrupted) return;
  if (!result.stop.usable()) return;  // not even the start may have been looked at
  FitRecord::Answer answer;
  answer.numbers = {result.cost, static_cast<double>(result.iterations),
                    static_cast<double>(static_cast<int>(result.stop.kind))};
  answer.numbers.insert(answer.numbers.end(), result.x.data(), result.x.data() + result.x.size());
  answer.text = result.stop.test;
  record_->Keep(question_, std::move(answer));
}

}  // namespace sinew::diagnosis
