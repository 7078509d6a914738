// The EMG of one muscle in one trial, as the parameters make it.
#pragma once

#include <vector>

#include "identify/problem.h"
#include "problems/emg_shape/data.h"
#include "problems/emg_shape/parameters.h"

namespace sinew {

/// Immutable; refers to data and parameters, which must outlive it.
class EmgBlock {
 public:
  /// What one thread needs for any block.
  struct Scratch;

  EmgBlock(const EmgShapeSettings& settings, const EmgShapeData& data, const EmgShapeParameters& list,
           std::size_t trial, std::size_t muscle);

  void Predict(const Query& query, Scratch& scratch, Prediction& prediction) const;

 private:
  [[nodiscard]] double Along(const EmgColumn& column, std::size_t sample) const;
  [[nodiscard]] double HeardIn(const EmgWindow& window) const;
  void AddUp(const Query& query, Scratch& scratch) const;
  void AddBurst(std::size_t window, const Query& query, Scratch& scratch, Prediction& prediction) const;
  void Differentiate(const Query& query, const Scratch& scratch, Prediction& prediction) const;

  const EmgShapeTrial& trial_;
  const std::vector<EmgColumn>& columns_;
  const std::vector<double>& hat_knots_;
  const std::vector<int>& order_;  // of the block's columns
  const std::vector<double>& others_;
  Vector others_shape_;  // O of parameters.h; zero: not known
  Vector mean_shape_;
  int block_;
  int knots_;
  std::vector<EmgWindow> windows_;  // where there are none, all is one
  std::vector<double> heard_;       // [windows] r_b of parameters.h
  ShapeBasis basis_;
  ShapeBasis plain_;  // of O
};

struct EmgBlock::Scratch final : Problem::Workspace {
  // Sample by sample.
  std::vector<double> gain;    // of the logarithm
  std::vector<double> timing;  // [cycle]
  std::vector<double> offset;
  Vector by_gain;  // derivatives
  Vector by_timing;
  Vector by_cross_talk;
  Matrix by_shape;  // [knots x samples]
  // Window by window.
  std::vector<double> window_gain;
  std::vector<double> window_timing;
  std::vector<double> shared_timing;   // not the muscle's own
  std::vector<Vector> by_window_gain;  // from the window's first sample on
  std::vector<Vector> by_window_timing;
  Vector control;  // [knots]
  Vector basis;    // [knots] at one sample
  Vector slopes;
  Vector others;  // the same of O
  Vector others_slopes;
  double cross_talk = 0;
  bool has_cross_talk = false;
};

}  // namespace sinew
