// The port of a sensor's reading: the signals that a model discrepancy term there can depend on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/effect.h"
#include "identify/observation/sensor_parameters.h"
#include "identify/problem.h"

namespace sinew {

/// Port CHANNEL (see NameOf) with the terms CHANNEL(time), for the time since the trial's begin (its first
/// sample of any compared channel), and CHANNEL(SIGNAL) for every signal that Problem::ResidualCovariates
/// names for all compared blocks of the channel; 8 knots over the signal's range in all of them.
///
/// Signals known at the samples only are interpolated linearly and are constant beyond; gaps (NaN) are
/// interpolated too. A constant signal gives no term. A signal with the name of the channel itself is taken
/// from the prediction, not from the measurement, whose noise would otherwise be in both the regressor and
/// the residual.
class ReadingPort {
 public:
  /// CHANNEL; CHANNEL_reading where the model itself has a port or a parameter of that name (the joint's
  /// torque beside a torque sensor), so that terms, their weights and drifts keep names of their own.
  [[nodiscard]] static std::string NameOf(const Problem& problem, const std::string& channel);

  struct Term {
    int first_weight = 0;  ///< index of its first parameter; the others follow
    bool of_reading = false;
    std::vector<double> knots;
    /// [blocks][M] basis functions at the prediction times; empty for the blocks of other channels and if
    /// of_reading.
    std::vector<std::vector<LinearBasis>> basis;

    /// Basis functions at prediction `i` of a block. @param reading [unit] predicted reading
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
