// A problem seen through another layout: other roles of its trials, or other weights of its channels.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/alternative_prediction.h"
#include "identify/problem.h"
#include "identify/unmeasured_estimate.h"

namespace sinew {

/// Everything but the layout is that of the inner problem, which must outlive the view.
class ProblemView : public Problem {
 public:
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return inner_.parameters(); }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return inner_.effects(); }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return inner_.ports(); }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return inner_.constraints(); }
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return inner_.steps(); }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override { return inner_.NewWorkspace(); }
  [[nodiscard]] const char* default_solver() const override { return inner_.default_solver(); }
  [[nodiscard]] double cost_noise_level() const override { return inner_.cost_noise_level(); }
  [[nodiscard]] std::string objective() const override { return inner_.objective(); }
  [[nodiscard]] bool weights_are_noise_levels() const override { return inner_.weights_are_noise_levels(); }
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override {
    return inner_.WarningsAt(parameters);
  }
  [[nodiscard]] std::vector<DerivedQuantity> DerivedQuantities() const override {
    return inner_.DerivedQuantities();
  }
  [[nodiscard]] std::vector<FigureOfMerit> FiguresOfMerit(
      const Vector& parameters, const std::vector<Vector>& predicted) const override {
    return inner_.FiguresOfMerit(parameters, predicted);
  }
  [[nodiscard]] std::vector<AlternativePrediction> Alternatives(const Vector& parameters) const override {
    return inner_.Alternatives(parameters);
  }
  [[nodiscard]] std::optional<UnmeasuredEstimate> EstimateUnmeasured(
      const Vector& parameters) const override {
    return inner_.EstimateUnmeasured(parameters);
  }
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override {
    return inner_.ResidualCovariates(block);
  }
  [[nodiscard]] std::optional<Vector> ImprovedStart(const std::vector<int>& free,
                                                    const std::vector<bool>& compared,
                                                    const Vector& parameters) const override {
    return inner_.ImprovedStart(free, compared, parameters);
  }
  [[nodiscard]] Vector AtPriors(const Vector& parameters, const Vector& priors,
                                CarryOver how) const override {
    return inner_.AtPriors(parameters, priors, how);
  }
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override {
    return inner_.WriteDetails(parameters, details);
  }
  Result<bool> PredictWithInputNoise(const Query& query, std::uint64_t draw, Workspace& workspace,
                                     Prediction& prediction) const override {
    return inner_.PredictWithInputNoise(query, draw, workspace, prediction);
  }
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override {
    return inner_.Predict(query, workspace, prediction);
  }

 protected:
  explicit ProblemView(const Problem& inner) : layout_(inner.layout()), inner_(inner) {}

  Layout layout_;

 private:
  const Problem& inner_;
};

/// With any change of its blocks. Numbers of blocks and predictions must stay.
class EditedView final : public ProblemView {
 public:
  /// @param inner must outlive the view @param edit called once with every block
  template <class Edit>
  EditedView(const Problem& inner, const Edit& edit) : ProblemView(inner) {
    for (Block& block : layout_) edit(block);
  }
};

}  // namespace sinew
