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
/// per prior, plus half of (weight * distance)^2 per block that left its range.
class LeastSquares {
 public:
  /// Scratch of one thread.
  struct Workspace {
    std::unique_ptr<Problem::Workspace> problem;
    Prediction prediction;
    Vector parameters;
    Vector residuals;
    Vector slopes;  // of a range
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

  /// Rows of the training blocks; rows of priors follow, then rows of ranges.
  [[nodiscard]] int data_rows() const { return data_rows_; }
  /// Variables of the priors, in the order of their rows.
  [[nodiscard]] std::vector<int> PriorVariables() const;

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

  /// The problem's linear inequality constraints, then its strict ranges.
  [[nodiscard]] int constraints() const {
    return static_cast<int>(problem_.constraints().size() + strict_ranges_.size());
  }
  [[nodiscard]] std::string ConstraintName(int constraint) const;
  /// In terms of the variables at x: values [g <= 0] and, if not null, their Jacobian [constraints x n].
  /// Errors: no prediction at x of a block with a strict range.
  Status Constraints(const Vector& x, Workspace& workspace, Vector& values, Matrix* jacobian) const;
  /// Sizes of the terms that a constraint sums up, to compare its value with [constraints].
  [[nodiscard]] Vector ConstraintSizes(const Vector& x) const;

 private:
  struct Prior {
    int variable = 0;
    GaussianPrior density;
    bool logarithmic = false;
  };

  [[nodiscard]] SparseJacobian::Piece NewPiece(const Block& block, int first_row, int rows) const;
  /// Multiplies a row of slopes [predictions] into d result / d variables [1 x variables of the block].
  void RowOf(const Vector& x, int block, const Prediction& prediction, const Vector& slopes,
             Eigen::Ref<Matrix> row) const;
  void EvaluatePriors(const Vector& x, const Workspace& workspace, Vector& residuals,
                      SparseJacobian* jacobian) const;
  void EvaluateRanges(const Vector& x, Workspace& workspace, Vector& residuals,
                      SparseJacobian* jacobian) const;

  const Problem& problem_;
  const FitSetup& setup_;
  std::vector<TrainBlock> train_blocks_;
  std::vector<int> ranges_;          // blocks
  std::vector<int> strict_ranges_;   // blocks
  std::vector<bool> wanted_;         // in a residual
  std::vector<bool> constrained_;    // in a strict range
  std::vector<int> variable_of_;     // [P], -1 if not free
  std::vector<bool> differentiate_;  // [P], true if free
  std::vector<Prior> priors_;
  int data_rows_ = 0;
  int rows_ = 0;
  const RowTransform* transform_ = nullptr;
};

}  // namespace sinew
