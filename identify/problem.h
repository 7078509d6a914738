// A problem: parameters, and a prediction of the measured channels of some trials. Solvers, uncertainty
// analysis and diagnosis use nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "base/linear_algebra.h"
#include "identify/derived_quantity.h"
#include "identify/effect.h"
#include "identify/fit_step.h"
#include "identify/layout.h"
#include "identify/parameter.h"
#include "identify/warning.h"

namespace sinew {

/// One request to Problem::Predict: the point, the blocks, and the derivatives that are wanted.
struct Query {
  const Vector&
      parameters;  ///< [P] all parameters in the order of parameters(), fixed ones too, within bounds
  const std::vector<bool>& blocks;  ///< [layout size] true for the blocks to be predicted
  bool derivatives = false;         ///< true: fill Prediction::derivatives of these blocks too
  /// [P] true for the parameters whose derivatives are wanted (the free ones); nullptr: all. Not read unless
  /// `derivatives` is set.
  const std::vector<bool>* differentiate = nullptr;

  /// True if the derivatives for this parameter are wanted: to be asked before a column is computed.
  [[nodiscard]] bool Differentiates(int parameter) const {
    return derivatives && (differentiate == nullptr || (*differentiate)[static_cast<std::size_t>(parameter)]);
  }
};

struct AlternativePrediction;
struct UnmeasuredEstimate;

/// A model with all its known effects, bound to the data of some trials. Immutable after construction: every
/// const member may be called from several threads.
class Problem {
 public:
  /// Scratch memory of one thread, kept between calls. It must not influence a result: a prediction is the
  /// same with a new workspace.
  class Workspace {
   public:
    Workspace() = default;
    virtual ~Workspace() = default;
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;
  };

  Problem() = default;
  virtual ~Problem() = default;
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  /// All parameters, base, nuisance and effect ones, in one fixed order: [P].
  [[nodiscard]] virtual const std::vector<Parameter>& parameters() const = 0;
  /// The residual blocks: one per channel and trial, with times, measurement, weight and role.
  [[nodiscard]] virtual const Layout& layout() const = 0;

  /// The effects: groups of parameters that can be released, see Effect. Default: none.
  [[nodiscard]] virtual const std::vector<Effect>& effects() const;
  /// The ports: places where a model discrepancy term can be added, and these terms, see DiscrepancyPort.
  /// Default: none.
  [[nodiscard]] virtual const std::vector<DiscrepancyPort>& ports() const;
  /// Linear inequality constraints g(theta) <= 0, see Constraint. Default: none.
  [[nodiscard]] virtual const std::vector<Constraint>& constraints() const;

  /// The steps of the usual stepwise identification, which fits some parameters after the others instead of
  /// all at once. Default: none.
  [[nodiscard]] virtual const std::vector<FitStep>& steps() const;

  /// A workspace for one thread; each thread that predicts has its own.
  [[nodiscard]] virtual std::unique_ptr<Workspace> NewWorkspace() const {
    return std::make_unique<Workspace>();
  }

  /// Predicts every wanted block, and its derivatives if they are wanted. This is the one function that a
  /// model has to provide; solvers, uncertainty analysis and diagnosis call it for many points, from several
  /// threads.
  ///
  /// For every block b with query.blocks[b] true, and no other:
  ///  - prediction.values(b) [predictions() of the block, its unit] is set to the channel at each of the
  /// times Block::prediction_time: all of them, not only those that have a measured sample. Values are
  /// neither weighted nor compared with the measurement; the caller does both.
  ///  - if query.derivatives is true, column k of prediction.derivatives(b) [predictions() x columns.size(),
  /// column-major] is set to d values / d parameter, the parameter being Block::columns[k], for every k with
  /// query.Differentiates(Block::columns[k]). Derivatives are with respect to the parameter in its own unit,
  /// also where its scale is logarithmic. A column of a parameter that does not affect the block at this
  /// point is set to zero, not left out. Columns that are not wanted are left as they are and are not read.
  ///
  /// A parameter that is not in Block::columns must not change the block; otherwise its effect on the cost is
  /// missing from the gradient. (Those of priors may, ParameterKind::kPrior: no gradient moves them.)
  /// Derivatives are those of the values returned: solvers stop too early, or
  /// reject every step, where they are not. Documented departures: Parameter::null_step and
  /// Parameter::is_rounding_step.
  ///
  /// All entries that are asked for have to be set: `prediction` is reused and holds old values or NaN.
  /// Values that are not finite make the point fail.
  ///
  /// The result depends on `query.parameters` alone. Which blocks and derivatives are wanted, the calls
  /// before, and the thread do not change it, to the last bit: runs are resumed by comparing points and
  /// costs.
  ///
  /// Thread-safe for different workspaces and predictions. Native models allocate no memory here after the
  /// first call.
  ///
  /// @param query references that are valid during the call only
  /// @param workspace from NewWorkspace() of this problem
  /// @param prediction constructed from this problem's layout()
  /// @return an Error if there is no prediction at this point (integrator step below its minimum, force not
  /// finite at t = ...). It is not fatal: the solver rejects the point, counts the failure, keeps the first
  /// message for the report, and continues; `prediction` may then hold anything. Throws nothing.
  virtual Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const = 0;

