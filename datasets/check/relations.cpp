#include "datasets/check/relations.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/decompositions.h"
#include "base/linear_algebra.h"
#include "datasets/order_statistics.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr int kRelationMostSamples = 1500;  // per trial
constexpr std::size_t kRelationMostChannels = 80;
constexpr std::size_t kRelationMostTrials = 16;
constexpr std::size_t kRelationPredictors = 5;  // channels, each with two derivatives
constexpr double kRelationRidge = 1e-3;         // of the mean diagonal
constexpr double kRelationHolds = 0.7;          // least median correlation of prediction and measurement
constexpr double kRelationHoldsInTime = 0.85;   // the same where times are compared
constexpr double kRelationHoldsWell = 0.9;      // the same of signals that swing less than four times
constexpr double kRelationHoldsAtLeast = 0.6;   // least correlation in every other trial, or all but one
constexpr int kRelationCrossings = 4;           // of its median, of a signal that swings
constexpr int kRelationManyCrossings = 20;      // of two trials that are compared in time
constexpr double kRelationOpposite = -0.6;
constexpr double kRelationUnitTolerance = 1.4;  // factor around 57.3 or 1000
constexpr double kRelationSpreadTolerance = 4;  // the same of the spread against other trials
constexpr double kRelationLongestLag_s = 0.4;
constexpr int kRelationLeastLag = 3;          // [samples]
constexpr double kRelationLagExplains = 0.7;  // of the error that is left at the usual lag
constexpr int kRelationMostFindings = 6;

// Channels of one trial on one clock, standardised as in all trials together.
struct Sheet {
  std::string trial;
  double start = 0;  // [s]
  double step = 0;   // [s]
  std::vector<const Signal*> signals;
  Eigen::MatrixXd values;    // [samples x channels]
  Eigen::MatrixXd features;  // [samples x 3 channels] values and two derivatives, less their means
};

struct Relation {
  double correlation = NAN;
  double gain = NAN;
  double spread = NAN;
  int lag = 0;  // [samples]
  double at_lag = NAN;
  Eigen::VectorXd predicted;
  Eigen::Index partner = 0;  // the channel that predicts most of it
};

// Means over the steps where the channel is finer than the steps, else straight between samples.
Eigen::VectorXd Resampled(const Signal& signal, double start, double step, int samples) {
  Eigen::VectorXd values(samples);
  const auto& time = *signal.time;
  std::size_t at = 0;
  double last = 0;
  for (int i = 0; i < samples; ++i) {
    const double t = start + i * step;
    double sum = 0;
    int count = 0;
    while (at < time.size() && time[at] < t - 0.5 * step) ++at;
    for (std::size_t j = at; j < time.size() && time[j] < t + 0.5 * step; ++j) {
      if (!std::isfinite(signal.values[j])) continue;
      sum += signal.values[j];
      ++count;
    }
    const auto next = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
    if (count > 1) {
      last = sum / count;
    } else if (next < time.size() && next > 0 &&
               std::isfinite(signal.values[next] + signal.values[next - 1])) {
      last = signal.values[next - 1] + (signal.values[next] - signal.values[next - 1]) *
                                           (t - time[next - 1]) / (time[next] - time[next - 1]);
    } else if (next < time.size() && std::isfinite(signal.values[next])) {
      last = signal.values[next];
    }
    values[i] = last;
  }
  return values;
}

Eigen::VectorXd Derivative(const Eigen::VectorXd& x) {
  constexpr Eigen::Index kWidth = 2;  // samples on each side: noise is not amplified much
  Eigen::VectorXd d = Eigen::VectorXd::Zero(x.size());
  for (Eigen::Index i = kWidth; i + kWidth < x.size(); ++i)
    d[i] = (x[i + kWidth] - x[i - kWidth]) / (2 * kWidth);
  return d;
}

