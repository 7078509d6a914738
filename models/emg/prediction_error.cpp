#include "models/emg/prediction_error.h"

#include <cmath>
#include <limits>

namespace sinew {
namespace {

struct MeanAndDeviation {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double deviation = std::numeric_limits<double>::quiet_NaN();
};

MeanAndDeviation Moments(const std::vector<double>& values) {
  MeanAndDeviation moments;
  if (values.empty()) return moments;
  const auto n = static_cast<double>(values.size());
  moments.mean = 0;
  for (const double value : values) moments.mean += value / n;
  if (values.size() < 2) return moments;
  double sum = 0;
  for (const double value : values) sum += (value - moments.mean) * (value - moments.mean);
  moments.deviation = std::sqrt(sum / (n - 1));
  return moments;
}

}  // namespace

Result<PredictionError> ComparePrediction(const std::vector<double>& predicted,
                                          const std::vector<double>& measured) {
  if (predicted.size() != measured.size())
    return Fail("{} predicted values for {} measured ones, expected as many", predicted.size(),
                measured.size());
  if (measured.size() < 2) return Fail("{} values, expected at least 2", measured.size());
  const auto n = static_cast<double>(measured.size());
  double mean_p = 0;
  double mean_m = 0;
  double square = 0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!std::isfinite(predicted[k]) || !std::isfinite(measured[k])) {
      return Fail("value {}: {} predicted, {} measured, expected finite numbers", k, predicted[k],
                  measured[k]);
    }
    mean_p += predicted[k] / n;
    mean_m += measured[k] / n;
    square += (predicted[k] - measured[k]) * (predicted[k] - measured[k]);
  }
  double pp = 0;
  double mm = 0;
  double pm = 0;
  bool changes_p = false;  // exactly: sums of a constant's deviations are rounding
  bool changes_m = false;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    const double p = predicted[k] - mean_p;
    const double m = measured[k] - mean_m;
    pp += p * p;
    mm += m * m;
    pm += p * m;
    changes_p = changes_p || predicted[k] != predicted[0];
    changes_m = changes_m || measured[k] != measured[0];
  }
  PredictionError error;
  error.rmse = std::sqrt(square / n);
  error.r_squared = changes_p && changes_m ? (pm / pp) * (pm / mm) : std::nan("");
  if (error.r_squared > 1) error.r_squared = 1;  // rounding
  return error;
}

ErrorSummary Summarise(const std::vector<PredictionError>& errors) {
  std::vector<double> rmse;
  std::vector<double> r_squared;
  for (const PredictionError& error : errors) {
    rmse.push_back(error.rmse);
    if (!std::isnan(error.r_squared)) r_squared.push_back(error.r_squared);
  }
  const MeanAndDeviation of_rmse = Moments(rmse);
  const MeanAndDeviation of_r_squared = Moments(r_squared);
  return {rmse.size(),      of_rmse.mean,      of_rmse.deviation,
          r_squared.size(), of_r_squared.mean, of_r_squared.deviation};
}

}  // namespace sinew