  /// A draw of what the predictions may be because the recorded inputs hold noise: as Predict, with white
  /// noise added to every recorded input, of the level that the data state.
  /// For the propagation of uncertainty by simulation (JCGM 101:2008, Guide to the Expression of Uncertainty
  /// in Measurement, Supplement 1), see noise::PropagateInputNoise.
  /// @param draw its number: the same one draws the same noise, at any parameters
  /// @return false: no noise of an input is known, and nothing was predicted. Default: false. Errors: those
  /// of Predict
  virtual Result<bool> PredictWithInputNoise(const Query& query, std::uint64_t draw, Workspace& workspace,
                                             Prediction& prediction) const;

  /// The solver of `identify` and `diagnose` where the user names none: of those that found the lowest cost
  /// of this kind of problem in every study, the fastest (docs/decisions). Default:
  /// "restarts", which searches from several starts until two agree.
  [[nodiscard]] virtual const char* default_solver() const { return "restarts"; }

  /// What the cost is, in words for reports.
  [[nodiscard]] virtual std::string objective() const { return "half the sum of squared weighted residuals"; }

  /// Whether the weights of the blocks are inverse noise levels, up to one factor per channel. An objective
  /// that gives every trial the same share is none: a diagnosis then compares models under equal noise
  /// instead, see EqualNoiseView.
  [[nodiscard]] virtual bool weights_are_noise_levels() const { return true; }

  /// Relative noise of the cost: the share of it by which it can change at random between neighbouring
  /// points, because the prediction contains a search or an integration with adaptive steps. Solvers and
  /// profile likelihoods use no tolerance below it. 0: smooth to rounding.
  [[nodiscard]] virtual double cost_noise_level() const { return 0; }

  /// Adds results that are specific to this problem (pressures under a sole, muscle forces) at these
  /// parameters [P] to the details of a run file. Default: nothing.
  virtual Status WriteDetails(const Vector& parameters, Hdf5Node& details) const;

  /// A better point to begin a local fit of the compared blocks at, for problems whose predictions depend so
  /// strongly on their initial states that a search from anywhere gets lost: multiple shooting. Nothing: the
  /// problem has no such way, or sees no need for it.
  /// @param free [increasing] the parameters that may change @param compared [layout size] true for the
  /// blocks whose measurements are used @param parameters [P] where to begin
  /// @return [P]; whether it is better is for the caller to find out
  [[nodiscard]] virtual std::optional<Vector> ImprovedStart(const std::vector<int>& free,
                                                            const std::vector<bool>& compared,
                                                            const Vector& parameters) const;

  /// How AtPriors carries nuisance values over.
  enum class CarryOver {
    kSame,    ///< the same prediction, at values that may be beyond their bounds
    kAllowed  ///< nearly the same, as far as both priors allow it
  };
  /// Parameters [P] at which the prediction is that of `parameters` with the parameters of the priors
  /// (ParameterKind::kPrior) that `priors` [P] has: where the meaning of nuisance values depends on them,
  /// with other nuisance values. Default: the others unchanged.
  [[nodiscard]] virtual Vector AtPriors(const Vector& parameters, const Vector& priors, CarryOver how) const;

  /// Warnings about the model at these parameters [P], such as a muscle outside its working range: kind
  /// kOther, one sentence in `message`; `names` and `numbers`, of equal length or empty, state its facts for
  /// scripts. Default: none.
  [[nodiscard]] virtual std::vector<Warning> WarningsAt(const Vector& parameters) const;

  /// Functions of the parameters that are reported with the fit, see DerivedQuantity. Default: none.
  [[nodiscard]] virtual std::vector<DerivedQuantity> DerivedQuantities() const;

  /// Figures of merit beside the cost. @param parameters [P] @param predicted [layout size][predictions of
  /// the block] Default: none.
  [[nodiscard]] virtual std::vector<FigureOfMerit> FiguresOfMerit(const Vector& parameters,
                                                                  const std::vector<Vector>& predicted) const;

  /// Other predictions of the same blocks, whose errors are reported beside the answer's. @param parameters
  /// [P] of the answer. Default: none.
  [[nodiscard]] virtual std::vector<AlternativePrediction> Alternatives(const Vector& parameters) const;

  /// The nuisance values of trials in which no fitted channel was measured, as far as something else tells of
  /// them. @param parameters [P] of the answer; those of these trials are not read. Nothing: there is no such
  /// trial, or nothing tells. Default: nothing.
  [[nodiscard]] virtual std::optional<UnmeasuredEstimate> EstimateUnmeasured(const Vector& parameters) const;

  /// A signal that the residual of a block may depend on, besides time: a measured channel or an input of its
  /// trial, at the block's samples.
  struct Signal {
    std::string name;
    std::string unit;
    std::vector<double> values;  ///< [N of the block]
  };
  /// The signals of one block, on which the diagnosis regresses its residual. Default: none.
  [[nodiscard]] virtual std::vector<Signal> ResidualCovariates(int block) const;
};

/// The parameters without any fit [P]: starts, and effects at their null.
[[nodiscard]] Vector RestPoint(const Problem& problem);

}  // namespace sinew
