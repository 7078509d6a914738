#include "identify/files/origin.h"

#include <algorithm>
#include <cmath>

#include "base/version.h"
#include "identify/files/run_groups.h"

namespace sinew::files {
namespace {

bool SameNumbers(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

bool SameData(const Hdf5Node& a, const Hdf5Node& b) {
  if (a.data.index() != b.data.index()) return false;
  if (a.array() != nullptr) return SameNumbers(a.array()->values, b.array()->values);
  if (a.text() != nullptr) return *a.text() == *b.text();
  return a.texts() == nullptr || *a.texts() == *b.texts();
}

}  // namespace

Hdf5Node OriginTree(const Provenance& provenance, const FitSetup& setup, const OriginFacts& facts) {
  Hdf5Node origin;
  origin.attributes["problem"] = provenance.problem;
  origin.attributes["data"] = provenance.data_hash;
  origin.attributes["version"] = std::string(kVersion);
  for (const auto& [name, value] : facts) origin.attributes[name] = value;
  origin.At("settings").data = provenance.config;
  WriteParameters(setup, setup.rest, origin.At("parameters"));
  return origin;
}

Status CheckSameOrigin(const std::string& path, const Hdf5Node& then, const Hdf5Node& now) {
  for (const auto& [name, unused] : now.attributes) {
    const std::string before = then.Text(name, "(not recorded)");
    if (before != now.Text(name))
      return Fail("--resume: {} was made with {} {}, not {}", path, name, before, now.Text(name));
  }
  const Hdf5Node* settings = then.Find("settings");
  if (settings == nullptr || !SameData(*settings, *now.Find("settings")))
    return Fail("--resume: {} was made with other settings (--config)", path);
  for (const auto& [name, column] : now.Find("parameters")->children) {
    const Hdf5Node* before = then.Find("parameters/" + name);
    if (before == nullptr || !SameData(*before, column))
      return Fail("--resume: {} was made with other parameters (they differ in their {})", path, name);
  }
  return {};
}

}  // namespace sinew::files