void SetFeatures(Sheet& sheet) {
  const Eigen::Index channels = sheet.values.cols();
  sheet.features.resize(sheet.values.rows(), 3 * channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    const Eigen::VectorXd slope = Derivative(sheet.values.col(c));
    sheet.features.col(3 * c) = sheet.values.col(c);
    sheet.features.col(3 * c + 1) = slope;
    sheet.features.col(3 * c + 2) = Derivative(slope);
  }
  sheet.features.rowwise() -= sheet.features.colwise().mean();
}

// The channels that all of these trials have.
std::vector<const ChannelGroup*> Common(const std::vector<ChannelGroup>& groups, std::size_t trials) {
  std::vector<const ChannelGroup*> common;
  for (const ChannelGroup& group : groups) {
    if (group.signals.size() != trials) continue;
    const bool varies = std::all_of(group.signals.begin(), group.signals.end(), [](const Signal& signal) {
      if (signal.size() < 50 || 2 * CountFinite(signal.values) <= signal.size()) return false;
      const auto ends = FiniteQuantiles(signal.values, {0.05, 0.95});
      return ends[1] > ends[0];
    });
    if (varies) common.push_back(&group);
  }
  return common;
}

std::vector<Sheet> Sheets(const std::vector<const ChannelGroup*>& channels) {
  std::vector<Sheet> sheets;
  const std::size_t trials = channels.front()->signals.size();
  const std::size_t stride = (trials + kRelationMostTrials - 1) / kRelationMostTrials;
  for (std::size_t t = 0; t < trials; t += stride) {
    Sheet sheet;
    sheet.trial = channels.front()->signals[t].trial;
    double end = INFINITY;
    sheet.start = -INFINITY;
    double coarsest = 0;
    for (const ChannelGroup* group : channels) {
      const Signal& signal = group->signals[t];
      sheet.signals.push_back(&signal);
      const TimeSpan whole = signal.Whole();
      sheet.start = std::max(sheet.start, whole.from);
      end = std::min(end, whole.to);
      coarsest = std::max(coarsest, (whole.to - whole.from) / static_cast<double>(signal.size() - 1));
    }
    sheet.step = std::max(coarsest, 0.005);
    const int samples = std::min(kRelationMostSamples, static_cast<int>((end - sheet.start) / sheet.step));
    if (samples < 60) continue;
    sheet.values.resize(samples, static_cast<Eigen::Index>(channels.size()));
    // The middle of long trials: they may begin and end at rest.
    sheet.start += 0.5 * (end - sheet.start - samples * sheet.step);
    for (std::size_t c = 0; c < channels.size(); ++c)
      sheet.values.col(static_cast<Eigen::Index>(c)) =
          Resampled(*sheet.signals[c], sheet.start, sheet.step, samples);
    sheets.push_back(std::move(sheet));
  }
  return sheets;
}

double CorrelationOf(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean();
  const Eigen::VectorXd y = b.array() - b.mean();
  const double norm = x.norm() * y.norm();
  return norm > 0 ? x.dot(y) / norm : NAN;
}

// Correlation of the measurement, `lag` samples later, with the prediction.
double CorrelationAt(const Eigen::VectorXd& measured, const Eigen::VectorXd& predicted, int lag) {
  const Eigen::Index n = measured.size() - std::abs(lag);
  return CorrelationOf(measured.segment(std::max(lag, 0), n), predicted.segment(std::max(-lag, 0), n));
}

class Relations {
 public:
  explicit Relations(std::vector<Sheet> sheets) : sheets_(std::move(sheets)) {
    for (Sheet& sheet : sheets_) {
      SetFeatures(sheet);
      grams_.push_back(Gram(sheet));
    }
  }

  [[nodiscard]] const std::vector<Sheet>& sheets() const { return sheets_; }
  [[nodiscard]] Eigen::Index channels() const { return sheets_.front().values.cols(); }

  void Correct(std::size_t t, Eigen::Index channel, double factor, int lag) {
    Sheet& sheet = sheets_[t];
    const Eigen::VectorXd old = sheet.values.col(channel);
    for (Eigen::Index i = 0; i < old.size(); ++i)
      sheet.values(i, channel) = factor * old[std::clamp<Eigen::Index>(i + lag, 0, old.size() - 1)];
    SetFeatures(sheet);
    grams_[t] = Gram(sheet);
  }

