// A fit as solvers see it: minimise half the squared norm of a residual vector over the box [0, 1]^n.
// Parameters, units, scales and trials are hidden behind the variables of that box.
#pragma once

#include <memory>
#include <vector>

#include "base/digest.h"
#include "identify/fit_setup.h"
#include "identify/layout.h"
#include "identify/problem.h"

namespace sinew {

/// Jacobian of the residuals, as one dense piece per residual block, with columns only for the variables that
/// the block depends on. Pieces are in the order of the residual rows: training blocks, priors, ranges.
struct SparseJacobian {
  struct Piece {
    int first_row = 0;
    std::vector<int> variables;  ///< [n_b] increasing
    Matrix values;               ///< [rows of the block x n_b]
  };
  std::vector<Piece> pieces;

  /// [rows x variables], zero where a block does not depend on a variable.
  [[nodiscard]] Matrix Dense(int rows, int variables) const;
  /// J x [rows]. @param x [variables]
  [[nodiscard]] Vector Times(const Vector& x, Eigen::Index rows) const;
  /// J' y [variables]. @param y [rows]
  [[nodiscard]] Vector TransposedTimes(const Vector& y, Eigen::Index variables) const;
};

/// A linear map of the residual rows of each training block, applied to residuals and Jacobian alike: the
/// whitening by a noise model.
class RowTransform {
 public:
  RowTransform() = default;
  virtual ~RowTransform() = default;
  RowTransform(const RowTransform&) = delete;
  RowTransform& operator=(const RowTransform&) = delete;
  /// Replaces the rows in place.
  /// @param train_block index into LeastSquares::train_blocks()
  /// @param rows [samples of the block x any] residuals or columns of the Jacobian
  virtual void Apply(int train_block, Eigen::Ref<Matrix> rows) const = 0;
  /// Adds everything that Apply depends on.
  virtual void AddTo(Digest& digest) const = 0;
};

/// The weighted least-squares problem of a Problem and a FitSetup.
///
/// Variables x [n] are the free parameters of the setup in its order, each mapped to [0, 1] over its bounds:
/// p = lower + x (upper - lower), or p = lower (upper / lower)^x on a logarithmic scale. The bounds are met
/// exactly at 0 and 1.
///
/// Residuals [m], one row each, in this order:
/// 1. data_rows() rows of the training blocks, in the order of the layout:
///    weight_i (predicted_i - measured_i), after the transform if one is set;
/// 2. one row per free parameter with a prior: (p - mean) / deviation, of log p on a logarithmic scale;
/// 3. one row per block with a range that is not strict: weight * distance from the range.
/// Cost = half their squared norm. With weights of one over the noise level it is the negative logarithm of
/// the posterior density (Gaussian likelihood times priors), up to a constant.
///
/// Immutable but for set_transform: all const members may be called from several threads, each with its own
/// Workspace.
class LeastSquares {
 public:
  /// Scratch memory of one thread: Evaluate, Cost and Constraints overwrite it, and it carries no result from
  /// one call to the next.
  struct Workspace {
    std::unique_ptr<Problem::Workspace> problem;
    Prediction prediction;
    Vector parameters;
    Vector residuals;
    Vector slopes;  // derivative of a range's distance
  };

  /// Keeps references: both must outlive this object. Parameters that are not free stay at setup.rest.
  /// @pre the setup was made for this problem.
  LeastSquares(const Problem& problem, const FitSetup& setup);

  [[nodiscard]] int variables() const { return static_cast<int>(setup_.free.size()); }
  [[nodiscard]] int residuals() const { return rows_; }
  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const FitSetup& setup() const { return setup_; }
  /// A training block (index into the layout) and its first residual row.
  struct TrainBlock {
    int block = 0;
    int first_row = 0;
  };
  [[nodiscard]] const std::vector<TrainBlock>& train_blocks() const { return train_blocks_; }

  /// Number of rows of the training blocks; rows of priors follow, then rows of ranges.
  [[nodiscard]] int data_rows() const { return data_rows_; }
  /// Variables of the priors, in the order of their rows.
  [[nodiscard]] std::vector<int> PriorVariables() const;

  /// Applies `transform` to residuals and Jacobian of the training blocks from now on; nullptr: no transform.
  /// It must outlive its use. Not thread-safe.
  void set_transform(const RowTransform* transform) { transform_ = transform; }

