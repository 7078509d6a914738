#include "identify/diagnosis/discover/structure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/decompositions.h"
#include "identify/diagnosis/discover/shape.h"
#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {
namespace {

constexpr int kLags = 20;
constexpr int kKnots = 8;
constexpr double kRidge = 1e-3;
constexpr double kMinReportedShare = 0.01;

// Residual and signal at one sample of a block.
struct Sample {
  int fold = 0;
  double signal = 0;
  double residual = 0;
};

// A least-squares fit of linear basis functions, accumulated sample by sample.
struct Curve {
  Matrix normal = Matrix::Zero(kKnots, kKnots);
  Vector pull = Vector::Zero(kKnots);

  void Add(const std::vector<double>& knots, const Sample& sample, double sign) {
    const LinearBasis basis = LinearBasisAt(knots, sample.signal);
    const int a = basis.first;
    pull[a] += sign * basis.left * sample.residual;
    normal(a, a) += sign * basis.left * basis.left;
    if (basis.right == 0) return;
    pull[a + 1] += sign * basis.right * sample.residual;
    normal(a + 1, a + 1) += sign * basis.right * basis.right;
    normal(a, a + 1) += sign * basis.left * basis.right;
    normal(a + 1, a) += sign * basis.left * basis.right;
  }
  [[nodiscard]] Vector Solve() const {
    Matrix a = normal;
    a.diagonal().array() += kRidge * std::max(normal.trace() / kKnots, 1e-300);
    return a.ldlt().solve(pull);
  }
};

double At(const std::vector<double>& knots, const Vector& weights, double x) {
  const LinearBasis basis = LinearBasisAt(knots, x);
  return basis.left * weights[basis.first] + (basis.right == 0 ? 0 : basis.right * weights[basis.first + 1]);
}

Structure Examine(const std::vector<Sample>& samples, int folds) {
  Structure structure;
  double low = samples.front().signal;
  double high = low;
  double mean = 0;
  for (const Sample& sample : samples) {
    low = std::min(low, sample.signal);
    high = std::max(high, sample.signal);
    mean += sample.residual / static_cast<double>(samples.size());
  }
  if (!(high > low)) return structure;
  std::vector<double> knots;
  for (int k = 0; k < kKnots; ++k) knots.push_back(low + (high - low) * k / (kKnots - 1));
  Curve all;
  double total = 0;
  for (const Sample& sample : samples) {
    all.Add(knots, sample, 1);
    total += (sample.residual - mean) * (sample.residual - mean);
  }
  double left = 0;
  for (int fold = 0; fold < folds; ++fold) {
    Curve others = all;
    for (const Sample& sample : samples) {
      if (sample.fold == fold) others.Add(knots, sample, -1);
    }
    const Vector weights = others.Solve();
    for (const Sample& sample : samples) {
      if (sample.fold != fold) continue;
      const double error = sample.residual - At(knots, weights, sample.signal);
      left += error * error;
    }
  }
  structure.explained_fraction = total > 0 ? 1 - left / total : 0;
  structure.knots = knots;
  const Vector weights = all.Solve();
  structure.curve.assign(weights.data(), weights.data() + weights.size());
  std::vector<double> sure(static_cast<std::size_t>(kKnots));
  for (int k = 0; k < kKnots; ++k) sure[static_cast<std::size_t>(k)] = all.normal(k, k);
  structure.shape = FindShape(knots, structure.curve, sure);
  return structure;
}

ResidualTest LjungBox(const std::string& channel, const std::vector<const noise::NoiseBlock*>& blocks) {
  ResidualTest test{channel, "Ljung-Box", 0, 1};
  double squares = 0;
  double count = 0;
  std::vector<double> products(kLags, 0);
  for (const noise::NoiseBlock* block : blocks) {
    const Vector& r = block->residual;
    squares += r.squaredNorm();
    count += static_cast<double>(r.size());
    for (int lag = 1; lag <= kLags && lag < r.size(); ++lag)
      products[static_cast<std::size_t>(lag - 1)] += r.head(r.size() - lag).dot(r.tail(r.size() - lag));
  }
  if (!(squares > 0)) return test;
  for (int lag = 1; lag <= kLags; ++lag) {
    const double correlation = products[static_cast<std::size_t>(lag - 1)] / squares;
    test.statistic += count * (count + 2) * correlation * correlation / std::max(1.0, count - lag);
  }
  test.p_value = statistics::ChiSquaredUpperTail(test.statistic, kLags);
  return test;
}

ResidualTest Runs(const std::string& channel, const std::vector<const noise::NoiseBlock*>& blocks) {
  ResidualTest test{channel, "runs", 0, 1};
  double expected = 0;
  double variance = 0;
  double runs = 0;
  for (const noise::NoiseBlock* block : blocks) {
    const Vector& r = block->residual;
    double positive = 0;
    double seen = r.size() > 0 ? 1 : 0;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      positive += r[i] > 0 ? 1 : 0;
      if (i > 0 && (r[i] > 0) != (r[i - 1] > 0)) ++seen;
    }
    const double n = static_cast<double>(r.size());
    const double negative = n - positive;
    if (positive == 0 || negative == 0) continue;
    const double twice = 2 * positive * negative;
    runs += seen;
    expected += twice / n + 1;
    variance += twice * (twice - n) / (n * n * (n - 1));
  }
  if (!(variance > 0)) return test;
  test.statistic = (runs - expected) / std::sqrt(variance);
  test.p_value = std::erfc(std::abs(test.statistic) / std::sqrt(2.0));
  return test;
}

}  // namespace

