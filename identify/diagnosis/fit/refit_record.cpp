#include "identify/diagnosis/fit/refit_record.h"

#include <utility>

#include "base/numbers.h"
#include "base/text.h"

namespace sinew::diagnosis {
namespace {

// Numbers are read one after the other in the order in which they were written; a record of another shape
// ends the reading.
class Reader {
 public:
  explicit Reader(const std::vector<double>& numbers) : numbers_(numbers) {}

  double Next() { return at_ < numbers_.size() ? numbers_[at_++] : (complete_ = false, 0.0); }
  std::size_t Count() {
    const double count = Next();
    if (count >= 0 && count <= static_cast<double>(numbers_.size() - at_))
      return static_cast<std::size_t>(count);
    complete_ = false;
    return 0;
  }
  int Integer() {
    const auto number = WholeNumber(Next());
    const bool fits = number && *number == static_cast<int>(*number);
    complete_ = complete_ && fits;
    return fits ? static_cast<int>(*number) : 0;
  }
  // All was there, and nothing is left.
  [[nodiscard]] bool Ended() const { return complete_ && at_ == numbers_.size(); }

 private:
  const std::vector<double>& numbers_;
  std::size_t at_ = 0;
  bool complete_ = true;
};

// The text is the failure, or the names of the noise model's channels.
FitRecord::Answer ToAnswer(const Refit& refit) {
  FitRecord::Answer answer;
  if (!refit.usable()) {
    answer.text = refit.failure;
    return answer;
  }
  std::vector<double>& numbers = answer.numbers;
  numbers = {refit.cost,
             refit.deviance,
             static_cast<double>(refit.rows),
             refit.converged ? 1.0 : 0.0,
             refit.noise_absorbs_misfit ? 1.0 : 0.0,
             refit.holds_input_noise ? 1.0 : 0.0};
  const auto add = [&](const double* values, std::size_t count) {
    numbers.push_back(static_cast<double>(count));
    numbers.insert(numbers.end(), values, values + count);
  };
  add(refit.x.data(), static_cast<std::size_t>(refit.x.size()));
  std::vector<std::string> names;
  numbers.push_back(static_cast<double>(refit.noise.channels.size()));
  for (const noise::ChannelNoiseModel& channel : refit.noise.channels) {
    names.push_back(channel.channel);
    add(channel.coefficients.data(), channel.coefficients.size());
    numbers.push_back(channel.deviation);
    numbers.push_back(channel.least_deviation);
    numbers.push_back(channel.spent);
  }
  numbers.push_back(static_cast<double>(refit.noise.channel_of.size()));
  for (const int channel : refit.noise.channel_of) numbers.push_back(channel);
  answer.text = Join(names, "\n");
  return answer;
}

bool Restore(const FitRecord::Answer& answer, const LeastSquares& fit, Refit& refit) {
  if (answer.numbers.empty()) {
    refit.failure = answer.text;
    return !refit.usable();
  }
  Reader reader(answer.numbers);
  refit.cost = reader.Next();
  refit.deviance = reader.Next();
  refit.rows = reader.Integer();
  refit.converged = reader.Next() != 0;
  refit.noise_absorbs_misfit = reader.Next() != 0;
  refit.holds_input_noise = reader.Next() != 0;
  refit.x.resize(static_cast<Eigen::Index>(reader.Count()));
  for (double& x : refit.x) x = reader.Next();
  const std::vector<std::string_view> names = Split(answer.text, '\n');
  refit.noise.channels.resize(reader.Count());
  if (names.size() != refit.noise.channels.size() || refit.x.size() != fit.variables()) return false;
  for (std::size_t c = 0; c < names.size(); ++c) {
    noise::ChannelNoiseModel& channel = refit.noise.channels[c];
    channel.channel = names[c];
    channel.coefficients.resize(reader.Count());
    for (double& coefficient : channel.coefficients) coefficient = reader.Next();
    channel.deviation = reader.Next();
    channel.least_deviation = reader.Next();
    channel.spent = reader.Next();
  }
  refit.noise.channel_of.resize(reader.Count());
  for (int& channel : refit.noise.channel_of) {
    channel = reader.Integer();
    if (channel < 0 || channel >= static_cast<int>(names.size())) return false;
  }
  refit.point = fit.Parameters(refit.x);
  return reader.Ended();
}

}  // namespace

Refit RecordedRefit(const Problem& problem, Refit asked, RefitKind kind, const std::vector<Vector>& starts,
                    double tolerance, const std::function<Refit(Refit)>& make,
                    const noise::NoiseModel* under) {
  FitRecord* const record = asked.setup->record;
  if (record == nullptr) return make(std::move(asked));
  Digest question;
  question.Add("refit").Add(static_cast<std::uint64_t>(kind)).Add(tolerance);
  question.Add(static_cast<std::uint64_t>(starts.size()));
  for (const Vector& start : starts) question.Add(start.data(), static_cast<std::size_t>(start.size()));
  for (std::size_t c = 0; under != nullptr && c < under->channels.size(); ++c) {
    const noise::ChannelNoiseModel& channel = under->channels[c];
    question.Add(channel.coefficients.data(), channel.coefficients.size());
    question.Add(channel.deviation).Add(channel.least_deviation).Add(channel.spent);
  }
  const LeastSquares fit(problem, *asked.setup);
  fit.AddTo(question);
  if (const auto known = record->Find(question); known) {
    Refit refit = asked;
    if (Restore(*known, fit, refit)) return refit;
  }
  Refit refit = make(std::move(asked));
  if (!refit.interrupted) record->Keep(question, ToAnswer(refit));
  return refit;
}

}  // namespace sinew::diagnosis
