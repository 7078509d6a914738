// What a record reads some time later: for sensors that are late, where the record is finer than the times of
// the predictions.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// A block whose measured values are sums over a finer record with given coefficients, such as local fits to
/// a force plate's record at the frames of a motion. If its sensor is late by d, what happened at a frame was
/// read by d later: the record itself tells the change of the sums, while a curve through predictions at the
/// frames does not show what is faster than they are.
///
/// Between its samples the record is a cubic with the slopes of central differences (Catmull, Rom 1974);
/// before the first and after the last one, and where nothing is known, it stays as it was beside that.
class LaterReadings {
 public:
  /// Of a sample of the block: the sum of the record's samples from `begin` on times the coefficients.
  struct Sum {
    int prediction = 0;  ///< index into Block::prediction_time
    std::size_t begin = 0;
    std::vector<double> coefficients;
  };

  /// @param time [S, s, increasing] @param record [S, unit of the block] not finite: nothing is known there
  LaterReadings(std::vector<double> time, std::vector<double> record, std::vector<Sum> sums);

  [[nodiscard]] const std::vector<Sum>& sums() const { return sums_; }

  /// @param later [s] @param changes [sums] out: some time later, less those of now
  /// @param slopes [sums, unit/s] out: derivatives for `later`
  void At(double later, Eigen::Ref<Vector> changes, Eigen::Ref<Vector> slopes) const;

 private:
  struct Reading {
    double value = 0;
    double slope = 0;
  };
  [[nodiscard]] Reading ReadingAt(double time, std::size_t& interval) const;

  std::vector<double> time_;
  std::vector<double> record_;
  std::vector<double> slope_;
  std::vector<Sum> sums_;
};

}  // namespace sinew
