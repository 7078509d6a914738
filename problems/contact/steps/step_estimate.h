// A step without its plate: which deviations of the pose agree with what else is known of its load.
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <optional>
#include <vector>

#include "models/contact/contact_sums.h"
#include "problems/contact/problem.h"

namespace sinew {

using ChannelValues = std::array<Vector, ContactProblem::kChannels>;  ///< [T] of each

/// A measured sum over instants of linear functions of a foot's load.
struct LoadRow {
  struct Term {
    int instant = 0;
    ContactLoad factors;  ///< of the load, by ContactLoadRow
  };
  std::vector<Term> terms;
  double measured = 0;
  double deviation = 1;  ///< standard deviation of its error

  [[nodiscard]] double ValueAt(const ChannelValues& channels) const;
};

struct StepEstimate {
  Vector parameters;               ///< [P]
  ChannelValues value;             ///< of every channel
  ChannelValues deviation;         ///< their standard deviations
  Eigen::LLT<Matrix> precision{};  ///< inverse covariance of the stance's own deviations, decomposed
};

/// The most probable deviations of one stance, all else as it is, by Gauss-Newton with damping and with
/// errors of the rows that shrink to their own size. Standard deviations are those of the linear model there.
/// @param parameters [P] those of the stance's own deviations are the mean of their prior
/// @param spread standard deviation of the prior of a weight
/// Errors: those of Problem::Predict at the parameters.
Result<StepEstimate> EstimateStep(const ContactProblem& problem, const Stance& stance,
                                  const Vector& parameters, double spread, const std::vector<LoadRow>& rows);

/// Standard deviation of a new stance's own deviation about the mean of the fitted ones, in units of its
/// prior. Of one fitted stance nothing is known but the prior: the root of 2, since both deviate. Of several,
/// from how much the curves of each differ from the mean of the others, over the variance that its plate
/// determines (the evidence approximation: MacKay 1992, Neural Comput. 4:415), at least a twentieth. Curves
/// and not their weights are compared: real errors are slower than the prior allows, and most weights belong
/// to fast ones.
[[nodiscard]] double SpreadOfSteps(const ContactProblem& problem, const std::vector<const Stance*>& fitted,
                                   const Vector& parameters);

/// The load [ContactLoad] from the channels of a plate.
[[nodiscard]] ContactLoad LoadOf(const std::array<double, ContactProblem::kChannels>& channels);

}  // namespace sinew