  // Of a channel in trial t, by the relation that holds in all others but `without`.
  [[nodiscard]] Relation Judge(std::size_t t, Eigen::Index channel, std::size_t without) const {
    Relation relation;
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(grams_[t].rows(), grams_[t].cols());
    for (std::size_t other = 0; other < grams_.size(); ++other) {
      if (other != t && other != without) gram += grams_[other];
    }
    const auto columns = Predictors(gram, channel);
    if (columns.empty()) return relation;
    relation.partner = columns.front() / 3;
    const auto n = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd a(n, n);
    Eigen::VectorXd b(n);
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(gram(columns[Index(i)], columns[Index(i)]));
    for (Eigen::Index i = 0; i < n; ++i) {
      b[i] = gram(columns[Index(i)], 3 * channel) * scale[i];
      for (Eigen::Index j = 0; j < n; ++j)
        a(i, j) = gram(columns[Index(i)], columns[Index(j)]) * scale[i] * scale[j];
    }
    a.diagonal().array() += kRelationRidge;
    const Eigen::VectorXd weights = a.ldlt().solve(b).cwiseProduct(scale);
    const Sheet& sheet = sheets_[t];
    relation.predicted = Eigen::VectorXd::Zero(sheet.values.rows());
    for (Eigen::Index i = 0; i < n; ++i)
      relation.predicted += weights[i] * sheet.features.col(columns[Index(i)]);
    const Eigen::VectorXd measured = sheet.features.col(3 * channel);
    relation.correlation = CorrelationOf(measured, relation.predicted);
    const double power = relation.predicted.squaredNorm();
    relation.gain = power > 0 ? measured.dot(relation.predicted) / power : NAN;
    relation.spread = measured.norm() / std::sqrt(static_cast<double>(measured.size()));
    const int longest = std::min<int>(static_cast<int>(kRelationLongestLag_s / sheet.step),
                                      static_cast<int>(measured.size()) / 4);
    relation.at_lag = relation.correlation;
    for (int lag = -longest; lag <= longest; ++lag) {
      const double r = CorrelationAt(measured, relation.predicted, lag);
      if (r > relation.at_lag) {
        relation.at_lag = r;
        relation.lag = lag;
      }
    }
    return relation;
  }

 private:
  static std::size_t Index(Eigen::Index i) { return static_cast<std::size_t>(i); }

  static Eigen::MatrixXd Gram(const Sheet& sheet) {
    return sheet.features.transpose() * sheet.features / static_cast<double>(sheet.features.rows());
  }

  // Features of the channels that are correlated most with this one. Not of one that is the same up to noise:
  // it would remove what other markers determine (another marker of the same segment is used too, although it
  // is no independent measurement).
  [[nodiscard]] std::vector<Eigen::Index> Predictors(const Eigen::MatrixXd& gram,
                                                     Eigen::Index channel) const {
    std::vector<std::pair<double, Eigen::Index>> strength;
    const double own = gram(3 * channel, 3 * channel);
    for (Eigen::Index c = 0; c < channels(); ++c) {
      if (c == channel) continue;
      double best = 0;
      for (Eigen::Index f = 3 * c; f < 3 * c + 3; ++f) {
        const double other = gram(f, f);
        if (other > 0 && own > 0)
          best = std::max(best, std::abs(gram(f, 3 * channel)) / std::sqrt(own * other));
      }
      strength.emplace_back(best, c);
    }
    std::sort(strength.begin(), strength.end(), std::greater<>());
    std::vector<Eigen::Index> columns;
    for (std::size_t i = 0; i < std::min(kRelationPredictors, strength.size()); ++i) {
      for (Eigen::Index f = 3 * strength[i].second; f < 3 * strength[i].second + 3; ++f) {
        if (gram(f, f) > 0) columns.push_back(f);
      }
    }
    return columns;
  }

  std::vector<Sheet> sheets_;
  std::vector<Eigen::MatrixXd> grams_;
};