  /// Adds everything that Evaluate, Constraints and noise models depend on and that differs between fits of
  /// one problem and its views: parameters, which are free, the values of the others, layout, transform.
  void AddTo(Digest& digest) const;

  [[nodiscard]] Workspace NewWorkspace() const;
  /// A Jacobian of the right shape for Evaluate, allocated once and reused.
  [[nodiscard]] SparseJacobian NewJacobian() const;

  /// All parameters [P] at the variables x [n, in 0..1; values outside are clamped].
  [[nodiscard]] Vector Parameters(const Vector& x) const;
  void ParametersInto(const Vector& x, Vector& parameters) const;
  /// Variables [n] at parameters [P]; the inverse of Parameters().
  [[nodiscard]] Vector Variables(const Vector& parameters) const;
  /// Variables of the start values.
  [[nodiscard]] Vector Start() const { return Variables(setup_.rest); }
  /// Derivative dp/dx of each free parameter for its own variable [n].
  [[nodiscard]] Vector Slopes(const Vector& x) const;

  /// Residuals and, if wanted, their Jacobian with respect to the variables.
  /// @param x [n, in 0..1]
  /// @param workspace from NewWorkspace(), one per thread
  /// @param residuals [m] resized and overwritten
  /// @param jacobian nullptr, or from NewJacobian(); its values are overwritten, its structure is kept. It
  /// holds d residuals / d x: the derivatives of Problem::Predict times the weights and dp/dx.
  /// @return an Error if there is no prediction at x: that of Problem::Predict, or a residual that is not
  /// finite; residuals and jacobian are then undefined. Entries of the Jacobian are not checked here.
  Status Evaluate(const Vector& x, Workspace& workspace, Vector& residuals, SparseJacobian* jacobian) const;
  /// Cost at x [n, in 0..1] without derivatives: half the squared norm of the residuals. Errors: those of
  /// Evaluate.
  Result<double> Cost(const Vector& x, Workspace& workspace) const;

  /// Number of inequality constraints: the problem's linear ones, then its strict ranges.
  [[nodiscard]] int constraints() const {
    return static_cast<int>(problem_.constraints().size() + strict_ranges_.size());
  }
  [[nodiscard]] std::string ConstraintName(int constraint) const;
  /// Constraints at x.
  /// @param values [constraints] resized and overwritten; satisfied where <= 0
  /// @param jacobian nullptr, or [constraints x n] resized and overwritten with d values / d x
  /// @return an Error if a block with a strict range cannot be predicted at x.
  Status Constraints(const Vector& x, Workspace& workspace, Vector& values, Matrix* jacobian) const;
  /// Size of the terms that each constraint sums up [constraints], against which rounding of its value is
  /// judged.
  [[nodiscard]] Vector ConstraintSizes(const Vector& x) const;

 private:
  struct Prior {
    int variable = 0;
    GaussianPrior density;
    bool logarithmic = false;
  };

  [[nodiscard]] SparseJacobian::Piece NewPiece(const Block& block, int first_row, int rows) const;
  /// Chain rule for one row: d result / d predicted values [predictions] to d result / d variables [1 x
  /// variables of the block].
  void RowOf(const Vector& x, int block, const Prediction& prediction, const Vector& slopes,
             Eigen::Ref<Matrix> row) const;
  void EvaluatePriors(const Vector& x, const Workspace& workspace, Vector& residuals,
                      SparseJacobian* jacobian) const;
  void EvaluateRanges(const Vector& x, Workspace& workspace, Vector& residuals,
                      SparseJacobian* jacobian) const;

  const Problem& problem_;
  const FitSetup& setup_;
  std::vector<TrainBlock> train_blocks_;
  std::vector<int> ranges_;          // blocks with a range that is not strict
  std::vector<int> strict_ranges_;   // blocks with a strict range
  std::vector<bool> wanted_;         // [layout size] blocks that the residuals need
  std::vector<bool> constrained_;    // [layout size] blocks that the constraints need
  std::vector<int> variable_of_;     // [P], -1 if not free
  std::vector<bool> differentiate_;  // [P], true if free
  std::vector<Prior> priors_;
  int data_rows_ = 0;
  int rows_ = 0;
  const RowTransform* transform_ = nullptr;
};

/// The point of lower cost [n]; the first one if the costs are equal, or if neither can be predicted.
[[nodiscard]] Vector LowerOf(const LeastSquares& fit, Vector first, Vector second);

}  // namespace sinew
