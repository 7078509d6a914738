// The place where something unknown may add to a sensor's reading, and the signals it may depend on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/effect.h"
#include "identify/observation/sensor_parameters.h"
#include "identify/problem.h"

namespace sinew {

/// Port CHANNEL with the terms CHANNEL(time), time being that since the trial's begin (its first sample of
/// any channel that is compared), and CHANNEL(SIGNAL) for every signal that Problem::ResidualCovariates names
/// for all compared blocks of the channel; 8 knots over the signal's range in all of them.
///
/// Signals known at the samples alone run straight from one to the next and are constant beyond; a gap (NaN)
/// is bridged likewise. A signal that never changes gives no term. A signal named like the channel itself is
/// taken from the prediction, not from the measurement, whose noise would else stand on both sides of the
/// comparison.
class ReadingPort {
 public:
  struct Term {
    int first_weight = 0;  ///< index of its first parameter; the others follow
    bool of_reading = false;
    std::vector<double> knots;
    /// [blocks][M] at the prediction times; empty for other channels' blocks and if of_reading.
    std::vector<std::vector<LinearBasis>> basis;

    /// At prediction `i` of a block. @param reading [unit] the predicted one
    [[nodiscard]] LinearBasis At(int block, Eigen::Index i, double reading) const {
      return of_reading ? LinearBasisAt(knots, reading)
                        : basis[static_cast<std::size_t>(block)][static_cast<std::size_t>(i)];
    }
  };

  /// Appends the weights to `parameters`. @param problem the problem without its sensors
  ReadingPort(const Problem& problem, const ChannelSummary& channel, std::vector<Parameter>& parameters);

  [[nodiscard]] const DiscrepancyPort& port() const { return port_; }
  [[nodiscard]] const std::vector<Term>& terms() const { return terms_; }

 private:
  struct Samples;
  void AddTerm(const Problem& problem, const ChannelSummary& channel, const std::vector<Samples>& samples,
               bool of_reading, std::vector<Parameter>& parameters);

  DiscrepancyPort port_;
  std::vector<Term> terms_;
};

}  // namespace sinew