struct Suspect {
  FindingKind kind = FindingKind::kSign;
  std::size_t trial = 0;
  Eigen::Index channel = 0;
  double strength = 0;
  Eigen::Index partner = 0;
  double factor = 1;  // that corrects it
  int lag = 0;        // [samples] that corrects it
  double size = 0;
  double usual = 0;
};

std::optional<double> UnitFactor(double ratio) {
  for (const double unit : {57.29577951308232, 1000.0}) {
    for (const double factor : {unit, 1 / unit}) {
      if (ratio < factor * kRelationUnitTolerance && ratio > factor / kRelationUnitTolerance) return factor;
    }
  }
  return std::nullopt;
}

// How often a signal passes its median: two smooth curves without a turn correlate by chance.
int Crossings(const Eigen::VectorXd& values) {
  const std::vector<double> x(values.data(), values.data() + values.size());
  const double middle = Median(x);
  const double margin = 0.15 * (Quantile(x, 0.95) - Quantile(x, 0.05));
  int crossings = 0;
  int side = 0;
  for (const double v : x) {
    const int now = v > middle + margin ? 1 : v < middle - margin ? -1 : side;
    crossings += side != 0 && now != side ? 1 : 0;
    side = now;
  }
  return crossings;
}

// What is usual in the other trials, by relations that trial t has no part in.
struct Others {
  std::vector<double> r;  // in ascending order
  std::vector<double> gain;
  std::vector<double> spread;
  std::vector<double> lag;  // [s]

  [[nodiscard]] bool Hold() const {
    if (r.empty() || Median(r) < kRelationHolds) return false;
    return r[r.size() < 4 ? 0 : 1] >= kRelationHoldsAtLeast;
  }
};

Others OthersOf(const Relations& relations, std::size_t t, Eigen::Index c) {
  Others others;
  for (std::size_t u = 0; u < relations.sheets().size(); ++u) {
    if (u == t) continue;
    const Relation relation = relations.Judge(u, c, t);
    if (!std::isfinite(relation.correlation)) continue;
    others.r.push_back(relation.correlation);
    others.gain.push_back(relation.gain);
    others.spread.push_back(relation.spread);
    others.lag.push_back(relation.lag * relations.sheets()[u].step);
  }
  std::sort(others.r.begin(), others.r.end());
  return others;
}

// Of two trials each is the only other one: both are predicted by the relation in the other.
Others TheOther(const Relations& relations, std::size_t t, Eigen::Index c) {
  const std::size_t u = 1 - t;
  const Relation relation = relations.Judge(u, c, u);
  return {{std::abs(relation.correlation)}, {1}, {relation.spread}, {0}};
}

bool IsLate(const Relations& relations, std::size_t t, Eigen::Index c, const Relation& here,
            const Others& others, Suspect& suspect) {
  const double step = relations.sheets()[t].step;
  const double usual = Median(others.lag);
  double scatter = 0;
  for (const double lag : others.lag) scatter = std::max(scatter, std::abs(lag - usual));
  const double delay = here.lag * step;
  if (std::abs(delay - usual) < std::max(kRelationLeastLag * step, 2 * scatter) ||
      here.at_lag < kRelationHoldsInTime)
    return false;
  const double at_usual = CorrelationAt(relations.sheets()[t].features.col(3 * c), here.predicted,
                                        static_cast<int>(std::lround(usual / step)));
  if (1 - here.at_lag > (1 - kRelationLagExplains) * (1 - at_usual)) return false;
  suspect.kind = FindingKind::kLag;
  suspect.strength = here.at_lag;
  suspect.lag = here.lag;
  suspect.size = delay;
  suspect.usual = usual;
  return true;
}

