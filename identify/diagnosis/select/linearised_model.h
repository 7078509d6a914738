// A fitted model to first order: what each of its causes changes in the data, and what every candidate that
// it has not released would change.
#pragma once

#include <optional>
#include <vector>

#include "base/error.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/candidate.h"
#include "identify/diagnosis/score/design.h"

namespace sinew::diagnosis {

class LinearisedModel {
 public:
  /// @param nulls [P] where the candidates do nothing: the point of the base model. All arguments must
  /// outlive this.
  LinearisedModel(const Problem& problem, const std::vector<Candidate>& candidates, const Refit& model,
                  const Vector& nulls);

  /// Errors: those of Problem::Predict at the model's point. To be called first.
  Status Linearise();

  [[nodiscard]] const LeastSquares& fit() const { return fit_; }
  [[nodiscard]] const Design& design() const { return design_; }
  [[nodiscard]] const Vector& residual() const { return residual_; }  ///< [m] whitened
  [[nodiscard]] const Matrix& base() const { return base_; }          ///< [m x n] whitened
  [[nodiscard]] const Matrix& columns() const { return columns_; }    ///< [m x K] whitened

  /// Columns of the fitted variables, those of these candidates zero. Variables on a bound are among them:
  /// with other causes they may leave it.
  [[nodiscard]] Matrix BaseWithout(const std::vector<int>& causes) const;

  /// What a cause changes in the whitened residuals, to first order, from its null on: of two effects that do
  /// the same, this is the same, however large it is. Nothing where its parameters have no influence there.
  [[nodiscard]] std::optional<Vector> TangentOf(int cause) const;
  /// The whole change by the cause; nothing if that cannot be computed.
  [[nodiscard]] std::optional<Vector> SecantOf(int cause) const;

  /// Columns of the design of a candidate at one of its probes; empty if it has none there.
  [[nodiscard]] std::vector<Eigen::Index> ColumnsOf(int candidate, int probe) const;
  /// Variables of the fit that are parameters of a released candidate, but those with probe values (a period,
  /// a threshold), which have no influence at the null.
  [[nodiscard]] std::vector<Eigen::Index> VariablesOf(int released) const;

  /// Puts a cause to its null.
  void Remove(int cause, Vector& point) const;
  /// Puts a candidate to one of its probes, the scored parameters moved from their nulls by `change`, within
  /// their bounds. @param change one per column of ColumnsOf
  void Add(int candidate, int probe, const Vector& change, Vector& point) const;

 private:
  [[nodiscard]] Matrix Whitened(Matrix rows) const;
  [[nodiscard]] bool IsOf(int candidate, int parameter) const;
  [[nodiscard]] bool HasProbes(int index) const;

  const Problem& problem_;
  const std::vector<Candidate>& candidates_;
  const Refit& model_;
  const Vector& nulls_;
  LeastSquares fit_;
  noise::Whitening whitening_;
  Design design_;
  Vector residual_;
  Matrix base_;
  Matrix columns_;
};

}  // namespace sinew::diagnosis
