#include "models/emg/filter_section.h"

#include <algorithm>
#include <cmath>

namespace sinew {

CausalFilter::CausalFilter(const FilterSections& sections) {
  stages_.reserve(sections.size());
  for (const FilterSection& section : sections) stages_.push_back({section});
}

void CausalFilter::Settle(double value) {
  for (Stage& stage : stages_) {
    const FilterSection& s = stage.section;
    const double out = value * (s.b0 + s.b1 + s.b2) / (1 + s.a1 + s.a2);
    stage.second = s.b2 * value - s.a2 * out;
    stage.first = s.b1 * value - s.a1 * out + stage.second;
    value = out;
  }
}

std::size_t ZeroLagPadding(const FilterSections& sections) {
  std::size_t coefficients = 1;
  for (const FilterSection& s : sections) coefficients += s.b2 == 0 && s.a2 == 0 ? 1 : 2;
  return 3 * coefficients;
}

Result<std::vector<double>> FilterZeroLag(const FilterSections& sections, const std::vector<double>& values) {
  const std::size_t padding = ZeroLagPadding(sections);
  if (values.size() <= padding) {
    return Fail("{} samples are too few for this filter forward and backward, expected more than {}",
                values.size(), padding);
  }
  const auto gap = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  if (gap != values.end())
    return Fail("sample {} is {}, expected a finite number", gap - values.begin(), *gap);

  std::vector<double> longer;
  longer.reserve(values.size() + 2 * padding);
  for (std::size_t k = padding; k > 0; --k) longer.push_back(2 * values.front() - values[k]);
  longer.insert(longer.end(), values.begin(), values.end());
  for (std::size_t k = 2; k < padding + 2; ++k)
    longer.push_back(2 * values.back() - values[values.size() - k]);

  CausalFilter forward(sections);
  forward.Settle(longer.front());
  for (double& value : longer) value = forward.Next(value);
  CausalFilter backward(sections);
  backward.Settle(longer.back());
  for (auto value = longer.rbegin(); value != longer.rend(); ++value) *value = backward.Next(*value);
  const auto first = longer.begin() + static_cast<std::ptrdiff_t>(padding);
  return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(values.size()));
}

}  // namespace sinew
