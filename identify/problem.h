// A problem is parameters plus a way to predict the measured channels of some trials. Solvers, uncertainty
// and diagnosis see nothing else.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "base/linear_algebra.h"
#include "identify/effect.h"
#include "identify/fit_step.h"
#include "identify/layout.h"
#include "identify/parameter.h"

namespace sinew {

/// What is asked of Problem::Predict.
struct Query {
  const Vector& parameters;         ///< [P] every parameter, fixed ones too, within bounds
  const std::vector<bool>& blocks;  ///< [layout size] which blocks are wanted
  bool derivatives = false;         ///< fill Prediction::derivatives too
  /// [P] parameters whose derivatives are wanted; nullptr: all. Columns of others are left as they are.
  const std::vector<bool>* differentiate = nullptr;

  [[nodiscard]] bool Differentiates(int parameter) const {
    return derivatives && (differentiate == nullptr || (*differentiate)[static_cast<std::size_t>(parameter)]);
  }
};

/// Physics with every known effect in it, bound to the data of some trials. Immutable after construction.
class Problem {
 public:
  /// What one thread needs between calls; holds no state that changes an answer.
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

  [[nodiscard]] virtual const std::vector<Parameter>& parameters() const = 0;
  [[nodiscard]] virtual const Layout& layout() const = 0;

  /// Groups of parameters that can be released, see Effect.
  [[nodiscard]] virtual const std::vector<Effect>& effects() const;
  /// Places where an unknown term may enter, and the terms that may, see Port.
  [[nodiscard]] virtual const std::vector<DiscrepancyPort>& ports() const;
  /// Inequality constraints g(theta) <= 0, see Constraint.
  [[nodiscard]] virtual const std::vector<Constraint>& constraints() const;

  /// Fits one after the other that people are used to do instead of one of everything; empty: none.
  [[nodiscard]] virtual const std::vector<FitStep>& steps() const;

  [[nodiscard]] virtual std::unique_ptr<Workspace> NewWorkspace() const {
    return std::make_unique<Workspace>();
  }

  /// Predicts every wanted block on its prediction_time, and its derivatives for the parameters in its
  /// `columns`.
  ///
  /// Thread-safe for different workspaces; allocates nothing in steady state if the model is native. Blocks
  /// that are not wanted are left as they are. The answer does not depend on which blocks are wanted.
  /// @return an Error if there is no prediction at this point (integrator step below its minimum, force not
  /// finite at t = ...): the point is then rejected, with this reason, and the search goes on.
  virtual Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const = 0;

  /// What the cost is, for a person.
  [[nodiscard]] virtual std::string objective() const { return "half the sum of squared weighted residuals"; }

  /// Share of the cost that a small change of the parameters may add to it or take from it by chance: a
  /// prediction that searches or integrates in steps is no smoother than these. Searches and profiles look no
  /// closer. 0: smooth to rounding.
  [[nodiscard]] virtual double cost_noise_level() const { return 0; }

  /// Adds what only this problem has to show (pressures under a sole, muscle forces) at these parameters to a
  /// run file.
  virtual Status WriteDetails(const Vector& parameters, Hdf5Node& details) const;

  /// What a person should know about the model at these parameters, in sentences: a muscle that works where
  /// none can.
  [[nodiscard]] virtual std::vector<std::string> WarningsAt(const Vector& parameters) const;

  /// Signals that a residual of block b may be looked at against, besides time: measured channels and inputs
  /// of its trial, at the block's samples.
  struct Signal {
    std::string name;
    std::string unit;
    std::vector<double> values;  ///< [N of the block]
  };
  [[nodiscard]] virtual std::vector<Signal> ResidualCovariates(int block) const;
};

/// Every parameter at rest: starts, and effects at their null.
[[nodiscard]] Vector RestPoint(const Problem& problem);

}  // namespace sinew