std::vector<Suspect> Suspects(const Relations& relations) {
  std::vector<Suspect> suspects;
  const std::size_t trials = relations.sheets().size();
  for (Eigen::Index c = 0; c < relations.channels(); ++c) {
    for (std::size_t t = 0; t < trials; ++t) {
      const Relation here = relations.Judge(t, c, t);
      const double r = here.correlation;
      const bool odd = r < kRelationOpposite || (r > kRelationHolds && UnitFactor(std::abs(here.gain))) ||
                       std::abs(here.lag) >= kRelationLeastLag;
      if (!odd) continue;
      const int crossings = Crossings(relations.sheets()[t].values.col(c));
      const Others others = trials == 2 ? TheOther(relations, t, c) : OthersOf(relations, t, c);
      if (!others.Hold()) continue;
      if (crossings < kRelationCrossings &&
          (others.r.front() < kRelationHoldsWell || std::abs(r) < kRelationHoldsWell || trials < 4))
        continue;
      Suspect suspect{FindingKind::kSign, t, c, std::abs(r), here.partner, 1, 0, r, Median(others.r)};
      const double spread_ratio = here.spread / Median(others.spread);
      const auto unit = UnitFactor(std::abs(here.gain) / std::abs(Median(others.gain)));
      if (r < kRelationOpposite) {
        suspect.factor = -1;
        suspects.push_back(suspect);
      } else if (unit && r > kRelationHolds && spread_ratio < *unit * kRelationSpreadTolerance &&
                 spread_ratio > *unit / kRelationSpreadTolerance) {
        suspect.kind = FindingKind::kUnit;
        suspect.factor = 1 / *unit;
        suspect.size = *unit;
        suspect.usual = 1;
        suspects.push_back(suspect);
      } else if ((trials > 2 || crossings > kRelationManyCrossings) &&
                 IsLate(relations, t, c, here, others, suspect)) {
        suspects.push_back(suspect);
      }
    }
  }
  return suspects;
}

}  // namespace

std::vector<Finding> FindBrokenRelations(const std::vector<ChannelGroup>& groups) {
  std::size_t trials = 0;
  for (const ChannelGroup& group : groups) trials = std::max(trials, group.signals.size());
  if (trials < 2) return {};
  std::vector<const ChannelGroup*> channels = Common(groups, trials);
  if (channels.size() < 2) return {};
  if (channels.size() > kRelationMostChannels) channels.resize(kRelationMostChannels);
  std::vector<Sheet> sheets = Sheets(channels);
  if (sheets.size() < 2) return {};
  Relations relations(std::move(sheets));
  std::vector<Finding> found;
  std::vector<Suspect> suspects = Suspects(relations);
  while (!suspects.empty() && found.size() < kRelationMostFindings) {
    // The correction after which least is left to be explained.
    std::stable_sort(suspects.begin(), suspects.end(),
                     [](const Suspect& a, const Suspect& b) { return a.strength > b.strength; });
    constexpr std::size_t kTried = 4;
    std::optional<Relations> best;
    std::vector<Suspect> left;
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < std::min(kTried, suspects.size()); ++i) {
      Relations corrected = relations;
      corrected.Correct(suspects[i].trial, suspects[i].channel, suspects[i].factor, suspects[i].lag);
      auto rest = Suspects(corrected);
      if (!best || rest.size() < left.size()) {
        best = std::move(corrected);
        left = std::move(rest);
        chosen = i;
      }
    }
    const Suspect& s = suspects[chosen];
    if (left.size() >= suspects.size()) break;  // nothing is explained by it
    Finding finding = relations.sheets()[s.trial].signals[static_cast<std::size_t>(s.channel)]->Found(s.kind);
    finding.whole = true;
    finding.spans = {relations.sheets()[s.trial].signals[static_cast<std::size_t>(s.channel)]->Whole()};
    finding.size = s.size;
    finding.usual = s.usual;
    finding.undecided = relations.sheets().size() == 2;
    finding.other = finding.undecided
                        ? "trial '" + relations.sheets()[1 - s.trial].trial + "'"
                        : relations.sheets()[s.trial].signals[static_cast<std::size_t>(s.partner)]->channel;
    found.push_back(std::move(finding));
    relations = std::move(*best);
    suspects = std::move(left);
  }
  return found;
}

}  // namespace sinew
