#include "datasets/dataset.h"

#include <cmath>

#include "datasets/units.h"

namespace sinew {
namespace {

Status CheckName(const std::string& where, const std::string& what, const std::string& name) {
  if (name.empty()) return Fail("{}: a {} has no name", where, what);
  if (name == "." || name.find('/') != std::string::npos || name.find('\0') != std::string::npos) {
    return Fail("{}: the {} name '{}' is not allowed; it must hold no '/' and not be '.'", where, what, name);
  }
  return {};
}

Status CheckSiUnit(const std::string& where, const std::string& unit) {
  const auto conversion = ToSi(unit);
  if (!conversion) return Fail("{}: {}", where, conversion.error().message);
  if (conversion->factor != 1 || conversion->offset != 0)
    return Fail("{}: unit '{}', expected SI: '{}'", where, unit, conversion->si_unit);
  return {};
}

Status CheckTime(const std::string& where, const std::vector<double>& time) {
  if (time.empty()) return Fail("{}: holds no samples", where);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) return Fail("{}: time {} is not a number", where, i);
    if (i > 0 && time[i] <= time[i - 1]) {
      return Fail("{}: time does not increase: sample {} is at {} s, sample {} at {} s", where, i - 1,
                  time[i - 1], i, time[i]);
    }
  }
  return {};
}

Status CheckChannel(const std::string& where, const Channel& channel, std::size_t samples) {
  SINEW_TRY(CheckSiUnit(where, channel.unit));
  if (channel.values.size() != samples) {
    return Fail("{}: has {} values, its time has {}", where, channel.values.size(), samples);
  }
  if (channel.sigma && !(*channel.sigma > 0 && std::isfinite(*channel.sigma))) {
    return Fail("{}: sigma is {}, expected more than 0", where, *channel.sigma);
  }
  for (std::size_t i = 0; i < samples; ++i) {
    if (std::isinf(channel.values[i]))
      return Fail("{}: value {} is infinite; a gap is written as NaN", where, i);
  }
  return {};
}

Status CheckTrial(const std::string& where, const Trial& trial) {
  for (const auto& [name, value] : trial.conditions) {
    SINEW_TRY(CheckName(where, "condition", name));
    if (name == "role" || name == "task" || name == "cut_from")
      return Fail("{}: a condition cannot be named '{}'", where, name);
    if (!std::isfinite(value)) return Fail("{}: condition '{}' is not a finite number", where, name);
  }
  if (trial.grids.empty()) return Fail("{}: holds no data", where);
  for (const auto& [grid_name, grid] : trial.grids) {
    SINEW_TRY(CheckName(where, "grid", grid_name));
    const std::string grid_where = where + "/" + grid_name;
    SINEW_TRY(CheckTime(grid_where + "/time", grid.time));
    for (const auto& [name, channel] : grid.channels) {
      SINEW_TRY(CheckName(grid_where, "channel", name));
      SINEW_TRY(CheckChannel(grid_where + "/channels/" + name, channel, grid.time.size()));
    }
  }
  return {};
}

}  // namespace

Trial::Found Trial::Find(const std::string& channel) const {
  for (const auto& [name, grid] : grids) {
    const auto found = grid.channels.find(channel);
    if (found != grid.channels.end()) return {&grid, &found->second};
  }
  return {};
}

std::vector<std::string> Trial::ChannelNames() const {
  std::vector<std::string> names;
  for (const auto& [grid_name, grid] : grids) {
    for (const auto& [name, channel] : grid.channels) names.push_back(name);
  }
  return names;
}

Status Dataset::Check() const {
  for (const auto& [name, trial] : trials) {
    SINEW_TRY(CheckName("/trials", "trial", name));
    SINEW_TRY(CheckTrial("/trials/" + name, trial));
  }
  for (const auto& [name, constant] : constants) {
    SINEW_TRY(CheckName("/constants", "constant", name));
    SINEW_TRY(CheckSiUnit("/constants/" + name, constant.unit));
    if (!std::isfinite(constant.value)) return Fail("/constants/{}: is not a finite number", name);
  }
  for (const auto& [name, text] : files) {
    SINEW_TRY(CheckName("/files", "file", name));
    if (text.find('\0') != std::string::npos) return Fail("/files/{}: holds bytes that are not text", name);
  }
  return {};
}

}  // namespace sinew
