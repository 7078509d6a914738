#include "identify/observation/reading_port.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew {

// One signal at the samples of one compared block.
struct ReadingPort::Samples {
  std::size_t block = 0;
  Problem::Signal signal;
};

namespace {

constexpr int kKnots = 8;

bool IsReadBy(const Block& block, const std::string& channel) {
  return block.channel == channel && block.role != BlockRole::kPredicted;
}

double BeginOf(const Layout& layout, const std::string& trial) {
  std::optional<double> begin;
  for (const Block& block : layout) {
    if (block.trial != trial || block.role == BlockRole::kPredicted) continue;
    const double first = block.prediction_time[static_cast<std::size_t>(block.sample.front())];
    begin = std::min(begin.value_or(first), first);
  }
  return begin.value_or(0);
}

// The signal interpolated at the prediction times of a block. @pre it has a finite sample
std::vector<double> AtPredictions(const Block& block, const std::vector<double>& samples) {
  std::vector<double> time;
  std::vector<double> known;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i])) continue;
    time.push_back(block.prediction_time[static_cast<std::size_t>(block.sample[i])]);
    known.push_back(samples[i]);
  }
  std::vector<double> values;
  for (const double t : block.prediction_time) {
    const LinearBasis basis = LinearBasisAt(time, t);
    const auto at = static_cast<std::size_t>(basis.first);
    values.push_back(basis.right == 0 ? known[at] : basis.left * known[at] + basis.right * known[at + 1]);
  }
  return values;
}

bool IsUsable(const Problem::Signal& signal, const Block& block) {
  return signal.values.size() == block.measured.size() &&
         std::any_of(signal.values.begin(), signal.values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::string ReadingPort::NameOf(const Problem& problem, const std::string& channel) {
  const auto is_taken = [&](const auto& of_model) { return of_model.name == channel; };
  const auto& ports = problem.ports();
  const auto& parameters = problem.parameters();
  const bool taken = std::any_of(ports.begin(), ports.end(), is_taken) ||
                     std::any_of(parameters.begin(), parameters.end(), is_taken);
  return taken ? channel + "_reading" : channel;
}

ReadingPort::ReadingPort(const Problem& problem, const ChannelSummary& channel,
                         std::vector<Parameter>& parameters)
    : port_{NameOf(problem, channel.channel), channel.unit, "something adds to the reading", {}} {
  const Layout& layout = problem.layout();
  std::vector<Samples> time;
  std::vector<std::vector<Samples>> by_signal;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    if (!IsReadBy(block, channel.channel)) continue;
    const double begin = BeginOf(layout, block.trial);
    Samples of_time{b, {"time", "s", {}}};
    for (const int i : block.sample) {
      of_time.signal.values.push_back(block.prediction_time[static_cast<std::size_t>(i)] - begin);
    }
    time.push_back(std::move(of_time));
    for (Problem::Signal& signal : problem.ResidualCovariates(static_cast<int>(b))) {
      if (signal.name == "time" || !IsUsable(signal, block)) continue;
      auto same = std::find_if(by_signal.begin(), by_signal.end(),
                               [&](const auto& s) { return s.front().signal.name == signal.name; });
      if (same == by_signal.end()) same = by_signal.insert(same, std::vector<Samples>());
      if (same->empty() || same->back().block != b) same->push_back({b, std::move(signal)});
    }
  }
  AddTerm(problem, channel, time, false, parameters);
  for (const auto& samples : by_signal) {
    const bool of_reading = samples.front().signal.name == channel.channel;
    if (samples.size() == time.size()) AddTerm(problem, channel, samples, of_reading, parameters);
  }
}

void ReadingPort::AddTerm(const Problem& problem, const ChannelSummary& channel,
                          const std::vector<Samples>& samples, bool of_reading,
                          std::vector<Parameter>& parameters) {
  double least = INFINITY;
  double most = -INFINITY;
  for (const Samples& in_block : samples) {
    for (const double value : in_block.signal.values) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  const double width = (most - least) / (kKnots - 1);
  if (!(least + width > least && most - width < most)) return;

  Term term;
  term.first_weight = static_cast<int>(parameters.size());
  term.of_reading = of_reading;
  for (int k = 0; k < kKnots; ++k) term.knots.push_back(least + k * width);
  if (!of_reading) {
    const Layout& layout = problem.layout();
    term.basis.resize(layout.size());
    for (const Samples& in_block : samples) {
      const Block& block = layout[in_block.block];
      for (const double value : AtPredictions(block, in_block.signal.values)) {
        term.basis[in_block.block].push_back(LinearBasisAt(term.knots, value));
      }
    }
  }

  const Problem::Signal& signal = samples.front().signal;
  DiscrepancyTerm unknown;
  unknown.name = port_.name + "(" + signal.name + ")";
  unknown.signal = signal.name;
  unknown.signal_unit = signal.unit;
  unknown.knots = term.knots;
  for (int k = 0; k < kKnots; ++k) {
    Parameter p;
    p.name = unknown.name + "[" + std::to_string(k) + "]";
    p.unit = channel.unit;
    p.meaning = "what is added to the reading at a knot of " + signal.name;
    p.lower = -channel.magnitude;
    p.upper = channel.magnitude;
    p.kind = ParameterKind::kEffect;
    p.effect = unknown.name;
    unknown.parameters.push_back(static_cast<int>(parameters.size()));
    parameters.push_back(std::move(p));
  }
  port_.terms.push_back(std::move(unknown));
  terms_.push_back(std::move(term));
}

}  // namespace sinew
