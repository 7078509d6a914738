// The channels of a data set as the checks see them: one series per trial, the same channel of all trials
// together.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// Values that lie in the data set, and are copied only if they are changed: a recording may have a gigabyte.
class SignalValues {
 public:
  /// @param values must outlive this and all its copies
  SignalValues(const std::vector<double>& values) : values_(&values) {}  // NOLINT: used like a vector

  operator const std::vector<double>&() const { return *values_; }  // NOLINT: the same
  [[nodiscard]] std::size_t size() const { return values_->size(); }
  [[nodiscard]] double operator[](std::size_t i) const { return (*values_)[i]; }
  [[nodiscard]] auto begin() const { return values_->begin(); }
  [[nodiscard]] auto end() const { return values_->end(); }

  void MakeGap(std::size_t sample);
  /// From sample `first` to the one before `end`.
  void MakeGap(std::size_t first, std::size_t end);

 private:
  std::vector<double>& Own();

  const std::vector<double>* values_;
  std::shared_ptr<std::vector<double>> own_ = {};  // of all copies made since it was changed
};

/// One channel of one trial. Points into the data set, which must outlive it.
struct Signal {
  std::string trial;
  std::string task;  ///< of the trial
  std::string grid;
  std::string channel;
  Role role = Role::kTrain;
  ChannelKind kind = ChannelKind::kMeasured;
  std::string unit;
  const std::vector<double>* time = nullptr;  ///< [N, s]
  /// [N] NaN where there is a gap, and where the channel means nothing: centres of pressure and free moments
  /// of a plate while it carries nothing.
  SignalValues values;

  [[nodiscard]] std::size_t size() const { return values.size(); }
  /// From sample `first` to sample `last`.
  [[nodiscard]] TimeSpan Span(std::size_t first, std::size_t last) const {
    return {(*time)[first], (*time)[last]};
  }
  [[nodiscard]] TimeSpan Whole() const { return {time->front(), time->back()}; }
  /// A finding about this channel; spans, size and so on are the caller's.
  [[nodiscard]] Finding Found(FindingKind kind) const;
};

/// The same channel of all trials that have it: of the same name and unit, and of the same grid where a trial
/// has several channels of that name.
struct ChannelGroup {
  std::string channel;
  std::vector<Signal> signals;
};

[[nodiscard]] std::vector<ChannelGroup> GroupSignals(const Dataset& dataset);

/// The trials of one task each: a rotation and a hold are rightly unlike each other.
[[nodiscard]] std::vector<ChannelGroup> ByTask(const std::vector<ChannelGroup>& groups);

/// From the 2nd to the 98th percentile of its values; 0 of fewer than ten.
[[nodiscard]] double RangeOf(const Signal& signal);

/// A run of equal values.
struct Run {
  std::size_t first = 0;
  std::size_t last = 0;  ///< inclusive
  double value = 0;

  [[nodiscard]] std::size_t size() const { return last - first + 1; }
};

/// Runs of at least `shortest` samples that are exactly equal, in order; NaN ends a run.
[[nodiscard]] std::vector<Run> EqualRuns(const std::vector<double>& values, std::size_t shortest);

/// Differences of neighbours, [N]: entry i is value i less value i - 1; NaN at 0 and next to gaps.
[[nodiscard]] std::vector<double> Increments(const std::vector<double>& values);

/// Share of a plate's greatest vertical force below which centre of pressure and free moment mean nothing.
inline constexpr double kUnloadedShare = 0.05;

}  // namespace sinew
