#include "identify/layout.h"

#include <cmath>
#include <limits>

namespace sinew {
namespace {

Status CheckBlock(const Block& block, int parameters) {
  if (block.prediction_time.empty()) return Fail("it has no times");
  for (std::size_t i = 1; i < block.prediction_time.size(); ++i) {
    if (!(block.prediction_time[i] > block.prediction_time[i - 1]))
      return Fail("time does not increase at {}", i);
  }
  if (block.sample.size() != block.measured.size()) {
    return Fail("{} sample indices but {} measured values", block.sample.size(), block.measured.size());
  }
  for (std::size_t i = 0; i < block.sample.size(); ++i) {
    const int previous = i == 0 ? -1 : block.sample[i - 1];
    if (block.sample[i] <= previous || block.sample[i] >= block.predictions())
      return Fail("sample[{}] = {}: expected increasing indices into {} prediction times", i, block.sample[i],
                  block.predictions());
    if (!std::isfinite(block.measured[i]))
      return Fail("measured[{}] = {}: expected a finite number (leave gaps out)", i, block.measured[i]);
  }
  if (block.role != BlockRole::kPredicted && block.measured.empty()) return Fail("it has no measured value");
  if (!(block.weight > 0) || !std::isfinite(block.weight)) return Fail("its weight is {}", block.weight);
  if (!block.relative_weight.empty() && block.relative_weight.size() != block.measured.size())
    return Fail("{} relative weights but {} measured values", block.relative_weight.size(),
                block.measured.size());
  for (const double weight : block.relative_weight) {
    if (!(weight > 0) || !std::isfinite(weight)) return Fail("a relative weight is {}", weight);
  }
  if (!block.group.empty() && block.group.size() != block.measured.size())
    return Fail("{} groups of samples but {} measured values", block.group.size(), block.measured.size());
  if (block.sigma && !(*block.sigma > 0))
    return Fail("its noise level is {}, expected above 0", *block.sigma);
  if (block.noise_memory && !(*block.noise_memory > 0))
    return Fail("its noise is forgotten in {} s, expected above 0", *block.noise_memory);
  if (block.range && !(block.range->lower < block.range->upper))
    return Fail("its range {} .. {} is none", block.range->lower, block.range->upper);
  if (block.range && block.role != BlockRole::kPredicted) return Fail("it has a range but is measured");
  for (std::size_t i = 0; i < block.columns.size(); ++i) {
    const int previous = i == 0 ? -1 : block.columns[i - 1];
    if (block.columns[i] <= previous || block.columns[i] >= parameters)
      return Fail("columns[{}] = {}: expected increasing indices of the {} parameters", i, block.columns[i],
                  parameters);
  }
  return {};
}

}  // namespace

const char* ToString(BlockRole role) {
  switch (role) {
    case BlockRole::kTrain:
      return "train";
    case BlockRole::kValidate:
      return "validate";
    case BlockRole::kPredicted:
      return "predicted";
  }
  return "?";
}

Status CheckLayout(const Layout& layout, int parameters) {
  for (const Block& block : layout) {
    const Status status = CheckBlock(block, parameters);
    if (!status) return Fail("block {}/{}: {}", block.trial, block.channel, status.error().message);
  }
  return {};
}

Prediction::Prediction(const Layout& layout) {
  Eigen::Index size = 0;
  for (const Block& block : layout) {
    rows_.push_back(block.predictions());
    value_offset_.push_back(size);
    size += rows_.back();
  }
  values_ = size;
  for (const Block& block : layout) {
    columns_.push_back(static_cast<Eigen::Index>(block.columns.size()));
    derivative_offset_.push_back(size);
    size += block.predictions() * columns_.back();
  }
  // Derivatives stay uninitialised: memory pages of columns that are never requested are then never touched,
  // and with a hundred effects these are most.
  data_.resize(size);
  data_.head(values_).setConstant(std::numeric_limits<double>::quiet_NaN());
}

void Prediction::Poison() {
  data_.setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace sinew
