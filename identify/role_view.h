// A problem with other roles of its trials: a held-out trial is fitted, or a fitted one is held out.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "identify/problem.h"

namespace sinew {

/// Everything but the roles is that of the inner problem, which must outlive the view.
class RoleView final : public Problem {
 public:
  /// @param role the new role of each block
  RoleView(const Problem& inner, const std::function<BlockRole(const Block&)>& role)
      : inner_(inner), layout_(inner.layout()) {
    for (Block& block : layout_) block.role = role(block);
  }
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return inner_.parameters(); }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return inner_.effects(); }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return inner_.ports(); }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return inner_.constraints(); }
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return inner_.steps(); }
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const override { return inner_.NewWorkspace(); }
  [[nodiscard]] double cost_noise_level() const override { return inner_.cost_noise_level(); }
  [[nodiscard]] std::string objective() const override { return inner_.objective(); }
  [[nodiscard]] std::vector<Warning> WarningsAt(const Vector& parameters) const override {
    return inner_.WarningsAt(parameters);
  }
  [[nodiscard]] std::vector<DerivedQuantity> DerivedQuantities() const override {
    return inner_.DerivedQuantities();
  }
  [[nodiscard]] std::vector<FigureOfMerit> FiguresOfMerit(
      const std::vector<Vector>& predicted) const override {
    return inner_.FiguresOfMerit(predicted);
  }
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override {
    return inner_.ResidualCovariates(block);
  }
  [[nodiscard]] std::optional<Vector> ImprovedStart(const std::vector<int>& free,
                                                    const std::vector<bool>& compared,
                                                    const Vector& parameters) const override {
    return inner_.ImprovedStart(free, compared, parameters);
  }
  Status WriteDetails(const Vector& parameters, Hdf5Node& details) const override {
    return inner_.WriteDetails(parameters, details);
  }
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override {
    return inner_.Predict(query, workspace, prediction);
  }

 private:
  const Problem& inner_;
  Layout layout_;
};

}  // namespace sinew
