// The analysis behind AnalyseUncertainty, in the order of its steps: the minimum, errors and their covariance
// (analysis.cpp), intervals (analysis_intervals.cpp), verdicts and notes (analysis_verdicts.cpp).
#pragma once

#include <vector>

#include "base/constants.h"
#include "identify/uncertainty/competing_minima.h"
#include "identify/uncertainty/information.h"
#include "identify/uncertainty/interval.h"
#include "identify/uncertainty/linearization.h"
#include "identify/uncertainty/noise.h"
#include "identify/uncertainty/profile.h"
#include "identify/uncertainty/uncertainty.h"

namespace sinew::uncertainty {

/// What is found about one variable, in the unit box.
struct Finding {
  int variable = 0;
  bool determined = false;   ///< by the data
  double plain = kInfinity;  ///< errors in the unit box
  double robust = kInfinity;
  double normal = 0;  ///< (J'J)^-1 of it
  Interval interval;
  IntervalKind kind = IntervalKind::kNone;
  ProfileFailure no_profile = ProfileFailure::kNone;  ///< why the interval is linear

  double widest = kInfinity;  ///< the error that the interval is made of
};

/// One analysis of one solution; Run is called once.
class Analysis {
 public:
  Analysis(const LeastSquares& problem, const UncertaintyOptions& options)
      : problem_(problem), options_(options) {}

  Result<Uncertainty> Run(const Vector& x);

 private:
  Status FindMinimum(const Vector& x);
  void MakeInformations();
  void Unmeasurable(const Vector& x);
  void FindErrors();
  void FindCovariance();
  void FindIntervals();
  void ReleaseBounds();
  bool LowerMinimum();
  void Profiles();
  void ExtendTo(const LocalMinimum& other);
  [[nodiscard]] Vector Widths() const;
  [[nodiscard]] bool IsMeasured(const Finding& finding) const {
    return finding.kind != IntervalKind::kNone && finding.widest > 0;
  }
  [[nodiscard]] bool OnBoundEverywhere(int variable) const;
  [[nodiscard]] ProfileRequest RequestOf(const Finding& finding, const Matrix& normal) const;
  [[nodiscard]] Vector Tangent(const Matrix& normal, int variable) const;
  void Describe(const Vector& x);
  void NoteMinima();
  void AddNotes();

  [[nodiscard]] const Parameter& parameter(int variable) const { return at_.parameter(problem_, variable); }
  [[nodiscard]] int parameter_index(int variable) const {
    return problem_.setup().free[static_cast<std::size_t>(variable)];
  }
  [[nodiscard]] VariableStatus status(int variable) const {
    return at_.status[static_cast<std::size_t>(variable)];
  }
  [[nodiscard]] bool OnBound(int variable) const {
    return status(variable) == VariableStatus::kAtLower || status(variable) == VariableStatus::kAtUpper;
  }

  const LeastSquares& problem_;
  const UncertaintyOptions& options_;
  Uncertainty answer_;
  Linearization at_;
  double cost_ = 0;  // of solvers::LocalFit at the minimum
  double penalty_ = 0;
  std::vector<int> inner_nuisance_;
  Information all_;       // with priors: errors
  Information data_;      // without the priors of findings: verdicts
  Information released_;  // the same, as if no variable were on a bound: reasons
  Noise noise_;
  double quantile_ = 0;
  Matrix plain_;              // [k of all_]
  bool independent_ = false;  // residuals are no evidence against it
  std::vector<Finding> findings_;
};

}  // namespace sinew::uncertainty
