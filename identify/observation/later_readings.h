// What a record reads some time later: for sensors that are late, where the record is finer than the times of
// the predictions.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// A block whose measured values are means over parts of a finer record, such as a force plate's over the
/// frames of a motion. If its sensor is late by d, what happened in such a part was read by d later: the
/// record itself tells the change of the means, while a curve through predictions at the frames does not show
/// what is faster than they are.
///
/// Between its samples the record is a cubic with the slopes of central differences (Catmull, Rom 1974);
/// before the first and after the last one, and where nothing is known, it stays as it was beside that.
class LaterReadings {
 public:
  /// Of a sample of the block.
  struct Mean {
    int prediction = 0;     ///< index into Block::prediction_time
    std::size_t begin = 0;  ///< of the record's samples
    std::size_t end = 0;    ///< after the last one
  };

  /// @param time [S, s, increasing] @param record [S, unit of the block] @param weights [S, >= 0] of the
  /// samples in a mean; where one is 0 nothing is known, nor where the record is not finite
  /// @param means with some weight each
  LaterReadings(std::vector<double> time, std::vector<double> record, std::vector<double> weights,
                std::vector<Mean> means);

  [[nodiscard]] const std::vector<Mean>& means() const { return means_; }

  /// @param later [s] @param means [means] out: some time later, less those of now
  /// @param slopes [means, unit/s] out: derivatives for `later`
  void At(double later, Eigen::Ref<Vector> means, Eigen::Ref<Vector> slopes) const;

 private:
  struct Reading {
    double value = 0;
    double slope = 0;
  };
  [[nodiscard]] Reading ReadingAt(double time, std::size_t& interval) const;

  std::vector<double> time_;
  std::vector<double> record_;
  std::vector<double> slope_;
  std::vector<double> weights_;
  std::vector<Mean> means_;
};

}  // namespace sinew
