#include "problems/emg_shape/prediction/block.h"

#include <cmath>

#include "base/constants.h"
#include "problems/emg_shape/learning/cycle_scatter.h"

namespace sinew {
namespace {

// Of fitted trials every burst has its timing. Others are predicted by their mean, which is rounder than a
// single one.
double JitterOf(const EmgShapeSettings& settings, const EmgShapeTrial& trial, const EmgMuscle& muscle) {
  const bool mean = settings.cycle_scatter && trial.role != BlockRole::kTrain;
  return mean && muscle.timing.total > kMinTimingScatter ? muscle.timing.total : 0;
}

}  // namespace

EmgBlock::EmgBlock(const EmgShapeSettings& settings, const EmgShapeData& data, const EmgShapeParameters& list,
                   std::size_t trial, std::size_t muscle)
    : trial_(data.trials[trial]),
      columns_(list.columns[static_cast<std::size_t>(trial_.first_block) + muscle]),
      hat_knots_(list.hat_knots),
      order_(data.layout[static_cast<std::size_t>(trial_.first_block) + muscle].columns),
      others_(trial_.others[muscle]),
      mean_shape_(data.muscles[muscle].mean_shape),
      block_(trial_.first_block + static_cast<int>(muscle)),
      knots_(data.knots),
      windows_(trial_.windows[muscle]),
      basis_(BasisOf(settings, data.knots, trial_.period, JitterOf(settings, trial_, data.muscles[muscle]))),
      plain_(data.knots) {
  if (!others_.empty()) others_shape_ = data.others_shape[muscle];
  for (const EmgWindow& window : windows_) heard_.push_back(others_.empty() ? 0 : HeardIn(window));
  if (!windows_.empty()) return;
  windows_.emplace_back();
  windows_.back().end = static_cast<int>(trial_.time.size());
  heard_.push_back(0);
}

// How much of the others' mean there is in a burst, of the muscle's own.
double EmgBlock::HeardIn(const EmgWindow& window) const {
  double products = 0;
  double squares = 0;
  for (int i = window.first; i < window.end; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double share = window.ShareAt(trial_.cycle[at] + trial_.phase[at]).value;
    if (share == 0) continue;
    const double emg = share * plain_.Value(trial_.phase[at], mean_shape_.data());
    products += emg * share * plain_.Value(trial_.phase[at], others_shape_.data());
    squares += emg * emg;
  }
  return squares > 0 ? products / squares : 0;
}

double EmgBlock::Along(const EmgColumn& column, std::size_t sample) const {
  switch (column.along) {
    case EmgAlong::kOne:
    case EmgAlong::kWindow:
    case EmgAlong::kAllMuscles:
      return column.factor;
    case EmgAlong::kCycle:
      return column.factor * (trial_.cycle[sample] - 0.5 * (static_cast<double>(trial_.cycles.size()) - 1));
    case EmgAlong::kSine:
      return column.factor * std::sin(2 * kPi * trial_.phase[sample]);
    case EmgAlong::kCosine:
      return column.factor * (std::cos(2 * kPi * trial_.phase[sample]) - 1);
    case EmgAlong::kBasis: {
      const LinearBasis basis = LinearBasisAt(hat_knots_, trial_.time[sample] - trial_.time.front());
      if (column.which == basis.first) return column.factor * basis.left;
      return column.which == basis.first + 1 ? column.factor * basis.right : 0;
    }
  }
  return 0;
}

// Sums of the parameters, sample by sample and window by window.
void EmgBlock::AddUp(const Query& query, Scratch& scratch) const {
  const std::size_t count = trial_.time.size();
  scratch.gain.assign(count, 0);
  scratch.timing.assign(count, 0);
  scratch.offset.assign(count, 0);
  scratch.window_gain.assign(windows_.size(), 0);
  scratch.window_timing.assign(windows_.size(), 0);
  scratch.shared_timing.assign(windows_.size(), 0);
  scratch.control = Vector::Zero(knots_);
  scratch.cross_talk = 0;
  scratch.has_cross_talk = false;
  for (const EmgColumn& column : columns_) {
    const double value = query.parameters[column.parameter];
    if (column.term == EmgTerm::kShape) scratch.control[column.which] = value;
    if (column.term == EmgTerm::kCrossTalk && !others_.empty()) {
      scratch.cross_talk = value;
      scratch.has_cross_talk = value != 0 || query.Differentiates(column.parameter);
    }
    if (column.term == EmgTerm::kShape || column.term == EmgTerm::kCrossTalk || value == 0) continue;
    if (column.along == EmgAlong::kWindow) {
      auto& sums = column.term == EmgTerm::kGain ? scratch.window_gain : scratch.window_timing;
      sums[static_cast<std::size_t>(column.which)] += value * column.factor;
      continue;
    }
    if (column.along == EmgAlong::kAllMuscles) {
      scratch.shared_timing[static_cast<std::size_t>(column.which)] += value * column.factor;
      continue;
    }
    std::vector<double>& sum = column.term == EmgTerm::kGain     ? scratch.gain
                               : column.term == EmgTerm::kTiming ? scratch.timing
                                                                 : scratch.offset;
    for (std::size_t i = 0; i < count; ++i) sum[i] += value * Along(column, i);
  }
}

void EmgBlock::Predict(const Query& query, Scratch& scratch, Prediction& prediction) const {
  AddUp(query, scratch);
  const auto count = static_cast<Eigen::Index>(trial_.time.size());
  auto values = prediction.values(block_);
  values = Eigen::Map<const Vector>(scratch.offset.data(), count);
  if (query.derivatives) {
    scratch.by_gain = scratch.by_timing = scratch.by_cross_talk = Vector::Zero(count);
    scratch.by_shape = Matrix::Zero(knots_, count);
    scratch.by_window_gain.resize(windows_.size());
    scratch.by_window_timing.resize(windows_.size());
  }
  for (Vector* row : {&scratch.basis, &scratch.slopes, &scratch.others, &scratch.others_slopes})
    row->resize(knots_);
  for (std::size_t w = 0; w < windows_.size(); ++w) AddBurst(w, query, scratch, prediction);
  if (scratch.has_cross_talk) {
    const Eigen::Map<const Vector> others(others_.data(), count);
    if (scratch.cross_talk != 0) values += scratch.cross_talk * others;
    if (query.derivatives) scratch.by_cross_talk += others;
  }
  if (query.derivatives) Differentiate(query, scratch, prediction);
}

void EmgBlock::AddBurst(std::size_t w, const Query& query, Scratch& scratch, Prediction& prediction) const {
  const EmgWindow& window = windows_[w];
  auto values = prediction.values(block_);
  const double cross_talk = scratch.cross_talk;
  const double scattering = 1 + cross_talk * heard_[w];
  const double early = scratch.shared_timing[w] + scattering * scratch.window_timing[w];
  if (query.derivatives)
    scratch.by_window_gain[w] = scratch.by_window_timing[w] = Vector::Zero(window.end - window.first);
  for (int i = window.first; i < window.end; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double phase = trial_.phase[at] + scratch.timing[at] + early;
    const BurstCut::Share share = window.ShareAt(trial_.cycle[at] + phase);
    if (share.value == 0) continue;
    basis_.At(phase, scratch.basis.data(), query.derivatives ? scratch.slopes.data() : nullptr);
    const double gain = std::exp(scratch.gain[at] + scattering * scratch.window_gain[w]);
    double shape = scratch.basis.dot(scratch.control);
    double others = 0;
    if (scratch.has_cross_talk) {
      plain_.At(phase, scratch.others.data(), scratch.others_slopes.data());
      others = scratch.others.dot(others_shape_);
      shape -= cross_talk * others;
    }
    const double emg = gain * shape;
    values[i] += share.value * emg;
    if (!query.derivatives) continue;
    double slope = scratch.slopes.dot(scratch.control);
    if (scratch.has_cross_talk) slope -= cross_talk * scratch.others_slopes.dot(others_shape_);
    const double by_timing = share.value * gain * slope + share.slope * emg;
    scratch.by_gain[i] += share.value * emg;
    scratch.by_timing[i] += by_timing;
    scratch.by_shape.col(i) += share.value * gain * scratch.basis;
    scratch.by_window_gain[w][i - window.first] = share.value * emg;
    scratch.by_window_timing[w][i - window.first] = by_timing;
    scratch.by_cross_talk[i] +=
        heard_[w] * (scratch.window_gain[w] * share.value * emg + scratch.window_timing[w] * by_timing) -
        share.value * gain * others;
  }
}

void EmgBlock::Differentiate(const Query& query, const Scratch& scratch, Prediction& prediction) const {
  auto derivatives = prediction.derivatives(block_);
  Eigen::Index at = -1;
  for (const EmgColumn& column : columns_) {
    const bool wanted = query.Differentiates(column.parameter);
    if (at < 0 || order_[static_cast<std::size_t>(at)] != column.parameter) {
      ++at;
      if (wanted) derivatives.col(at).setZero();
    }
    if (!wanted) continue;
    auto slopes = derivatives.col(at);
    if (column.along == EmgAlong::kWindow || column.along == EmgAlong::kAllMuscles) {
      const auto w = static_cast<std::size_t>(column.which);
      const bool gain = column.term == EmgTerm::kGain;
      const Vector& by = gain ? scratch.by_window_gain[w] : scratch.by_window_timing[w];
      // Of the muscle's own part; cross-talk does not move with it.
      const double scattering = column.along == EmgAlong::kWindow ? 1 + scratch.cross_talk * heard_[w] : 1;
      slopes.segment(windows_[w].first, by.size()) += column.factor * scattering * by;
      continue;
    }
    if (column.term == EmgTerm::kShape) {
      slopes += scratch.by_shape.row(column.which).transpose();
      continue;
    }
    if (column.term == EmgTerm::kCrossTalk) {
      slopes += scratch.by_cross_talk;
      continue;
    }
    for (Eigen::Index i = 0; i < slopes.size(); ++i) {
      const double by = column.term == EmgTerm::kGain     ? scratch.by_gain[i]
                        : column.term == EmgTerm::kTiming ? scratch.by_timing[i]
                                                          : 1;
      slopes[i] += by * Along(column, static_cast<std::size_t>(i));
    }
  }
}

}  // namespace sinew
