#include "identify/results/held_out.h"

#include <set>
#include <string>

#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/uncertainty/local_fit.h"

namespace sinew {
namespace {

constexpr long kEvaluations = 60;

// One held-out trial stands as the only training trial.
class OnlyThisTrial final : public Problem {
 public:
  OnlyThisTrial(const Problem& inner, const std::string& trial) : inner_(inner), layout_(inner.layout()) {
    for (Block& block : layout_) {
      const bool fitted = block.trial == trial && block.role == BlockRole::kValidate;
      block.role = fitted ? BlockRole::kTrain : BlockRole::kPredicted;
    }
  }
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return inner_.parameters(); }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override { return inner_.NewWorkspace(); }
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override {
    return inner_.Predict(query, workspace, prediction);
  }

 private:
  const Problem& inner_;
  Layout layout_;
};

}  // namespace

Result<Vector> FitHeldOutNuisance(const Problem& problem, const Vector& parameters) {
  std::set<std::string> held_out;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kValidate) held_out.insert(block.trial);
  }
  Vector answer = parameters;
  for (const std::string& trial : held_out) {
    FitSetup setup;
    setup.parameters = problem.parameters();
    setup.rest = answer;
    for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
      const Parameter& p = setup.parameters[i];
      if (p.kind == ParameterKind::kNuisance && p.trial == trial) setup.free.push_back(static_cast<int>(i));
    }
    if (setup.free.empty()) continue;
    const OnlyThisTrial alone(problem, trial);
    const LeastSquares least_squares(alone, setup);
    LocalFit fit(least_squares);
    const auto outcome = fit.Minimize(least_squares.Variables(answer), -1, {0, 1e-9}, kEvaluations);
    if (outcome.failure.empty()) answer = least_squares.Parameters(outcome.x);
  }
  return answer;
}

}  // namespace sinew
