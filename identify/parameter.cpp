#include "identify/parameter.h"

#include <cmath>
#include <set>
#include <utility>

#include "base/text.h"

namespace sinew {
namespace {

Status CheckOne(const Parameter& p) {
  if (p.name.empty()) return Fail("a parameter has no name");
  if (!std::isfinite(p.lower) || !std::isfinite(p.upper) || !(p.lower < p.upper)) {
    return Fail("parameter '{}': bounds {} .. {} are not a finite interval [{}]", p.name, p.lower, p.upper,
                p.unit);
  }
  if (p.scale == Scale::kLog && p.lower <= 0) {
    return Fail("parameter '{}': lower bound {} must be above 0 on a logarithmic scale", p.name, p.lower);
  }
  if (!(p.start >= p.lower && p.start <= p.upper)) {
    return Fail("parameter '{}': start {} lies outside its bounds {} .. {} [{}]", p.name, p.start, p.lower,
                p.upper, p.unit);
  }
  for (const double other : p.other_starts) {
    if (!(other >= p.lower && other <= p.upper)) {
      return Fail("parameter '{}': one of its other starts, {}, lies outside its bounds {} .. {} [{}]",
                  p.name, other, p.lower, p.upper, p.unit);
    }
  }
  if (p.kind == ParameterKind::kEffect) {
    if (p.effect.empty()) return Fail("parameter '{}' belongs to no effect", p.name);
    if (!(p.null_value >= p.lower && p.null_value <= p.upper)) {
      return Fail("parameter '{}': null value {} lies outside its bounds {} .. {}", p.name, p.null_value,
                  p.lower, p.upper);
    }
  }
  if (p.prior && !std::isfinite(p.prior->mean)) {
    return Fail("parameter '{}': its prior has mean {}, expected a number", p.name, p.prior->mean);
  }
  if (p.prior && !(p.prior->standard_deviation > 0 && std::isfinite(p.prior->standard_deviation))) {
    return Fail("parameter '{}': its prior has standard deviation {}, expected a number above 0", p.name,
                p.prior->standard_deviation);
  }
  return {};
}

}  // namespace

Parameter BaseParameter(std::string name, std::string unit, std::string meaning, double lower, double upper,
                        double start) {
  Parameter p;
  p.name = std::move(name);
  p.unit = std::move(unit);
  p.meaning = std::move(meaning);
  p.lower = lower;
  p.upper = upper;
  p.start = start;
  return p;
}

Parameter EffectParameter(std::string name, std::string unit, std::string meaning, double lower, double upper,
                          double null, std::string effect) {
  Parameter p = BaseParameter(std::move(name), std::move(unit), std::move(meaning), lower, upper, null);
  p.null_value = null;
  p.kind = ParameterKind::kEffect;
  p.effect = std::move(effect);
  return p;
}

Status CheckParameters(const std::vector<Parameter>& parameters) {
  std::set<std::string> names;
  for (const Parameter& p : parameters) {
    SINEW_TRY(CheckOne(p));
    if (!names.insert(p.name).second) return Fail("parameter '{}' stands there twice", p.name);
  }
  return {};
}

Result<int> FindParameter(const std::vector<Parameter>& parameters, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name == name) return static_cast<int>(i);
    names.push_back(parameters[i].name);
  }
  return Fail("parameter '{}' does not exist{}", name, Suggestion(name, names));
}

}  // namespace sinew