std::vector<ResidualTest> TestResiduals(const std::vector<noise::NoiseBlock>& residuals) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<const noise::NoiseBlock*>> of_channel;
  for (const noise::NoiseBlock& block : residuals) {
    if (of_channel.count(block.channel) == 0) order.push_back(block.channel);
    of_channel[block.channel].push_back(&block);
  }
  std::vector<ResidualTest> tests;
  for (const std::string& channel : order) {
    tests.push_back(LjungBox(channel, of_channel[channel]));
    tests.push_back(Runs(channel, of_channel[channel]));
  }
  return tests;
}

Result<std::vector<Structure>> FindStructure(const Problem& problem, const Vector& point) {
  const Layout& layout = problem.layout();
  std::vector<bool> wanted(layout.size(), false);
  std::map<std::string, std::vector<int>> blocks_of;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    if (layout[b].role != BlockRole::kTrain || layout[b].samples() == 0) continue;
    wanted[b] = true;
    blocks_of[layout[b].channel].push_back(static_cast<int>(b));
  }
  Prediction prediction(layout);
  const auto workspace = problem.NewWorkspace();
  SINEW_TRY(problem.Predict({point, wanted, false, nullptr}, *workspace, prediction));

  std::vector<Structure> found;
  for (const auto& [channel, blocks] : blocks_of) {
    std::map<std::string, std::pair<std::string, std::vector<Sample>>> against;  // signal -> unit, samples
    const bool single = blocks.size() == 1;
    for (std::size_t t = 0; t < blocks.size(); ++t) {
      const Block& block = layout[static_cast<std::size_t>(blocks[t])];
      auto signals = problem.ResidualCovariates(blocks[t]);
      Problem::Signal time{"time", "s", {}};
      Problem::Signal predicted{"prediction", block.unit, {}};
      const auto values = prediction.values(blocks[t]);
      for (const int at : block.sample) {
        time.values.push_back(block.prediction_time[static_cast<std::size_t>(at)] -
                              block.prediction_time.front());
        predicted.values.push_back(values[at]);
      }
      signals.push_back(std::move(time));
      signals.push_back(std::move(predicted));
      for (const Problem::Signal& signal : signals) {
        auto& [unit, samples] = against[signal.name];
        unit = signal.unit;
        for (int i = 0; i < block.samples(); ++i) {
          const auto at = static_cast<std::size_t>(i);
          const int fold = single ? (2 * i) / block.samples() : static_cast<int>(t);
          const double residual = block.measured[at] - values[block.sample[at]];
          if (at < signal.values.size() && std::isfinite(signal.values[at]) && std::isfinite(residual))
            samples.push_back({fold, signal.values[at], residual});
        }
      }
    }
    for (const auto& [signal, of] : against) {
      if (of.second.size() < 4 * kKnots) continue;
      Structure structure = Examine(of.second, single ? 2 : static_cast<int>(blocks.size()));
      structure.channel = channel;
      structure.signal = signal;
      structure.unit = of.first;
      if (structure.explained_fraction > kMinReportedShare) found.push_back(std::move(structure));
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Structure& a, const Structure& b) {
    return a.explained_fraction > b.explained_fraction;
  });
  return found;
}

}  // namespace sinew::diagnosis
