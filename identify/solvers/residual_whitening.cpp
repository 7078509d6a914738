#include "identify/solvers/residual_whitening.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "identify/noise/autoregression.h"
#include "identify/noise/noise_model.h"

namespace sinew::solvers {
namespace {

constexpr int kWhiteningOrder = 6;
constexpr double kLargestPartial = 0.9999;

}  // namespace

std::unique_ptr<const RowTransform> ResidualWhitening(const LeastSquares& fit, const Vector& point) {
  auto workspace = fit.NewWorkspace();
  Vector residuals;
  if (!fit.Evaluate(fit.Variables(point), workspace, residuals, nullptr)) return {};
  noise::NoiseModel model;
  std::vector<std::vector<int>> starts;
  std::vector<std::vector<Vector>> stretches;  // [channels]
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
    const auto known = std::find_if(model.channels.begin(), model.channels.end(),
                                    [&](const auto& channel) { return channel.channel == block.channel; });
    model.channel_of.push_back(static_cast<int>(known - model.channels.begin()));
    if (known == model.channels.end()) {
      model.channels.push_back({block.channel, {}});
      stretches.emplace_back();
    }
    starts.push_back(noise::Stretches(block));
    for (std::size_t s = 0; s < starts.back().size(); ++s) {
      const int end = s + 1 < starts.back().size() ? starts.back()[s + 1] : block.samples();
      const int begin = starts.back()[s];
      stretches[static_cast<std::size_t>(model.channel_of.back())].push_back(
          residuals.segment(train.first_row + begin, end - begin));
    }
  }
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    std::vector<double> partial = noise::BurgPartial(stretches[c], kWhiteningOrder);
    for (double& value : partial) value = std::clamp(value, -kLargestPartial, kLargestPartial);
    model.channels[c].coefficients = noise::CoefficientsFromPartial(partial);
    double squares = 0;
    double samples = 0;
    for (Vector& stretch : stretches[c]) {
      noise::AutoregressiveFilter(partial).Apply(stretch.data(), stretch.size());
      squares += stretch.squaredNorm();
      samples += static_cast<double>(stretch.size());
    }
    model.channels[c].deviation = std::sqrt(squares / samples);
    if (!(model.channels[c].deviation > 0)) return {};
  }
  return std::make_unique<noise::Whitening>(std::move(model), std::move(starts));
}

}  // namespace sinew::solvers
