// The view that solvers have of a fit: a box [0, 1]^n, residuals and their Jacobian. Which parameters these
// are, on which scale, and from which trials, they do not know.
#pragma once

#include <memory>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/layout.h"
#include "identify/problem.h"

namespace sinew {

/// Jacobian of the residuals, one dense piece per block that holds only the variables the block depends on.
struct SparseJacobian {
  struct Piece {
    int first_row = 0;
    std::vector<int> variables;  ///< [n_b] increasing
    Matrix values;               ///< [rows of the block x n_b]
  };
  std::vector<Piece> pieces;

  /// [rows x variables], zero where a block does not depend on a variable.
  [[nodiscard]] Matrix Dense(int rows, int variables) const;
};

/// A linear map of the residual rows of each training block, applied to residuals and Jacobian alike:
/// whitening.
class RowTransform {
 public:
  RowTransform() = default;
  virtual ~RowTransform() = default;
  RowTransform(const RowTransform&) = delete;
  RowTransform& operator=(const RowTransform&) = delete;
  /// In place. @param train_block index into LeastSquares::train_blocks() @param rows [samples of the block x
  /// any]
  virtual void Apply(int train_block, Eigen::Ref<Matrix> rows) const = 0;
};

/// Cost = half the sum of squared residuals over the training blocks, plus half of ((p - mean) / deviation)^2
/// per prior.
class LeastSquares {
 public:
  /// Scratch of one thread.
  struct Workspace {
    std::unique_ptr<Problem::Workspace> problem;
    Prediction prediction;
    Vector parameters;
    Vector residuals;
  };

  /// Both must outlive this object. @pre the setup was made for this problem.
  LeastSquares(const Problem& problem, const FitSetup& setup);

  [[nodiscard]] int variables() const { return static_cast<int>(setup_.free.size()); }
  [[nodiscard]] int residuals() const { return rows_; }
  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const FitSetup& setup() const { return setup_; }
  /// Training blocks with their first residual row.
  struct TrainBlock {
    int block = 0;
    int first_row = 0;
  };
  [[nodiscard]] const std::vector<TrainBlock>& train_blocks() const { return train_blocks_; }

  /// From now on residuals pass through `transform`, which must outlive its use; nullptr: as they are.
  void set_transform(const RowTransform* transform) { transform_ = transform; }

  [[nodiscard]] Workspace NewWorkspace() const;
  /// A Jacobian of the right shape, to be filled again and again without allocation.
  [[nodiscard]] SparseJacobian NewJacobian() const;

  /// All parameters [P] at the variables x [n, within 0..1; outside values are clamped].
  [[nodiscard]] Vector Parameters(const Vector& x) const;
  void ParametersInto(const Vector& x, Vector& parameters) const;
  /// Variables at parameters [P].
  [[nodiscard]] Vector Variables(const Vector& parameters) const;
  /// Variables of the starts.
  [[nodiscard]] Vector Start() const { return Variables(setup_.rest); }
  /// dp/dx of each variable [n].
  [[nodiscard]] Vector Slopes(const Vector& x) const;

  /// Residuals [m] and, if asked for, their Jacobian for x. Errors: the problem's own, or a residual that is
  /// not finite.
  Status Evaluate(const Vector& x, Workspace& workspace, Vector& residuals, SparseJacobian* jacobian) const;
  /// Half the squared norm of the residuals.
  Result<double> Cost(const Vector& x, Workspace& workspace) const;

  /// Linear inequality constraints of the problem in terms of the variables at x: values [g <= 0] and, if not
  /// null, their Jacobian [constraints x n].
  [[nodiscard]] int constraints() const { return static_cast<int>(problem_.constraints().size()); }
  void Constraints(const Vector& x, Vector& values, Matrix* jacobian) const;

 private:
  struct Prior {
    int variable = 0;
    GaussianPrior density;
    bool logarithmic = false;
  };

  const Problem& problem_;
  const FitSetup& setup_;
  std::vector<TrainBlock> train_blocks_;
  std::vector<bool> wanted_;
  std::vector<int> variable_of_;     // [P], -1 if not free
  std::vector<bool> differentiate_;  // [P], true if free
  std::vector<Prior> priors_;
  int rows_ = 0;
  const RowTransform* transform_ = nullptr;
};

}  // namespace sinew
